#pragma once

#include <sys/types.h>

#include <string>

#include "engine_module.h"
#include "run.h"

namespace mrhi::benchmark {

/// One engine's run in a process of its own: what crashes or hangs there fails there, and libraries that
/// cannot share a process (Bullet's two precisions) need not. It works in blocks of some milliseconds, one at
/// a time.
class Contender {
 public:
  Contender(const EngineModule& module, const std::string& setting, const ScenePlan& scene, bool quick,
            double step, double seconds);
  ~Contender();
  Contender(const Contender&) = delete;
  Contender& operator=(const Contender&) = delete;

  /// Lets it work for a block; false once it has finished, crashed, or used up its `seconds`.
  bool work();

  const std::string& engine() const { return engine_; }
  const std::string& setting() const { return setting_; }
  /// Why the run was broken off, or empty.
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

}  // namespace mrhi::benchmark
