#include "flat_part.h"

namespace mrhi {
namespace {

struct Span {
  const Capsule& capsule;
  const ClosestFeatures& features;

  template <typename Asked>
  AxisSpan operator()(const Asked& shape) const {
    return shape.span(capsule, features);
  }
  AxisSpan operator()(const Mesh&) const { return at_point(features); }
};

}  // namespace

AxisSpan contact_span(const Capsule& capsule, const Shape& shape, const ClosestFeatures& features) {
  return std::visit(Span{capsule, features}, shape);
}

}  // namespace mrhi
