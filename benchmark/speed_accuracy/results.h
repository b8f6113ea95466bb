#pragma once

#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "contender.h"

namespace mrhi::benchmark {

void write_header(std::ostream& csv);

/// The rows of one scene and step. `measures` holds by scene what it measures, as those that came through
/// said; a contender that did not has failed in all of it.
void write_rows(std::ostream& csv, const std::string& scene, double step,
                const std::vector<std::unique_ptr<Contender>>& contenders,
                std::map<std::string, std::vector<Measure>>& measures);

/// What steps cost, a row for each run that came through.
void write_times_header(std::ostream& csv);
void write_times(std::ostream& csv, const std::string& scene, double step,
                 const std::vector<std::unique_ptr<Contender>>& contenders);

}  // namespace mrhi::benchmark
