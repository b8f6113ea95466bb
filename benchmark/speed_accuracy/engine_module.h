#pragma once

#include <string>
#include <vector>

#include "engine.h"

namespace mrhi::benchmark {

struct EngineModule {
  std::string name;
  std::string file;     ///< shared object that exports speed_accuracy_engine()
  std::string version;  ///< the engine's, as its package or sources say
};

/// The engines that this program was built with, ours first.
std::vector<EngineModule> engine_modules();

/// Loads an engine's module into this process. Throws std::runtime_error.
const EngineMaker& load(const std::string& file);

/// Settings of an engine, asked for in a process of its own.
std::vector<std::string> settings_of(const EngineModule& module);

}  // namespace mrhi::benchmark
