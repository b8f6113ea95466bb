#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

double bounding_radius(const Shape& shape) {
  return std::visit([](const auto& asked) { return asked.bounding_radius(); }, shape);
}

}  // namespace mrhi
