#include "marker_layers.h"

#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace mrhi {
namespace {

using Point = Eigen::Vector2d;
using visualization_msgs::Marker;

constexpr int kMostBodies = 8;
constexpr int kFirstBody = kIdsPerHand;  // id of a shadow; those below are of hands
constexpr double kStays = 0.0005;        // [m]
constexpr double kGrid = 0.1;            // where rviz has its grid [m]
constexpr double kClearance = 0.05;      // of what is free from the ground [m]
constexpr double kCell = 0.008;          // [m]
constexpr double kLift = 0.001;          // off the ground and its grid [m]
constexpr double kWide = 0.1;            // half of what a ground is at least across [m]
constexpr double kDark = 0.5;            // opacity of what lies on the ground
constexpr double kFaintAt = 0.3;         // height at which half of that is left [m]
constexpr double kSoft = 0.006;          // width of the rim of what lies on the ground [m]
constexpr double kSoftening = 0.05;      // and more for each metre of height
constexpr double kLeastOpacity = 0.02;
constexpr double kSunk = 0.02;    // what is deeper in the ground has no shadow [m]
constexpr double kHighest = 1.0;  // [m]
constexpr std::size_t kMeshPoints = 300;

/// A convex thing seen from above: what is within a radius of the hull of some points.
struct Outline {
  std::vector<Point> hull;  // counter-clockwise
  double radius = 0.0;
  double lowest = std::numeric_limits<double>::infinity();

  void add(const Vector3& point, double around) {
    hull.emplace_back(point.x(), point.y());
    lowest = std::min(lowest, point.z() - around);
  }
  void close();
  /// From its rim; negative inside.
  double distance(const Point& point) const;
};

double cross(const Point& a, const Point& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Andrew's monotone chain.
void Outline::close() {
  if (hull.size() < 3) return;
  std::sort(hull.begin(), hull.end(),
            [](const Point& a, const Point& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  std::vector<Point> chain;
  for (int way = 0; way < 2; ++way) {
    const std::size_t begin = chain.size();
    for (const Point& point : hull) {
      while (chain.size() >= begin + 2 &&
             cross(chain.back() - chain[chain.size() - 2], point - chain.back()) <= 0.0)
        chain.pop_back();
      chain.push_back(point);
    }
    chain.pop_back();
    std::reverse(hull.begin(), hull.end());
  }
  hull.swap(chain);
}

double to_segment(const Point& point, const Point& a, const Point& b) {
  const Point along = b - a;
  const double length = along.squaredNorm();
  const double share = length > 0.0 ? std::clamp((point - a).dot(along) / length, 0.0, 1.0) : 0.0;
  return (point - a - share * along).norm();
}

double Outline::distance(const Point& point) const {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = hull.size() > 2;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Point &a = hull[i], &b = hull[(i + 1) % hull.size()];
    nearest = std::min(nearest, to_segment(point, a, b));
    inside = inside && cross(b - a, point - a) >= 0.0;
  }
  return (inside ? -nearest : nearest) - radius;
}

class AddPoints {
 public:
  AddPoints(const Pose& to, Outline& added) : pose_(to), outline_(added) {}

  /// By its core, or its outermost points above and below.
  template <typename Convex>
  void operator()(const Convex& shape) const {
    if (const auto core = shape.core()) return add(*core);
    for (int i = 0; i < 16; ++i) {
      const double angle = M_PI * i / 8.0;
      for (const double z : {-1.0, 1.0})
        outline_.add(pose_ * shape.farthest({std::cos(angle), std::sin(angle), z}), 0.0);
    }
  }
  void operator()(const Mesh& mesh) const {
    if (!mesh.triangles) return;
    const std::vector<Vector3>& vertices = mesh.triangles->vertices;
    const std::size_t step = 1 + vertices.size() / kMeshPoints;
    for (std::size_t i = 0; i < vertices.size(); i += step) outline_.add(pose_ * vertices[i], 0.0);
  }

 private:
  const Pose pose_;
  Outline& outline_;

  void add(const Capsule& capsule) const {
    outline_.radius = capsule.radius;
    outline_.add(pose_ * capsule.start, capsule.radius);
    outline_.add(pose_ * capsule.end, capsule.radius);
  }
};

std::vector<Outline> outlines_of(const Body& body, const Pose& pose) {
  std::vector<Outline> outlines;
  for (const PlacedShape& placed : body.shapes) {
    Outline outline;
    std::visit(AddPoints(pose * placed.pose, outline), placed.shape);
    if (outline.hull.empty()) continue;
    outline.close();
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

std::vector<Outline> outlines_of(const Hand& hand) {
  std::vector<Outline> outlines;
  for (int i = 0; i < kCapsules; ++i) {
    if (!hand.has(i)) continue;
    const Capsule& capsule = hand.capsules[static_cast<std::size_t>(i)];
    Outline outline;
    outline.radius = capsule.radius;
    outline.add(capsule.start, capsule.radius);
    outline.add(capsule.end, capsule.radius);
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

/// One thing's shadow: a net of square cells, clear where it ends.
class Shadow {
 public:
  Shadow(std::vector<Outline> outlines, double ground) : outlines_(std::move(outlines)), ground_(ground) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const Outline& outline : outlines_) lowest = std::min(lowest, outline.lowest);
    height_ = lowest - ground;
    soft_ = kSoft + kSoftening * std::max(0.0, height_);
    dark_ = kDark * kFaintAt / (kFaintAt + std::max(0.0, height_));
  }

  void add_to(Marker& marker) {
    if (outlines_.empty() || height_ < -kSunk || height_ > kHighest) return;
    Eigen::AlignedBox2d extent;
    for (const Outline& outline : outlines_)
      for (const Point& point : outline.hull) {
        const Point reach = Point::Constant(outline.radius + soft_);
        extent.extend(point - reach);
        extent.extend(point + reach);
      }
    columns_ = 2 + static_cast<int>(extent.sizes().x() / kCell);
    const int rows = 2 + static_cast<int>(extent.sizes().y() / kCell);
    std::vector<double> below = opacities(extent.min(), 0), above;
    for (int row = 0; row + 1 < rows; ++row, below.swap(above)) {
      above = opacities(extent.min(), row + 1);
      for (int column = 0; column + 1 < columns_; ++column)
        add_cell(extent.min(), row, column, below, above, marker);
    }
  }

 private:
  std::vector<double> opacities(const Point& begin, int row) const {
    std::vector<double> values;
    for (int column = 0; column < columns_; ++column)
      values.push_back(opacity(begin + kCell * Point(column, row)));
    return values;
  }

  double opacity(const Point& point) const {
    double distance = std::numeric_limits<double>::infinity();
    for (const Outline& outline : outlines_) distance = std::min(distance, outline.distance(point));
    const double share = std::clamp(0.5 - distance / (2.0 * soft_), 0.0, 1.0);
    return dark_ * share * share * (3.0 - 2.0 * share);
  }

  void add_cell(const Point& begin, int row, int column, const std::vector<double>& below,
                const std::vector<double>& above, Marker& marker) const {
    const auto i = static_cast<std::size_t>(column);
    if (std::max({below[i], below[i + 1], above[i], above[i + 1]}) < kLeastOpacity) return;
    const auto add_corner = [&](int right, int up) {
      const Point place = begin + kCell * Point(column + right, row + up);
      const std::vector<double>& values = up ? above : below;
      marker.points.push_back(to_message(Vector3(place.x(), place.y(), ground_ + kLift)));
      marker.colors.push_back(color(0.0, 0.0, 0.0, values[i + static_cast<std::size_t>(right)]));
    };
    add_corner(0, 0), add_corner(1, 0), add_corner(1, 1);
    add_corner(0, 0), add_corner(1, 1), add_corner(0, 1);
  }

  std::vector<Outline> outlines_;
  double ground_, height_ = 0.0, soft_ = 0.0, dark_ = 0.0;
  int columns_ = 0;
};

bool is_under_all(double height, const Scene& scene) {
  return std::none_of(scene.bodies.begin(), scene.bodies.end(), [&](const Body& body) {
    return !body.fixed && !body.shapes.empty() && body.start.position.z() < height;
  });
}

bool is_level(const Pose& pose) {
  return std::abs((pose.orientation * Vector3::UnitZ()).z()) > 1.0 - 1e-6;
}

}  // namespace

double ground_height(const Scene& scene) {
  double lowest = kGrid + kClearance;
  for (const Body& body : scene.bodies)
    if (!body.fixed && !body.shapes.empty())
      lowest = std::min(lowest, body.start.position.z() - body.bounding_radius);
  double ground = lowest - kClearance;
  for (const Body& body : scene.bodies) {
    for (const PlacedShape& placed : body.shapes) {
      const Pose pose = body.start * placed.pose;
      const Box* const box = std::get_if<Box>(&placed.shape);
      if (!body.fixed || !box || !is_level(pose)) continue;
      const double top = pose.position.z() + box->half_extents.z();
      const bool wide = std::min(box->half_extents.x(), box->half_extents.y()) >= kWide;
      if (wide && is_under_all(top, scene)) ground = std::max(ground, top);
    }
  }
  return ground;
}

/// Not worked out anew for less than kStays.
template <typename Outlines>
void ShadowMarkers::add_one(int id, std::vector<Vector3> from, const Outlines& outlines, bool all,
                            MarkerLayer& layer) {
  Cast& cast = casts_[id];
  const bool moved =
      cast.from.size() != from.size() ||
      !std::equal(from.begin(), from.end(), cast.from.begin(),
                  [](const Vector3& a, const Vector3& b) { return (a - b).squaredNorm() < kStays * kStays; });
  if (!moved && !all) return;
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), color(0.0, 0.0, 0.0, 0.99));
  if (moved) {
    cast.from = std::move(from);
    Shadow(outlines(), ground_).add_to(marker);
    cast.marker.points = marker.points, cast.marker.colors = marker.colors;
  } else {
    marker.points = cast.marker.points, marker.colors = cast.marker.colors;
  }
  if (marker.points.empty()) marker.action = Marker::DELETE;
}

void ShadowMarkers::add(const SimulationState& state, const FrameResult& result, bool all,
                        MarkerLayer& layer) {
  const int hands = static_cast<int>(result.rendered.size());
  for (auto cast = casts_.begin(); cast != casts_.end();) {
    const bool gone = cast->first >= hands && cast->first < kFirstBody;
    if (gone)
      layer.add(cast->first, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), {}).action = Marker::DELETE;
    cast = gone ? casts_.erase(cast) : std::next(cast);
  }
  for (int i = 0; i < hands; ++i) {
    const Hand& hand = result.rendered[static_cast<std::size_t>(i)].hand;
    std::vector<Vector3> from;
    for (const Capsule& capsule : hand.capsules) from.insert(from.end(), {capsule.start, capsule.end});
    add_one(
        i, std::move(from), [&] { return outlines_of(hand); }, all, layer);
  }
  int bodies = 0;
  for (std::size_t i = 0; i < scene_.bodies.size() && bodies < kMostBodies; ++i) {
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
