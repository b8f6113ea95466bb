#pragma once

#include <sys/types.h>

#include <string>

#include "run.h"

namespace mrhi::benchmark {

struct EngineModule {
  std::string name;
  std::string file;  ///< shared object that exports speed_accuracy_engine()
};

/// The engines that this program was built with, ours first.
std::vector<EngineModule> engine_modules();

/// Loads an engine's module into this process. Throws std::runtime_error.
const EngineMaker& load(const std::string& file);

/// Settings of an engine, asked for in a process of its own.
std::vector<std::string> settings_of(const EngineModule& module);

/// One engine's run in a process of its own: what crashes or hangs there fails there, and libraries that cannot
/// share a process (Bullet's two precisions) need not. It works in blocks of some milliseconds, one at a time.
class Contender {
 public:
  Contender(const EngineModule& module, const std::string& setting, const ScenePlan& scene, bool quick,
            double step);
  ~Contender();
  Contender(const Contender&) = delete;
  Contender& operator=(const Contender&) = delete;

  /// Lets it work for a block; false once it has finished, crashed, or used up its `seconds`.
  bool work(double seconds);

  const std::string& engine() const { return engine_; }
  const std::string& setting() const { return setting_; }
  /// Why there is no result, or empty.
  const std::string& trouble() const { return trouble_; }
  const RunResult& result() const { return result_; }

 private:
  void finish(const std::string& report);

  std::string engine_, setting_, trouble_;
  RunResult result_;
  pid_t process_ = -1;
  int to_child_ = -1, from_child_ = -1;
  double used_ = 0.0;  // [s]
  std::string received_;
};

}  // namespace mrhi::benchmark
