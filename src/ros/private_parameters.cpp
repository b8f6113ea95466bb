#include "private_parameters.h"

#include <vector>

namespace mrhi {

void refuse_unknown(const ros::NodeHandle& parameters, const std::set<std::string>& known) {
  std::vector<std::string> names;
  ros::param::getParamNames(names);
  const std::string space = parameters.getNamespace() + "/";
  for (const std::string& name : names) {
    if (name.compare(0, space.size(), space) != 0 || known.count(name.substr(space.size())) > 0) continue;
    std::string list;
    for (const std::string& one : known) list += (list.empty() ? "" : ", ") + one;
    throw std::invalid_argument("parameter " + name + " is not known: use " + list);
  }
}

std::uint64_t read_seed(const ros::NodeHandle& parameters, std::uint64_t otherwise) {
  int seed = static_cast<int>(otherwise);
  read_parameter(parameters, "seed", "an integer", seed);
  if (seed < 0) throw std::invalid_argument("seed is " + std::to_string(seed) + ": use 0 or more");
  return static_cast<std::uint64_t>(seed);
}

}  // namespace mrhi
