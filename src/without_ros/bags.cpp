#include "../replay/inputs.h"

namespace mrhi {

ReplayInput open_bag(const std::string& file, const std::optional<std::string>&, const std::optional<Pose>&,
                     const HandOptions&) {
  throw UsageError("--input " + file +
                   ": this replay was built without ROS and reads no bags; allowed: a recording in CSV");
}

OpenLog open_log(const ReplayArguments& arguments) {
  open_bag(arguments.input, {}, {}, {});
  return {};
}

struct MarkerBag::Impl {};

MarkerBag::MarkerBag(const std::string&, const std::set<std::size_t>&) : MarkerBag("", 0.0) {}
MarkerBag::MarkerBag(const std::string&, double) {
  throw UsageError("--markers: this replay was built without ROS and writes no bags");
}
MarkerBag::~MarkerBag() = default;
void MarkerBag::watch(const Simulation&) {}

}  // namespace mrhi
