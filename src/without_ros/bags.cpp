#include "../replay/frame_source.h"
#include "../replay/marker_bag.h"

namespace mrhi {

ReplayInput open_bag(const ReplayArguments& arguments) {
  throw UsageError("--input " + arguments.input +
                   ": this replay was built without ROS and reads no bags; allowed: a recording in CSV");
}

OpenLog open_log(const ReplayArguments& arguments) {
  open_bag(arguments);
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
