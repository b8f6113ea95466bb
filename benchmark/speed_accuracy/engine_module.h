#pragma once

#include <string>
#include <vector>

#include "engine.h"

namespace mrhi::benchmark {

struct EngineModule {
  std::string name;
  std::string file;     ///< shared object that exports speed_accuracy_engine()
  std::string version;  ///< the engine's, from its package or sources
};

/// Engines built with this program, ours first.
std::vector<EngineModule> engine_modules();

/// Loads an engine's module into this process. Throws std::runtime_error.
const EngineMaker& load(const std::string& file);

/// Settings of an engine, queried in a separate process.
std::vector<std::string> settings_of(const EngineModule& module);

}  // namespace mrhi::benchmark
