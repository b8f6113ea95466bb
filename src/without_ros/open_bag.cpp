#include "../replay/open_bag.h"

namespace mrhi {

ReplayInput open_bag(const ReplayArguments& arguments) {
  throw UsageError("--input " + arguments.input +
                   ": this replay was built without ROS and reads no bags; allowed: a recording in CSV");
}

OpenLog open_log(const ReplayArguments& arguments) {
  open_bag(arguments);
  return {};
}

}  // namespace mrhi
