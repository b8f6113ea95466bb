#include "body_manifold.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <type_traits>

#include "contact_region.h"
#include "flat_part.h"

namespace mrhi {
namespace {

/// Calls `of_mesh` for a mesh, `of_other` for any other shape, which answers by itself.
template <typename OfMesh, typename OfOther>
auto by_kind(const Shape& shape, const OfMesh& of_mesh, const OfOther& of_other) {
  return std::visit(
      [&](const auto& typed) {
        if constexpr (std::is_same_v<std::decay_t<decltype(typed)>, Mesh>) {
          return of_mesh();
        } else {
          return of_other(typed);
        }
      },
      shape);
}

double length(const Capsule& core) {
  return (core.end - core.start).norm();
}

/// Each kind of pair is computed in one order: the longer of two cores, the round one of two prisms, and a
/// mesh come first. In the other order only the normal changes its sign.
bool comes_first(const ManifoldShape& a, const ManifoldShape& b) {
  if (a.core && b.core) return length(*a.core) >= length(*b.core);
  if (a.core || b.core) return a.core.has_value();
  if (a.prism && b.prism) return a.prism->round || !b.prism->round;
  return a.mesh != nullptr || b.mesh == nullptr;
}

/// Contact of a capsule along a shape, in the shape's frame.
struct Lying {
  ClosestFeatures features;
  AxisSpan span;

  /// Height of the capsule above the surface's plane at the axis parameter s.
  double gap(const Capsule& capsule, double s) const {
    return features.normal.dot(capsule.axis_point(s) - features.point) - capsule.radius;
  }
};

/// A capsule over an edge is nearest there as soon as it tilts: a bar that tilts by less than kSameFace on a
/// table's edge would lose its second point. Therefore the first of its centre and ends over a face with
/// nearly that normal defines the face, if the bar is as deep there as at the edge.
Lying lying_on(const ManifoldShape& shape, const Capsule& capsule, const ClosestFeatures& features,
               double margin) {
  const Lying found{features, shape.span(capsule, features)};
  const double length = (capsule.end - capsule.start).norm();
  if (found.span.s0 < found.span.s1 || length == 0.0) return found;
  constexpr double kMaxRise = 0.05;  // of the axis above a face that it is within kSameFace of
  for (const double s : {0.5, 0.0, 1.0}) {
    const Vector3 place = capsule.axis_point(s);
    auto there = shape.closest({place, place, capsule.radius}, margin + kMaxRise * length);
    if (!there || there->normal.dot(features.normal) < kSameFace) continue;
    there->axis_parameter = s;
    const Lying lying{*there, shape.span(capsule, *there)};
    const double nearest = std::min(lying.gap(capsule, lying.span.s0), lying.gap(capsule, lying.span.s1));
    if (lying.span.s0 < lying.span.s1 && as_deep(-nearest, features.distance)) return lying;
  }
  return found;
}

int name_of(double s) {
  return s < 1e-9 ? 0 : s > 1.0 - 1e-9 ? 1 : 2;
}

}  // namespace

/// A search from deeper than kDeepSearch, or on the surface itself, takes longer.
double search_work(const ManifoldShape& shape, double distance) {
  constexpr double kDeepSearch = 0.002, kCoincidence = 1e-9;  // [m]
  constexpr double kClosedForm = 0.1;
  if (shape.mesh == nullptr) return kClosedForm;
  const bool is_deep = distance < -kDeepSearch || std::abs(distance) < kCoincidence;
  return is_deep ? shape.mesh->deep_search_cost(std::max(0.0, -distance)) : shape.mesh->search_cost();
}

std::size_t sampled(std::size_t i, std::size_t count) {
  constexpr double kGoldenRatio = 0.6180339887498949;
  return static_cast<std::size_t>(std::fmod(kGoldenRatio * static_cast<double>(i), 1.0) *
                                  static_cast<double>(count));
}

ManifoldShape::ManifoldShape(const Shape& placed, const MeshCollider* collider)
    : shape(placed),
      mesh(collider),
      core(std::visit([](const auto& typed) { return typed.core(); }, placed)),
      prism(std::visit([](const auto& typed) { return typed.prism(); }, placed)),
      bounding_radius(mrhi::bounding_radius(placed)) {
  if (std::holds_alternative<Mesh>(placed) && collider == nullptr) {
    throw std::invalid_argument("a mesh needs its MeshCollider to be a ManifoldShape");
  }
}

Manifold body_manifold(const ManifoldShape& a, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin, double least_breadth, SearchBudget* budget) {
  const double reach = a.bounding_radius + b.bounding_radius + margin;
  if ((pose_a.position - pose_b.position).squaredNorm() > reach * reach) return {};
  if (!comes_first(a, b)) {
    Manifold manifold = body_manifold(b, pose_b, a, pose_a, margin, least_breadth, budget);
    manifold.normal = -manifold.normal;
    for (Vector3& normal : manifold.other_normals) normal = -normal;
    return manifold;
  }
  if (a.core) return core_manifold(*a.core, pose_a, b, pose_b, margin);
  if (a.prism && b.prism) return prism_manifold(a, pose_a, b, pose_b, margin, least_breadth);
  SearchBudget own;
  return mesh_manifold(a, pose_a, b, pose_b, margin, budget != nullptr ? *budget : own);
}

std::optional<ClosestFeatures> ManifoldShape::closest(const Capsule& capsule, double margin) const {
  return by_kind(
      shape, [&] { return mesh->closest(capsule, margin); },
      [&](const auto& typed) -> std::optional<ClosestFeatures> {
        const ClosestFeatures features = typed.closest(capsule, margin);
        if (features.distance > margin) return std::nullopt;
        return features;
      });
}

AxisSpan contact_span(const Capsule& capsule, const Shape& shape, const ClosestFeatures& features) {
  return by_kind(
      shape, [&] { return at_point(features); },
      [&](const auto& typed) { return typed.span(capsule, features); });
}

/// A point is midway between the two surfaces: at a(s) - (r + gap / 2) n, with the gap n.(a(s) - point) - r,
/// < 0 where they overlap. All in b's frame, turned to world at the end; n is out of b, towards the core.
Manifold core_manifold(const Capsule& core, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin) {
  const auto to_b = [&](const Vector3& place) { return pose_b.to_local(pose_a * place); };
  const Capsule capsule{to_b(core.start), core.start == core.end ? to_b(core.start) : to_b(core.end),
                        core.radius};
  const auto features = b.closest(capsule, margin);
  Manifold manifold;
  if (!features) return manifold;
  const Lying lying = lying_on(b, capsule, *features, margin);
  const Vector3& normal = lying.features.normal;
  manifold.normal = pose_b.orientation * normal;
  if (lying.span.s0 == lying.span.s1) {
    const Vector3 midway = features->point + 0.5 * features->distance * normal;
    const bool ball = core.start == core.end;
    add_point(manifold, pose_b * midway, -features->distance, ball ? 0 : name_of(features->axis_parameter));
    return manifold;
  }
  for (const int end : {0, 1}) {
    const double s = end == 0 ? lying.span.s0 : lying.span.s1, gap = lying.gap(capsule, s);
    const Vector3 place = capsule.axis_point(s);
    if (gap <= margin)
      add_point(manifold, pose_b * Vector3(place - (capsule.radius + 0.5 * gap) * normal), -gap, end);
  }
  return manifold;
}

}  // namespace mrhi
