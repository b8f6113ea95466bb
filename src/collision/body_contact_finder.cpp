#include "body_contact_finder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "contact_region.h"
#include "step_motion.h"

namespace mrhi {
namespace {

/// Largest gap of a contact; pairs farther apart are swept through the step [m].
constexpr double kMaxGap = 0.001;
/// Gap at which an approach has ended, so that the next one may cause an impact again [m].
constexpr double kMinSeparation = 1e-5;
/// Smallest breadth of a load-bearing contact region [m]. Boxes that overlap by less in two directions touch
/// only along an edge and pass each other. From there to twice that, the stiffness grows to its full value.
/// Pairs that may move farther within the step have contacts all the same.
constexpr double kMinBreadth = 1e-6;
/// Largest ratio of a body's velocity after an impact to that of the body that hits it: of masses M and m the
/// lighter one leaves with (1 + e) v M / (M + m) < 2 v.
constexpr double kMaxImpactSpeedRatio = 2.0;

/// Geometric means: two alike bodies have their own, and either's zero is the pair's. A touch's stiffness is
/// `contact/object_stiffness`, whatever the pair.
Material together(const Material& a, const Material& b) {
  Material material;
  material.restitution = std::sqrt(a.restitution * b.restitution);
  material.static_friction = std::sqrt(a.static_friction * b.static_friction);
  material.dynamic_friction = std::sqrt(a.dynamic_friction * b.dynamic_friction);
  return material;
}

/// Bound of a body's surface speed due to its spin: |w| R [m/s].
double fastest_point(const MovingBody& moving) {
  return moving.twist.angular.norm() * moving.body.bounding_radius;
}

/// Lower bound of the distance of a point from a shape [m]: its distance from the box about the shape, whose
/// components are max(|x_i| - half_i, 0). Less than the true distance beside a round side.
double distance_lower_bound(const Vector3& point, const PlacedCollider& shape, const Pose& body) {
  if (!shape.prism) return 0.0;
  const Vector3 local = shape.pose.to_local(body.to_local(point));
  return (local.cwiseAbs() - shape.prism->half).cwiseMax(0.0).norm();
}

struct ShapePair {
  const MovingBody& a;
  const MovingBody& b;
  const PlacedCollider& shape_a;
  const PlacedCollider& shape_b;
  SearchBudget& budget;

  Manifold at(double time, double margin) const {
    return body_manifold(shape_a, a.at(time) * shape_a.pose, shape_b, b.at(time) * shape_b.pose, margin,
                         kAnyBreadth, &budget);
  }
  Manifold now(double margin, double least_breadth) const {
    return body_manifold(shape_a, a.pose * shape_a.pose, shape_b, b.pose * shape_b.pose, margin,
                         least_breadth, &budget);
  }
};

/// Manifold of a pair as it is now, or at the time of impact within the step.
struct TimedManifold {
  Manifold manifold;
  double time = -1.0;  // of impact [s]; -1: now
};

/// The rate of each gap is n.(v_a - v_b) of its point as one of both, n from b to a (Eq. 8). As turning may
/// bring another corner down before the nearest one, the pair's rate is that of the gap that closes first, in
/// proportion to it.
std::optional<TimedManifold> sweep_pair(const ShapePair& pair, double step, double margin) {
  const auto separation = [&](double time) -> std::optional<Separation<Manifold>> {
    const Manifold manifold = pair.at(time, margin);
    if (manifold.count == 0) return std::nullopt;
    const Vector3 centre_a = pair.a.at(time).position, centre_b = pair.b.at(time).position;
    const double gap = -manifold.deepest().depth;
    double rate = gap;
    for (const ManifoldPoint& point : manifold) {
      const Vector3 relative =
          pair.a.velocity(time, point.point - centre_a) - pair.b.velocity(time, point.point - centre_b);
      const double closing = manifold.normal_of(point.region).dot(relative);
      if (point.depth < 0.0) rate = std::min(rate, closing * (gap / -point.depth));
    }
    return Separation<Manifold>{manifold, gap, rate};
  };
  const auto touch = first_touch<Manifold>(separation, step);
  if (!touch) return std::nullopt;
  return TimedManifold{touch->features, touch->time};
}

std::optional<TimedManifold> find_manifold(const ShapePair& pair, double step, double followed,
                                           double margin) {
  const double least_breadth = followed < 2.0 * kMinSeparation ? kMinBreadth : kAnyBreadth;
  const Manifold manifold = pair.now(margin, least_breadth);
  if (manifold.count == 0) return std::nullopt;
  if (manifold.deepest().depth >= -followed) return TimedManifold{manifold};
  return sweep_pair(pair, step, margin);
}

/// Moves the anchors to the point of friction, half of their stretch xi = A - B to either side: xi stays, but
/// the anchors of a pair that rolls or turns are where it touches now.
void anchor(const MovingBody& a, const MovingBody& b, BodyContact& contact) {
  const Vector3 place = contact.point + contact.friction_offset;
  contact.anchor_a = a.pose.to_local(place + 0.5 * contact.stretch);
  contact.anchor_b = b.pose.to_local(place - 0.5 * contact.stretch);
}

/// Largest relative spread of corners' distances from the centre that may lie on a rim.
constexpr double kRimTolerance = 0.01;
/// Mean distance of a disc's points from its centre, over its radius.
constexpr double kDiscMeanRadius = 2.0 / 3.0;

/// True if four places on the rim of a can's cap touch.
bool on_rim(const ShapePair& pair, const Vector3& normal, const std::array<Place, 4>& places) {
  const auto stands = [&](const ManifoldShape& shape, const Pose& pose) {
    return shape.prism && shape.prism->round &&
           std::abs((pose.orientation * Vector3::UnitZ()).dot(normal)) > kSameFace;
  };
  if (!stands(pair.shape_a, pair.a.pose * pair.shape_a.pose) &&
      !stands(pair.shape_b, pair.b.pose * pair.shape_b.pose))
    return false;
  Place middle{};
  for (const Place& place : places) middle = {middle[0] + 0.25 * place[0], middle[1] + 0.25 * place[1]};
  std::array<double, 4> distances{};
  std::transform(places.begin(), places.end(), distances.begin(),
                 [&](const Place& place) { return std::hypot(place[0] - middle[0], place[1] - middle[1]); });
  const auto [nearest, farthest] = std::minmax_element(distances.begin(), distances.end());
  return *farthest - *nearest < kRimTolerance * *farthest;
}

/// Moves the points of friction towards the centre of the load, by spread_of(): sliding has the same force
/// and moment as before, spinning that of a face under an even load. `loads`: of the last step; if all are 0,
/// the load is even.
void place_friction(const ShapePair& pair, const std::array<BodyContact*, 4>& region,
                    const std::array<double, 4>& loads, int count) {
  if (count < 2) return;
  const Vector3& normal = region[0]->normal;
  const Vector3 u = normal.unitOrthogonal(), v = normal.cross(u);
  std::array<Place, 4> places{};
  Vector3 centre = Vector3::Zero(), even = Vector3::Zero();
  double load = 0.0;
  for (int i = 0; i < count; ++i) {
    const BodyContact& contact = *region[i];
    const Vector3 offset = contact.point - region[0]->point;
    places[i] = {u.dot(offset), v.dot(offset)};
    centre += loads[i] * contact.point;
    load += loads[i];
    even += contact.point / count;
  }
  centre = load > 0.0 ? Vector3(centre / load) : even;
  const double spread =
      count == 4 && on_rim(pair, normal, places) ? kDiscMeanRadius : spread_of(places, count);
  for (int i = 0; i < count; ++i) {
    BodyContact& contact = *region[i];
    const Vector3 inwards = (1.0 - spread) * (centre - contact.point);
    contact.friction_offset = inwards - normal.dot(inwards) * normal;
  }
}

/// Stiffness of a strip of contact, as a fraction of the pair's.
double stiffness_of(double breadth) {
  return std::clamp(breadth / kMinBreadth - 1.0, 0.0, 1.0);
}

/// For a pair that meets within the step, points, arms and depths, at most 0, are those at the first touch.
/// All points have equal fractions of the pair's stiffness. `memory`: of the last step; null if the surfaces
/// did not touch. Its force stays across a gap, as what the response starts from: in a wall that leans, half
/// of the loaded contacts are apart by a rounding error. True if the surfaces overlap, and did in the last
/// step.
bool make_contact(const BodyContactKey& key, const ShapePair& pair, const TimedManifold& touch,
                  const ManifoldPoint& point, const BodyContactMemory* memory, BodyContact& contact) {
  if (memory != nullptr) static_cast<BodyContactMemory&>(contact) = *memory;
  const bool lasting = contact.depth > 0.0 && point.depth > 0.0;
  contact.key = key;
  contact.point = point.point;
  contact.normal = touch.manifold.normal_of(point.region);
  contact.depth = touch.time < 0.0 ? point.depth : std::min(point.depth, 0.0);
  contact.share = stiffness_of(touch.manifold.breadth) / touch.manifold.count_of(point.region);
  contact.first_touch = touch.time;
  contact.struck = contact.struck && point.depth > -kMinSeparation;
  contact.material = together(pair.a.body.material, pair.b.body.material);
  const double time = std::max(0.0, touch.time);
  contact.arm_a = point.point - pair.a.at(time).position;
  contact.arm_b = point.point - pair.b.at(time).position;
  contact.friction_offset.setZero();
  contact.stretch.setZero();
  if (lasting) {
    const Vector3 apart = pair.a.pose * contact.anchor_a - pair.b.pose * contact.anchor_b;
    contact.stretch = apart - contact.normal.dot(apart) * contact.normal;
  } else {
    contact.friction = Friction::sticking;
  }
  return lasting;
}

/// Insertion sort: gcc 14 warns of a read out of bounds in std::sort of so few points.
void sort_points(Manifold& manifold) {
  const auto before = [](const ManifoldPoint& x, const ManifoldPoint& y) { return x.feature < y.feature; };
  for (int count = 1; count < manifold.count; ++count) {
    ManifoldPoint* const next = manifold.begin() + count;
    std::rotate(std::upper_bound(manifold.begin(), next, *next, before), next, next + 1);
  }
}

}  // namespace

BodyContactFinder::BodyContactFinder(const Scene& scene, const SceneGeometry& geometry,
                                     const Vector3& gravity)
    : scene_(scene), geometry_(geometry), gravity_(gravity) {
  before_.reserve(16 * scene.bodies.size());
}

/// World-aligned boxes with a margin for the step are tested before shapes. simulation/sleeping.cpp keeps the
/// contacts of sleeping pairs.
void BodyContactFinder::find(const Neighbours& neighbours, const std::vector<BodyState>& bodies,
                             const std::vector<char>& asleep, double step, double driven,
                             std::vector<BodyContact>& contacts) {
  before_.assign(contacts.begin(), contacts.end());
  contacts.clear();
  work_ = 0.0;
  followed_ = followed_gap(neighbours, bodies, asleep, step, driven);
  memory_index_ = 0;
  step_boxes_.resize(bodies.size());
  for (const int body : neighbours.paired()) step_boxes_[body].reset();
  const auto reach = [&](std::size_t body) -> StepBox& {
    std::optional<StepBox>& found = step_boxes_[body];
    return found ? *found : found.emplace(step_box(body, bodies[body], step));
  };
  for (const auto& [a, b] : neighbours.pairs()) {
    const auto ia = static_cast<std::size_t>(a), ib = static_cast<std::size_t>(b);
    if (asleep[ib] && (asleep[ia] || scene_.bodies[ia].fixed)) continue;
    StepBox &of_a = reach(ia), &of_b = reach(ib);
    const Vector3 apart = (of_a.centre - of_b.centre).cwiseAbs() - of_a.half - of_b.half;
    if (apart.maxCoeff() > 0.0) continue;
    if (!of_a.moving) of_a.moving.emplace(scene_.bodies[ia], bodies[ia], gravity_);
    if (!of_b.moving) of_b.moving.emplace(scene_.bodies[ib], bodies[ib], gravity_);
    find_pair(ia, ib, step, contacts);
  }
}

/// Largest displacement by an impact within the step. Where nothing moves it is almost 0: the bricks of a
/// wall have no contact with those beside them. |w| = |I^-1 L| <= tr(I^-1) |L|, as the trace of a positive
/// matrix is no less than its greatest eigenvalue.
double BodyContactFinder::followed_gap(const Neighbours& neighbours, const std::vector<BodyState>& bodies,
                                       const std::vector<char>& asleep, double step, double driven) const {
  double fastest = driven;
  for (const int listed : neighbours.paired()) {
    const auto b = static_cast<std::size_t>(listed);
    const Body& body = scene_.bodies[b];
    if (body.fixed || asleep[b]) continue;
    const double spin = body.inverse_inertia.trace() * bodies[b].angular_momentum.norm();  // at most
    fastest = std::max(fastest, bodies[b].linear_momentum.norm() / body.mass + body.bounding_radius * spin);
  }
  return std::min(kMaxGap, kMinSeparation + kMaxImpactSpeedRatio * step * fastest);
}

/// The axis-aligned box that contains a body through this step. A box rotated by R extends by sum_j |R_ij|
/// half_j along world axis i (its support function); v h + g h^2 / 2 is its displacement in the step h.
BodyContactFinder::StepBox BodyContactFinder::step_box(std::size_t index, const BodyState& state,
                                                       double step) const {
  const Body& body = scene_.bodies[index];
  const std::vector<PlacedCollider>& shapes = geometry_.colliders[index];
  StepBox reach;
  reach.centre = state.pose.position;
  reach.half = Vector3::Constant(body.bounding_radius);
  reach.travel = 0.5 * followed_;
  if (!body.fixed) {
    reach.travel += step * (state.linear_momentum.norm() / body.mass + 0.5 * step * gravity_.norm());
  }
  double turned = 0.0;
  if (shapes.size() == 1 && shapes[0].prism) {
    const Pose pose = state.pose * shapes[0].pose;
    reach.centre = pose.position;
    reach.half = pose.orientation.toRotationMatrix().cwiseAbs() * shapes[0].prism->half;
    // No faster than the momentum about the axis of least inertia.
    turned = step * body.bounding_radius * state.angular_momentum.norm() * body.inverse_inertia.trace();
  }
  reach.half.array() += reach.travel + turned;
  return reach;
}

/// Of the contact in the last step, if there was one. Keys must be queried in order.
const BodyContactMemory* BodyContactFinder::memory_of(const BodyContactKey& key) {
  while (memory_index_ < before_.size() && before_[memory_index_].key < key) ++memory_index_;
  return memory_index_ < before_.size() && before_[memory_index_].key == key ? &before_[memory_index_]
                                                                             : nullptr;
}

/// The margin is the distance that the two can close in the step; pairs farther apart have no manifold.
void BodyContactFinder::find_pair(std::size_t ia, std::size_t ib, double step,
                                  std::vector<BodyContact>& contacts) {
  const double travel = step_boxes_[ia]->travel + step_boxes_[ib]->travel;
  const MovingBody &a = *step_boxes_[ia]->moving, &b = *step_boxes_[ib]->moving;
  const double turned = fastest_point(a) * step, margin = travel + turned + fastest_point(b) * step;
  const double within =
      b.body.bounding_radius + travel + turned;  // of b's centre: its own turning is in the ball
  const std::vector<PlacedCollider>&of_a = geometry_.colliders[ia], &of_b = geometry_.colliders[ib];
  centres_.clear();
  for (const PlacedCollider& shape : of_b) centres_.push_back(b.pose * shape.pose.position);
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    if (distance_lower_bound(b.pose.position, of_a[i], a.pose) > within) continue;
    const Vector3 centre = a.pose * of_a[i].pose.position;
    for (std::size_t j = 0; j < of_b.size(); ++j) {
      const double reach = of_a[i].bounding_radius + of_b[j].bounding_radius + margin;
      if ((centre - centres_[j]).squaredNorm() > reach * reach) continue;
      SearchBudget budget = SearchBudget::after(work_);
      const ShapePair pair{a, b, of_a[i], of_b[j], budget};
      auto touch = find_manifold(pair, step, followed_, margin);
      work_ += budget.spent;
      if (!touch) continue;
      sort_points(touch->manifold);
      const std::size_t first = contacts.size();
      // Of the contacts from `first` on.
      std::array<std::uint8_t, 4 * Manifold::kMaxRegions> regions{};
      std::array<bool, 4 * Manifold::kMaxRegions> lasting{};
      for (const ManifoldPoint& point : touch->manifold) {
        const BodyContactKey key{static_cast<std::uint16_t>(ia), static_cast<std::uint16_t>(ib),
                                 static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(j), point.feature};
        const std::size_t k = contacts.size() - first;
        regions[k] = point.region;
        lasting[k] = make_contact(key, pair, *touch, point, memory_of(key), contacts.emplace_back());
      }
      for (int region = 0; region < Manifold::kMaxRegions; ++region) {
        std::array<BodyContact*, 4> together{};
        std::array<double, 4> loads{};
        int count = 0;
        for (std::size_t k = first; k < contacts.size(); ++k) {
          if (regions[k - first] != region) continue;
          if (lasting[k - first]) loads[count] = std::max(0.0, -contacts[k].normal.dot(contacts[k].force));
          together[count++] = &contacts[k];
        }
        if (count == 0) break;  // regions are numbered from 0
        place_friction(pair, together, loads, count);
      }
      for (std::size_t k = first; k < contacts.size(); ++k) anchor(a, b, contacts[k]);
    }
  }
}

}  // namespace mrhi
