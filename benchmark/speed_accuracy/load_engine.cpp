#include <dlfcn.h>

#include <stdexcept>

#include "engine_module.h"

namespace mrhi::benchmark {

const EngineMaker& load(const std::string& file) {
  void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) throw std::runtime_error(dlerror());
  using Export = const EngineMaker* (*)();
  const auto entry = reinterpret_cast<Export>(dlsym(module, "speed_accuracy_engine"));
  if (entry == nullptr) throw std::runtime_error(file + ": exports no engine");
  return *entry();
}

}  // namespace mrhi::benchmark
