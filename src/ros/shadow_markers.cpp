#include "marker_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace mrhi {
namespace {

using Point = Eigen::Vector2d;
using visualization_msgs::Marker;

constexpr int kMaxBodies = 8;
constexpr int kFirstBody = kIdsPerHand;      // first id of bodies' shadows; lower ones are of hands
constexpr double kMinMotion = 0.0005;        // [m]
constexpr double kGridHeight = 0.1;          // height of rviz's grid [m]
constexpr double kClearance = 0.05;          // of free bodies above the ground [m]
constexpr double kCellSize = 0.008;          // [m]
constexpr double kLiftAboveGround = 0.001;   // above the ground and its grid [m]
constexpr double kMinGroundHalfWidth = 0.1;  // smallest half width of a ground [m]
constexpr double kMaxShadowOpacity = 0.5;    // opacity for an object on the ground
constexpr double kHalfOpacityHeight = 0.3;   // height at which half of that remains [m]
constexpr double kMinEdgeWidth = 0.006;      // width of the soft edge for an object on the ground [m]
constexpr double kEdgeGrowth = 0.05;         // increase per metre of height
constexpr double kMinShadowOpacity = 0.02;
constexpr double kMaxDepth = 0.02;  // greater depths below the ground have no shadow [m]
constexpr double kMaxHeight = 1.0;  // [m]
constexpr std::size_t kMeshPoints = 300;

/// Support distances of a convex object in horizontal directions; accurate to 0.25 mm for 5 cm.
struct Outline {
  static constexpr std::size_t kDirections = 32;

  /// `farthest` returns the support point along a direction, in world.
  template <typename Farthest>
  explicit Outline(const Farthest& farthest) : lowest(farthest(-Vector3::UnitZ()).z()) {
    for (std::size_t i = 0; i < kDirections; ++i) reach[i] = direction(i).dot(farthest(direction(i)));
  }

  static const Vector3& direction(std::size_t i) {
    static const auto all = [] {
      std::array<Vector3, kDirections> made;
      for (std::size_t k = 0; k < kDirections; ++k) {
        const double turn = 2.0 * M_PI * static_cast<double>(k) / kDirections;
        made[k] = {std::cos(turn), std::sin(turn), 0.0};
      }
      return made;
    }();
    return all[i];
  }

  /// Signed distance from the outline; negative inside.
  double distance(const Point& point) const {
    double farthest_out = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < kDirections; ++i)
      farthest_out = std::max(farthest_out, direction(i).head<2>().dot(point) - reach[i]);
    return farthest_out;
  }

  void extend(Eigen::AlignedBox2d& box, double margin) const {
    constexpr std::size_t kQuarter = kDirections / 4;
    box.extend(Point(reach[0] + margin, reach[kQuarter] + margin));
    box.extend(-Point(reach[2 * kQuarter] + margin, reach[3 * kQuarter] + margin));
  }

  std::array<double, kDirections> reach;  ///< from the origin along each direction [m]
  double lowest;                          ///< [m]
};

Outline outline_of(const TriangleMesh& mesh, const Pose& pose) {
  std::vector<Vector3> some;
  const std::size_t step = 1 + mesh.vertices.size() / kMeshPoints;
  for (std::size_t i = 0; i < mesh.vertices.size(); i += step) some.push_back(pose * mesh.vertices[i]);
  return Outline([&](const Vector3& n) {
    return *std::max_element(some.begin(), some.end(),
                             [&](const Vector3& a, const Vector3& b) { return n.dot(a) < n.dot(b); });
  });
}

std::vector<Outline> outlines_of(const Body& body, const Pose& pose) {
  std::vector<Outline> outlines;
  for (const PlacedShape& placed : body.shapes) {
    const Pose at = pose * placed.pose;
    const Mesh* const mesh = std::get_if<Mesh>(&placed.shape);
    if (mesh == nullptr) {
      outlines.emplace_back([&](const Vector3& n) -> Vector3 {
        const Vector3 local = at.orientation.conjugate() * n;
        return at * std::visit([&](const auto& shape) { return shape.farthest(local); }, placed.shape);
      });
    } else if (mesh->triangles && !mesh->triangles->vertices.empty()) {
      outlines.push_back(outline_of(*mesh->triangles, at));
    }
  }
  return outlines;
}

std::vector<Outline> outlines_of(const Hand& hand) {
  std::vector<Outline> outlines;
  for (int i = 0; i < kCapsules; ++i) {
    if (!hand.has(i)) continue;
    const Capsule& capsule = hand.capsules[i];
    outlines.emplace_back([&](const Vector3& n) -> Vector3 {
      return (n.dot(capsule.start) > n.dot(capsule.end) ? capsule.start : capsule.end) + capsule.radius * n;
    });
  }
  return outlines;
}

/// Adds the shadow of one object: a grid of square cells, transparent at the edge.
void add_shadow(const std::vector<Outline>& outlines, double ground, Marker& marker) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  double lowest = kInfinite;
  for (const Outline& outline : outlines) lowest = std::min(lowest, outline.lowest);
  const double height = lowest - ground;
  if (outlines.empty() || height < -kMaxDepth || height > kMaxHeight) return;
  const double soft = kMinEdgeWidth + kEdgeGrowth * std::max(0.0, height);
  const double dark = kMaxShadowOpacity * kHalfOpacityHeight / (kHalfOpacityHeight + std::max(0.0, height));
  Eigen::AlignedBox2d extent;
  for (const Outline& outline : outlines) outline.extend(extent, soft);
  const Eigen::Array2i size = 2 + (extent.sizes().array() / kCellSize).cast<int>();
  const auto place = [&](int column, int row) -> Point {
    return extent.min() + kCellSize * Point(column, row);
  };
  Eigen::ArrayXXd opacity(size.x(), size.y());
  for (int row = 0; row < size.y(); ++row) {
    for (int column = 0; column < size.x(); ++column) {
      double distance = kInfinite;
      for (const Outline& outline : outlines)
        distance = std::min(distance, outline.distance(place(column, row)));
      const double fraction = std::clamp(0.5 - distance / (2.0 * soft), 0.0, 1.0);
      opacity(column, row) = dark * fraction * fraction * (3.0 - 2.0 * fraction);
    }
  }
  constexpr std::array<std::array<int, 2>, 6> kCorners{{{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}};
  for (int row = 0; row + 1 < size.y(); ++row) {
    for (int column = 0; column + 1 < size.x(); ++column) {
      if (opacity.block<2, 2>(column, row).maxCoeff() < kMinShadowOpacity) continue;
      for (const auto& [right, up] : kCorners) {
        const Point at = place(column + right, row + up);
        marker.points.push_back(to_message(Vector3(at.x(), at.y(), ground + kLiftAboveGround)));
        marker.colors.push_back(color(0.0, 0.0, 0.0, opacity(column + right, row + up)));
      }
    }
  }
}

}  // namespace

double ground_height(const Scene& scene) {
  double lowest = kGridHeight + kClearance, lowest_centre = std::numeric_limits<double>::infinity();
  for (const Body& body : scene.bodies) {
    if (body.fixed || body.shapes.empty()) continue;
    lowest = std::min(lowest, body.start.position.z() - body.bounding_radius);
    lowest_centre = std::min(lowest_centre, body.start.position.z());
  }
  double ground = lowest - kClearance;
  for (const Body& body : scene.bodies) {
    for (const PlacedShape& placed : body.shapes) {
      const Pose pose = body.start * placed.pose;
      const bool level = std::abs((pose.orientation * Vector3::UnitZ()).z()) > 1.0 - 1e-6;
      const Box* const box = std::get_if<Box>(&placed.shape);
      if (!body.fixed || !box || !level) continue;
      const double top = pose.position.z() + box->half_extents.z();
      const bool wide = std::min(box->half_extents.x(), box->half_extents.y()) >= kMinGroundHalfWidth;
      if (wide && top <= lowest_centre) ground = std::max(ground, top);
    }
  }
  return ground;
}

/// Keeps a shadow whose object has moved by less than kMinMotion.
template <typename Outlines>
void ShadowMarkers::add_one(int id, std::vector<Vector3> from, const Outlines& outlines, bool all,
                            const MarkerLayer& layer) {
  Cast& cast = casts_[id];
  const bool moved =
      cast.from.size() != from.size() ||
      !std::equal(from.begin(), from.end(), cast.from.begin(), [](const Vector3& a, const Vector3& b) {
        return (a - b).squaredNorm() < kMinMotion * kMinMotion;
      });
  if (!moved && !all) return;
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), color(0.0, 0.0, 0.0, 0.99));
  if (moved) {
    cast.from = std::move(from);
    add_shadow(outlines(), ground_, marker);
    cast.marker.points = marker.points, cast.marker.colors = marker.colors;
  } else {
    marker.points = cast.marker.points, marker.colors = cast.marker.colors;
  }
  if (marker.points.empty()) marker.action = Marker::DELETE;
}

void ShadowMarkers::add(const SimulationState& state, const FrameResult& result, bool all,
                        const MarkerLayer& layer) {
  const int hands = static_cast<int>(result.rendered.size());
  for (auto cast = casts_.begin(); cast != casts_.end();) {
    const bool gone = cast->first >= hands && cast->first < kFirstBody;
    if (gone)
      layer.add(cast->first, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), {}).action = Marker::DELETE;
    cast = gone ? casts_.erase(cast) : std::next(cast);
  }
  for (int i = 0; i < hands; ++i) {
    const Hand& hand = result.rendered[i].hand;
    std::vector<Vector3> from;
    for (const Capsule& capsule : hand.capsules) from.insert(from.end(), {capsule.start, capsule.end});
    add_one(
        i, std::move(from), [&] { return outlines_of(hand); }, all, layer);
  }
  int bodies = 0;
  for (std::size_t i = 0; i < scene_.bodies.size() && bodies < kMaxBodies; ++i) {
    const Body& body = scene_.bodies[i];
    if (body.fixed) continue;
    const Pose& pose = state.bodies[i].pose;
    std::vector<Vector3> from{pose.position};
    for (int axis = 0; axis < 3; ++axis) from.push_back(pose * (body.bounding_radius * Vector3::Unit(axis)));
    add_one(
        kFirstBody + bodies++, std::move(from), [&] { return outlines_of(body, pose); }, all, layer);
  }
}

}  // namespace mrhi
