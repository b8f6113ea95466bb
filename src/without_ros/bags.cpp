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

ViewWriter marker_bag(const std::string&, const std::optional<double>&, const std::set<std::size_t>&) {
  throw UsageError("--markers, --film, --serve: this replay was built without ROS and writes no bags");
}

}  // namespace mrhi
