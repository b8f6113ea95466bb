#pragma once

#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "contender.h"

namespace mrhi::benchmark {

void write_header(std::ostream& csv);

/// Writes the rows of one scene and step. `measures`: by scene, from the successful contenders; the others
/// have failed in all of them.
void write_rows(std::ostream& csv, const std::string& scene, double step,
                const std::vector<std::unique_ptr<Contender>>& contenders,
                std::map<std::string, std::vector<Measure>>& measures);

/// Writes the cost of steps, a row for each successful run.
void write_times_header(std::ostream& csv);
void write_times(std::ostream& csv, const std::string& scene, double step,
                 const std::vector<std::unique_ptr<Contender>>& contenders);

}  // namespace mrhi::benchmark
