#include "../replay/marker_bag.h"

#include "mr_hand_interaction/usage_error.h"

namespace mrhi {

struct MarkerBag::Impl {};

MarkerBag::MarkerBag(const std::string&, const std::set<std::size_t>&) {
  throw UsageError("--markers: this replay was built without ROS and writes no bags");
}
MarkerBag::~MarkerBag() = default;
void MarkerBag::watch(const Simulation&) {}

}  // namespace mrhi
