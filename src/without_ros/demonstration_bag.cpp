#include "../replay/demonstration.h"

namespace mrhi {

void write_demonstration_bag(const Demonstration&, const std::string&) {}

}  // namespace mrhi
