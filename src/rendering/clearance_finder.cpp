#include <algorithm>
#include <cmath>

#include "renderer.h"

namespace mrhi {
namespace {

/// Largest distance from a body at which a hand was on one side of it [m].
constexpr double kMaxSideDistance = 0.5;
/// Tolerance by which a plane of the previous frame may ask for more than the hand and bodies have moved [m].
constexpr double kRoundness = 0.005;
/// Tolerance of the test that a plane bounds a shape [m].
constexpr double kPlaneTolerance = 1e-4;
/// Smallest cosine between normals of one side of a body.
constexpr double kMinSameSideCosine = 0.5;

const Contact* touching(const std::vector<Contact>& contacts, int slot, int capsule, int body, int shape) {
  for (const Contact& contact : contacts) {
    const ContactKey& key = contact.key;
    if (key.hand == slot && key.capsule == capsule && key.body == body && key.shape == shape &&
        contact.touching())
      return &contact;
  }
  return nullptr;
}

double deepest_end(const Capsule& capsule, const Vector3& normal) {
  return normal.dot(capsule.end - capsule.start) < 0.0 ? 1.0 : 0.0;
}

/// Height of a capsule's surface above a plane [m].
double height(const Capsule& capsule, const Vector3& normal, const Vector3& point) {
  return std::min(normal.dot(capsule.start - point), normal.dot(capsule.end - point)) - capsule.radius;
}

bool outside(const Capsule& capsule, const Vector3& normal, const Vector3& point) {
  return height(capsule, normal, point) > -ClearanceFinder::kShallow;
}

/// True if the plane can bound the shape. The height above a plane that has all of a convex shape below it is
/// a lower bound of the distance. A plane of an earlier frame may violate this if the shape is hollow or has
/// turned.
bool keeps_out(const Capsule& capsule, const Vector3& normal, const Vector3& point, double distance) {
  return height(capsule, normal, point) <= distance + kPlaneTolerance;
}

/// n.a(s) - height - r, with n.x = height the plane and r the capsule's radius.
double gap(const Capsule& capsule, const Clearance& clearance) {
  return clearance.normal.dot(capsule.axis_point(clearance.s)) - clearance.height - capsule.radius;
}

/// The entry of this key, created if there is none. Removes entries of another side of the shape.
Clearance& entry(const ContactKey& key, const Vector3& normal, std::vector<Clearance>& clearances) {
  const auto other_side = [&](const Clearance& known) {
    return known.key.same_pair(key) && known.normal.dot(normal) < kMinSameSideCosine;
  };
  clearances.erase(std::remove_if(clearances.begin(), clearances.end(), other_side), clearances.end());
  for (Clearance& known : clearances) {
    if (known.key == key) return known;
  }
  clearances.emplace_back();
  clearances.back().key = key;
  return clearances.back();
}

constexpr int kMaxSweeps = 40;
/// The solver has converged if no gap changes by more in a sweep [m].
constexpr double kConvergedShift = 1e-5;
/// Largest turn of a joint in one solution: rotations are linearised [rad].
constexpr double kMaxTurn = 0.25;

using Array4 = Eigen::Array4d;

/// The unknowns of one finger: `free` without limits, `held` within them.
struct Part {
  FingerOffset lower, upper, compliance, free, held;
};

/// With multipliers l >= 0 of the gaps, W (q - q0) = J^T l up to the forces of limits. W is diagonal: for
/// given l, the best q within the limits is q0 + W^-1 J^T l (`free`) with each component clamped (`held`).
/// The remaining dual function of l is concave, so that coordinate ascent reaches its maximum.
class OffsetProblem {
 public:
  OffsetProblem(const HandOffset& reference, const OffsetBounds& bounds, HandChain& chain,
                std::vector<Clearance>& clearances, const HandOffset& from)
      : bounds_(bounds), clearances_(clearances) {
    shift_ << reference.shift.array(), 0.0;
    used_.fill(false);
    for (Clearance& clearance : clearances_) {
      const int f = HandChain::finger_that_moves(clearance.key.capsule);
      if (f >= 0) use(f, reference, chain, from);
      begin(clearance, f, from);
    }
  }

  void solve() {
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
      double largest = 0.0;
      for (Clearance& clearance : clearances_) largest = std::max(largest, relax(clearance));
      if (largest < kConvergedShift) return;
    }
  }

  double least_gap() {
    double min_gap = 0.0;
    for (const Clearance& clearance : clearances_)
      min_gap = std::min(min_gap, gap_of(clearance, part_of(clearance)));
    return min_gap;
  }

  void result(const HandOffset& reference, HandOffset& offset) const {
    offset.shift = shift_.head<3>();
    for (std::size_t f = 0; f < kFingers; ++f)
      offset.fingers[f] = used_[f] ? parts_[f].held : reference.fingers[f];
  }

 private:
  /// Intersects the bounds. Limits come last, so that lower <= upper and joint limits always hold.
  void use(int finger, const HandOffset& reference, HandChain& chain, const HandOffset& from) {
    const auto f = static_cast<std::size_t>(finger);
    if (used_[f]) return;
    used_[f] = true;
    const FingerChain& fingers_chain = chain.finger(finger);
    Part& part = parts_[f];
    const FingerOffset swing = fingers_chain.swing(bounds_.swing);
    const FingerOffset &now = from.fingers[f], &before = bounds_.before.fingers[f];
    part.upper = fingers_chain.upper().min(now + kMaxTurn).min(before + swing).max(fingers_chain.lower());
    part.lower = fingers_chain.lower().max(now - kMaxTurn).max(before - swing).min(part.upper);
    part.compliance = fingers_chain.compliance();
    part.free = reference.fingers[f];
    part.held = part.free.max(part.lower).min(part.upper);
  }

  /// rest = gap - J q_k, so that the gap is rest + J q. Warm start with the pressures of the last pass.
  void begin(Clearance& clearance, int finger, const HandOffset& from) {
    clearance.rest = clearance.gap - (clearance.by_shift.head<3>() * from.shift.array()).sum();
    shift_ += (kShiftCompliance * clearance.pressure) * clearance.by_shift;
    if (finger < 0) return;
    const auto f = static_cast<std::size_t>(finger);
    clearance.rest -= (clearance.by_finger * from.fingers[f]).sum();
    comply(parts_[f], clearance, clearance.pressure);
  }

  static void comply(Part& part, const Clearance& clearance, double pressure) {
    part.free += (pressure * part.compliance) * clearance.by_finger;
    part.held = part.free.max(part.lower).min(part.upper);
  }

  double gap_of(const Clearance& clearance, const Part* part) const {
    const double gap = clearance.rest + (clearance.by_shift * shift_).sum();
    return part == nullptr ? gap : gap + (clearance.by_finger * part->held).sum();
  }
  Part* part_of(const Clearance& clearance) {
    const int finger = HandChain::finger_that_moves(clearance.key.capsule);
    return finger < 0 ? nullptr : &parts_[static_cast<std::size_t>(finger)];
  }

  /// Closes one gap, or reduces its pressure if it is open. Returns the change of the gap [m].
  /// dgap / dl = J W^-1 J^T over the free joints. A step of -gap / (dgap / dl) brings the gap to 0, or the
  /// pressure to 0 if it would become negative. If a joint meets its limit, the next sweep continues.
  double relax(Clearance& clearance) {
    Part* part = part_of(clearance);
    const double gap = gap_of(clearance, part);
    if (gap >= 0.0 && clearance.pressure == 0.0) return 0.0;
    double compliance = kShiftCompliance * clearance.by_shift.square().sum();
    if (part != nullptr) compliance += free_compliance(*part, clearance.by_finger, gap);
    const double pressure = std::max(0.0, clearance.pressure - gap / compliance);
    const double change = pressure - clearance.pressure;
    clearance.pressure = pressure;
    shift_ += (kShiftCompliance * change) * clearance.by_shift;
    if (part != nullptr) comply(*part, clearance, change);
    return std::abs(change) * compliance;
  }

  /// Compliance of the joints that can still turn in the direction that closes the gap.
  static double free_compliance(const Part& part, const FingerOffset& by_finger, double gap) {
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      const bool up = (by_finger[i] > 0.0) == (gap < 0.0);
      const bool stopped = up ? part.free[i] >= part.upper[i] : part.free[i] <= part.lower[i];
      sum += stopped ? 0.0 : part.compliance[i] * by_finger[i] * by_finger[i];
    }
    return sum;
  }

  const OffsetBounds& bounds_;
  std::vector<Clearance>& clearances_;
  Array4 shift_;
  std::array<Part, kFingers> parts_;
  std::array<bool, kFingers> used_;
};

}  // namespace

/// Tests the box about the tracked hand against the bounding sphere of each body.
bool ClearanceFinder::begin(const Setting& setting, double margin) {
  near_.clear();
  shown_in_.clear();
  const Eigen::AlignedBox3d hand = box_around(setting.tracked);
  for (std::size_t b = 0; b < setting.bodies.size(); ++b) {
    const Body& body = scene_.bodies[b];
    const Pose& pose = setting.bodies[b].pose;
    if (!is_near(hand, pose.position, body.bounding_radius + margin)) continue;
    const ContactFinder::PlacedFrame frame{pose.orientation.toRotationMatrix(), pose.position};
    std::vector<Near>& list = setting.interactions[b].shown_in ? shown_in_ : near_;
    for (int shape = 0; shape < static_cast<int>(body.shapes.size()); ++shape)
      list.push_back({static_cast<int>(b), shape, frame, pose.position, body.bounding_radius});
  }
  return !near_.empty();
}

void ClearanceFinder::end_shown_in(const Hand& shown, Interaction* interactions) const {
  for (const Near& near : shown_in_) interactions[near.body].shown_in = false;
  each_near(shown_in_, shown, 0.0, [&](int, const Capsule& capsule, const Near& near) {
    if (finder_.closest(capsule, near.body, near.shape, near.frame, 0.0))
      interactions[near.body].shown_in = true;
  });
}

/// |v| + |w| R.
double ClearanceFinder::fastest_body(const std::vector<BodyState>& bodies) const {
  double fastest = 0.0;
  for (const Near& near : near_) {
    const Body& body = scene_.bodies[static_cast<std::size_t>(near.body)];
    if (body.fixed) continue;
    const Twist twist = twist_of(body, bodies[static_cast<std::size_t>(near.body)]);
    fastest = std::max(fastest, twist.linear.norm() + twist.angular.norm() * near.radius);
  }
  return fastest;
}

Vector3 ClearanceFinder::velocity(int body, const Vector3& point,
                                  const std::vector<BodyState>& bodies) const {
  const auto b = static_cast<std::size_t>(body);
  if (scene_.bodies[b].fixed) return Vector3::Zero();
  const Twist twist = twist_of(scene_.bodies[b], bodies[b]);
  return twist.linear + twist.angular.cross(point - bodies[b].pose.position);
}

/// Visits pairs of capsule and body whose bounding spheres are within `margin`.
template <typename See>
void ClearanceFinder::each_near(const std::vector<Near>& bodies, const Hand& hand, double margin,
                                const See& see) {
  for (int c = 0; c < kCapsules; ++c) {
    const Capsule& capsule = hand.capsules[static_cast<std::size_t>(c)];
    if (capsule.radius <= 0.0) continue;
    const Vector3 centre = capsule.centre();
    const double around = 0.5 * (capsule.end - capsule.start).norm() + capsule.radius + margin;
    for (const Near& near : bodies) {
      const double reach = near.radius + around;
      if ((centre - near.centre).squaredNorm() <= reach * reach) see(c, capsule, near);
    }
  }
}

/// Keeps clearances of earlier passes with their planes. Without them a gap that its pressure has closed
/// would open again, and the passes would oscillate.
double ClearanceFinder::find(const Hand& placed, const Setting& setting, double margin,
                             std::vector<Clearance>& clearances) const {
  double min_gap = margin;
  each_near(near_, placed, margin, [&](int c, const Capsule& capsule, const Near& near) {
    AxisSpan span{};
    const auto features = finder_.closest(capsule, near.body, near.shape, near.frame, margin, &span);
    if (!features) return;
    const Face found = face(placed, c, near, *features, span, setting);
    const bool flat = found.s0 < found.s1;
    for (int end = 0; end < (flat ? 2 : 1); ++end) {
      const double s = end == 0 ? found.s0 : found.s1;
      const ContactKey key{static_cast<std::uint8_t>(flat ? end : s > 0.5),
                           static_cast<std::uint8_t>(near.shape), static_cast<std::uint8_t>(c),
                           static_cast<std::uint8_t>(setting.slot), static_cast<std::uint16_t>(near.body)};
      Clearance& clearance = entry(key, found.normal, clearances);
      clearance.s = s;
      clearance.normal = found.normal;
      clearance.height = found.normal.dot(found.point);
    }
  });
  for (Clearance& clearance : clearances) {
    clearance.gap = gap(placed.capsules[clearance.key.capsule], clearance);
    min_gap = std::min(min_gap, clearance.gap);
  }
  return min_gap;
}

bool ClearanceFinder::clear(const Hand& hand) const {
  bool clear = true;
  each_near(near_, hand, 0.0, [&](int, const Capsule& capsule, const Near& near) {
    clear = clear && !finder_.closest(capsule, near.body, near.shape, near.frame, 0.0);
  });
  return clear;
}

/// The face outside which the capsule stays. In order: the nearest surface if the capsule is shallow; the god
/// object's plane if the hand was shown on its side; the plane that was nearest in the previous frame. Deep
/// inside, the nearest surface may be on the far side of the body. A plane of the previous frame is rejected
/// if it asks for more than the hand and bodies have moved.
ClearanceFinder::Face ClearanceFinder::face(const Hand& placed, int c, const Near& near,
                                            const ClosestFeatures& features, const AxisSpan& span,
                                            const Setting& setting) const {
  const Face nearest{features.normal, features.point, span.s0, span.s1};
  if (features.distance > -kShallow) return nearest;
  const auto i = static_cast<std::size_t>(c);
  const Capsule& capsule = placed.capsules[i];
  const Capsule* before = setting.shown_before == nullptr ? nullptr : &setting.shown_before->capsules[i];
  if (const Contact* contact = touching(setting.contacts, setting.slot, c, near.body, near.shape)) {
    const bool same_side = before == nullptr || outside(*before, contact->normal, contact->point);
    if (same_side && contact->normal.dot(features.normal) >= kMinSameSideCosine) return nearest;
    const double s = deepest_end(capsule, contact->normal);
    const bool keeps = keeps_out(capsule, contact->normal, contact->point, features.distance);
    if (same_side && keeps) return {contact->normal, contact->point, s, s};
  }
  if (before == nullptr || before->radius <= 0.0) return nearest;
  const auto last = finder_.closest(*before, near.body, near.shape, near.frame, kMaxSideDistance);
  if (!last || last->distance < -kShallow || last->normal.dot(features.normal) >= kMinSameSideCosine)
    return nearest;
  // A distance longer than the displacement since then leads around a corner.
  const double s = features.axis_parameter;
  // r - n.(a - q): depth of the capsule below that plane.
  const double depth = capsule.radius - last->normal.dot(capsule.axis_point(s) - last->point);
  if (depth > setting.moved + kRoundness) return nearest;
  if (!keeps_out(capsule, last->normal, last->point, features.distance)) return nearest;
  return {last->normal, last->point, s, s};
}

double solve_offset(const HandOffset& reference, const OffsetBounds& bounds, HandChain& chain,
                    std::vector<Clearance>& clearances, HandOffset& offset) {
  OffsetProblem problem(reference, bounds, chain, clearances, offset);
  problem.solve();
  problem.result(reference, offset);
  return problem.least_gap();
}

}  // namespace mrhi
