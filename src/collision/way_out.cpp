#include "way_out.h"

namespace mrhi {

std::optional<double> way_out(const Shape& shape, const Vector3& point, const Vector3& direction) {
  return std::visit([&](const auto& asked) { return asked.way_out(point, direction); }, shape);
}

}  // namespace mrhi
