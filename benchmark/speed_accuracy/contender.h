#pragma once

#include <sys/types.h>
#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "engine_module.h"
#include "run.h"

namespace mrhi::benchmark {

/// One engine's run in a separate process: a crash or hang affects only that engine, and libraries that
/// cannot share a process (Bullet's two precisions) need not. Runs in blocks of some milliseconds.
class Contender {
 public:
  Contender(const EngineModule& module, const std::string& setting, const ScenePlan& scene, bool quick,
            double step, double seconds);
  ~Contender();
  Contender(const Contender&) = delete;
  Contender& operator=(const Contender&) = delete;

  /// Runs a block; returns false once it has finished, crashed, or used up its `seconds`.
  bool work();

  const std::string& engine() const { return engine_; }
  const std::string& setting() const { return setting_; }
  /// Reason why the run was aborted, or empty.
  const std::string& trouble() const { return result_.trouble; }
  const RunResult& result() const { return result_; }

 private:
  void finish(const std::string& report);

  std::string engine_, setting_;
  RunResult result_;
  pid_t process_ = -1;
  int to_child_ = -1, from_child_ = -1;
  std::string received_;
};

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
