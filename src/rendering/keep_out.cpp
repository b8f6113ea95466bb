#include <algorithm>
#include <limits>

#include "renderer.h"

namespace mrhi {
namespace {

/// Part of a hand that is kept as it was shown if the hand would move too far: its offset; or the palm, which
/// lags, with axes chosen by joint limits; or also its axes, about which fingers bend.
enum class KeptPart { offset, palm, axes };

constexpr int kMaxPasses = 12;
/// Passes without improvement after which the hand is not brought into step any further.
constexpr int kMaxStalledPasses = 2;
/// A gap below this fraction of the best one is an improvement.
constexpr double kImprovement = 0.9;
/// Bound of a fingertip's turn in a frame: this [m] plus this fraction of the displacement of hand and
/// bodies. The whole hand takes the rest.
constexpr double kMinSwing = 0.0005, kSwingFraction = 0.8;
/// Swing without a bound [m].
constexpr double kNoSwingLimit = 1.0;
/// Distance by which a joint may move farther than the farthest tracked joint in a frame [m].
constexpr double kPaceMargin = 0.0018;
/// A pass that moves joints by less is the last one: new penetrations are no deeper than that [m].
constexpr double kMinStep = 1e-4;

constexpr std::uint16_t kNoBody = std::numeric_limits<std::uint16_t>::max();

/// Key of one end of a capsule: 0 is its start, 1 its end.
ContactKey key_of(std::size_t capsule, int end) {
  ContactKey key{};
  key.point = key.shape = static_cast<std::uint8_t>(end);
  key.capsule = static_cast<std::uint8_t>(capsule);
  key.body = kNoBody;
  return key;
}

constexpr int kMaxSweeps = 40;
/// The solver has converged if no gap changes by more in a sweep [m].
constexpr double kConvergedShift = 1e-5;
/// Largest turn of a joint in one solution: rotations are linearised [rad].
constexpr double kMaxTurn = 0.25;

/// Bound of the joints' change since the previous frame: a fingertip moves by at most `swing` [m].
struct OffsetBounds {
  const HandOffset& before;
  double swing;
};

/// The unknowns of one finger: `free` without limits, `held` within them.
struct Part {
  FingerOffset lower, upper, compliance, free, held;
};

/// Finds the offset nearest to `reference`, weighted by inverse compliances, that keeps all gaps non-negative
/// and all joints in their limits:
///   minimise 1/2 (q - q0)' W (q - q0)  subject to  gap + J (q - qk) >= 0,  lower <= q <= upper,
/// linearised where the hand is placed now (qk, `from`). Dual coordinate ascent (Hildreth 1957), limits by
/// clamping, warm start with the clearances' pressures. A joint turns by at most a quarter of a radian.
///
/// With multipliers l >= 0 of the gaps, W (q - q0) = J^T l up to the forces of limits. W is diagonal: for
/// given l, the best q within the limits is q0 + W^-1 J^T l (`free`) with each component clamped (`held`).
/// The remaining dual function of l is concave, so that coordinate ascent reaches its maximum.
class OffsetProblem {
 public:
  OffsetProblem(const HandOffset& reference, const OffsetBounds& bounds, HandChain& chain, const Hand& placed,
                std::vector<Clearance>& clearances, const HandOffset& from)
      : bounds_(bounds), chain_(chain), clearances_(clearances) {
    shift_ << reference.shift.array(), 0.0;
    for (Clearance& clearance : clearances_) {
      linearise(placed, clearance);
      const int f = HandChain::finger_that_moves(clearance.key.capsule);
      if (f >= 0 && !used_[f]) use(f, reference, from);
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

  /// Returns the smallest linearised gap [m].
  double least_gap() {
    double min_gap = 0.0;
    for (const Clearance& clearance : clearances_)
      min_gap = std::min(min_gap, gap_of(clearance, part_of(clearance)));
    return min_gap;
  }

  void result(const HandOffset& reference, HandOffset& offset) const {
    offset.shift = shift_.head<3>();
    for (int f = 0; f < kFingers; ++f) offset.fingers[f] = used_[f] ? parts_[f].held : reference.fingers[f];
  }

 private:
  /// Intersects the bounds. Limits come last, so that lower <= upper and joint limits always hold.
  void use(int f, const HandOffset& reference, const HandOffset& from) {
    used_[f] = true;
    const FingerChain& finger = chain_.finger(f);
    Part& part = parts_[f];
    const FingerOffset swing = finger.swing(bounds_.swing);
    const FingerOffset &now = from.fingers[f], &before = bounds_.before.fingers[f];
    part.upper = finger.upper().min(now + kMaxTurn).min(before + swing).max(finger.lower());
    part.lower = finger.lower().max(now - kMaxTurn).max(before - swing).min(part.upper);
    part.compliance = finger.compliance();
    part.free = reference.fingers[f];
    part.held = part.free.max(part.lower).min(part.upper);
  }

  ///     J = (n; a.((x - p) x n) for each joint with the axis a through p),   x the capsule's axis point
  void linearise(const Hand& placed, Clearance& clearance) {
    const int capsule = clearance.key.capsule, f = HandChain::finger_that_moves(capsule);
    clearance.by_shift << clearance.normal.array(), 0.0;
    if (f < 0) return;
    const Vector3 point = placed.capsules[capsule].axis_point(clearance.s);
    clearance.by_finger = chain_.finger(f).gradient(bone_of(capsule), point, clearance.normal);
  }

  /// rest = gap - J q_k, so that the gap is rest + J q. Warm start with the pressures of the last pass.
  void begin(Clearance& clearance, int f, const HandOffset& from) {
    clearance.rest = clearance.gap - (clearance.by_shift.head<3>() * from.shift.array()).sum();
    shift_ += (kShiftCompliance * clearance.pressure) * clearance.by_shift;
    if (f < 0) return;
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
    return finger < 0 ? nullptr : &parts_[finger];
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
  HandChain& chain_;
  std::vector<Clearance>& clearances_;
  Eigen::Array4d shift_;
  std::array<Part, kFingers> parts_;
  std::array<bool, kFingers> used_{};
};

}  // namespace

/// Limits the displacement of a shown hand's joints in a frame.
class Pace {
 public:
  /// Joints stay within `limit` of where they were in `before` [m]. Keeps a reference.
  Pace(const Hand& before, double limit) : before_(before), limit_(limit) {}

  /// Distance by which the farthest joint exceeds the limit [m]; negative if none does.
  double beyond(const Hand& placed) const { return farthest_joint(before_, placed) - limit_; }

  /// Adds a clearance for each joint beyond the limit, and updates those of joints in `clearances`. Returns
  /// the smallest gap [m], at most 0.
  ///
  /// The ball |x - x0| <= limit is linearised: its tangent plane at the joint's side, with n = (x0 - x) /
  /// |x0 - x|, has n.x >= n.x0 - limit, and the gap there is limit - |x - x0|. The capsule's radius is
  /// subtracted from the height, as a clearance's gap subtracts it too: the gap is that of the axis. If a
  /// joint moves aside, the plane turns from pass to pass.
  double keep(const Hand& placed, std::vector<Clearance>& clearances) const {
    double min_gap = 0.0;
    for (std::size_t c = 0; c < kCapsules; ++c) {
      const Capsule &from = before_.capsules[c], &to = placed.capsules[c];
      if (from.radius <= 0.0 || to.radius <= 0.0) continue;
      for (int end = 0; end < 2; ++end) {
        const Vector3 &start = end == 0 ? from.start : from.end, &now = end == 0 ? to.start : to.end;
        const double gap = limit_ - (now - start).norm();
        const ContactKey key = key_of(c, end);
        auto known = std::find_if(clearances.begin(), clearances.end(),
                                  [&](const Clearance& clearance) { return clearance.key == key; });
        if (known == clearances.end()) {
          if (gap >= 0.0) continue;
          known = clearances.emplace(clearances.end());
          known->key = key;
          known->s = end;
        }
        known->normal = (start - now).normalized();
        known->height = known->normal.dot(start) - limit_ - to.radius;
        known->gap = gap;
        min_gap = std::min(min_gap, gap);
      }
    }
    return min_gap;
  }

  /// Removes the clearances of joints.
  static void forget(std::vector<Clearance>& clearances) {
    const auto ours = [](const Clearance& clearance) { return clearance.key.body == kNoBody; };
    clearances.erase(std::remove_if(clearances.begin(), clearances.end(), ours), clearances.end());
  }

 private:
  const Hand& before_;
  double limit_;
};

/// Deeper than kMaxShallowDepth, gaps depend on the side on which the hand was shown before, which the first
/// search of the frame did not know: they are computed again.
void HandRenderer::move_outside(double min_gap) {
  const HandOffset reference = offset_;
  if (min_gap < -ClearanceFinder::kMaxShallowDepth) restart(reference);
  keep_out(reference, kSwingFraction * view_->moved + kMinSwing);
}

/// A hand that is kept away from the axis about which the tracked hand turns would swing farther than it.
/// Limits that where the bodies leave space.
///
/// Tries in order: the solved offset at the pace of pushing bodies; at the hand's own pace; then the offset
/// that leaves the hand as it was shown, with more and more of the palm's lag. Keeps the best result that is
/// no deeper than allowed.
void HandRenderer::limit_pace(const HandOffset& reference) {
  if (farthest_joint(before_, *placed_) <= tracked_displacement_ + kPaceMargin) return;
  const Pace pace(before_, tracked_displacement_ + kPaceMargin);
  const double body_moved = body_displacement();
  const Pace body_pace(before_, tracked_displacement_ + body_moved + kPaceMargin);
  double least_beyond = pace.beyond(*placed_);
  HandOffset best = offset_;
  const auto try_pace = [&](const Pace& at, const HandOffset& nearest_to, double swing, double tolerated) {
    at.keep(*placed_, clearances_);
    settle(nearest_to, swing, &at, tolerated);
    Pace::forget(clearances_);
    const double beyond = pace.beyond(*placed_);
    if (beyond >= least_beyond || finder_.find(*placed_, clearances_) < -tolerated) return;
    least_beyond = beyond;
    best = offset_;
  };
  const double swing = kSwingFraction * view_->moved + kMinSwing;
  if (least_beyond > body_moved) try_pace(body_pace, reference, swing, kMaxDepth);
  if (least_beyond > kMaxDepth && body_moved > 0.0) try_pace(pace, reference, swing, kMaxDepth);
  PalmLag lag = reference.lag;
  for (const KeptPart kept : {KeptPart::offset, KeptPart::palm, KeptPart::axes}) {
    if (least_beyond <= kMaxDepth + body_moved) break;
    if (kept == KeptPart::palm) lag = lag_staying();
    if (kept == KeptPart::axes) lag.frame = frame_staying(lag.whole);
    chain_.begin(view_->track.current, lag);
    const HandOffset stay = staying(lag);
    restart(stay);
    try_pace(body_pace, stay, kNoSwingLimit, kept == KeptPart::offset ? kMaxDepth : kMaxPaceDepth);
  }
  leap_ = std::max(0.0, least_beyond - body_moved);
  offset_ = best;
  chain_.begin(view_->track.current, offset_.lag);
  chain_.place(offset_, *placed_);
}

/// Largest displacement of a loaded body towards the hand since the previous frame [m]: n.v of the body's
/// point at the capsule's surface, with n out of the body.
double HandRenderer::body_displacement() const {
  double fastest = 0.0;
  for (const Clearance& clearance : clearances_) {
    if (clearance.pressure <= 0.0) continue;
    const Capsule& capsule = placed_->capsules[clearance.key.capsule];
    const Vector3 point = capsule.axis_point(clearance.s) - capsule.radius * clearance.normal;
    fastest = std::max(fastest, clearance.normal.dot(finder_.velocity(clearance.key.body, point)));
  }
  return fastest * elapsed_;
}

/// The offset that leaves the hand where it was shown: joints keep their directions within their present
/// limits, and the shift cancels the palm's displacement.
HandOffset HandRenderer::staying(const PalmLag& lag) {
  place_before();
  HandOffset stay;
  stay.lag = lag;
  stay.shift = before_.palm.position - view_->track.current.palm.position;
  for (int f = 0; f < kFingers; ++f)
    stay.fingers[f] = chain_.finger(f).like(before_, chain_before_.finger(f));
  return stay;
}

/// Relaxes, in this order: the bound of a fingertip's turn; the reference offset, in favour of where the hand
/// was shown; bending around obstacles, in favour of a shift of the whole hand.
void HandRenderer::keep_out(const HandOffset& reference, double swing) {
  if (settle(reference, swing) > -kMaxDepth) return;
  restart(reference);
  if (settle(reference, kNoSwingLimit) > -kMaxDepth) return;
  if (view_->shown_before != nullptr) {
    const HandOffset stay = staying(offset_.lag);
    restart(stay);
    if (settle(stay, kNoSwingLimit) > -kMaxDepth) return;
  }
  restart(reference);
  shift_out();
}

/// Sequential quadratic programming: gaps are linearised where the hand is placed. Returns the smallest gap
/// [m].
///
/// Rows J of the gaps are n for the shift and FingerChain::gradient for joints. A plane is the surface's
/// tangent there. On curved surfaces, and once joints turn, it is right for small steps only, so that gaps
/// are computed again at the solution.
double HandRenderer::settle(const HandOffset& reference, double swing, const Pace* pace, double tolerated) {
  const int max_stalled_passes = tolerated > kMaxDepth ? kMaxPasses : kMaxStalledPasses;
  double min_gap = 0.0, best = std::numeric_limits<double>::lowest();
  int stalled_passes = 0;
  for (int pass = 0; pass < kMaxPasses && stalled_passes < max_stalled_passes; ++pass) {
    const HandOffset from = offset_;
    const OffsetBounds bounds{*last_, swing};
    OffsetProblem problem(reference, bounds, chain_, *placed_, clearances_, from);
    problem.solve();
    problem.result(reference, offset_);
    const double expected = problem.least_gap();
    chain_.place(offset_, *placed_);
    if (expected > -kClearDepth && displacement(from, offset_) < kMinStep) return expected;
    min_gap = finder_.find(*placed_, clearances_);
    if (pace != nullptr) min_gap = std::min(min_gap, pace->keep(*placed_, clearances_));
    if (min_gap > -kClearDepth) return min_gap;
    stalled_passes = pace != nullptr && min_gap < kImprovement * best ? stalled_passes + 1 : 0;
    best = std::max(best, min_gap);
  }
  return min_gap;
}

/// Places the hand with this offset, and finds its clearances. Returns the smallest gap [m].
double HandRenderer::restart(const HandOffset& reference) {
  offset_ = reference;
  chain_.place(offset_, *placed_);
  clearances_.clear();
  return finder_.find(*placed_, clearances_);
}

double HandRenderer::displacement(const HandOffset& from, const HandOffset& to) {
  double farthest = 0.0;
  for (int f = 0; f < kFingers; ++f) {
    const FingerOffset change = to.fingers[f] - from.fingers[f];
    if (!(change == 0.0).all()) farthest = std::max(farthest, chain_.finger(f).displacement(change));
  }
  return farthest + (to.shift - from.shift).norm();
}

/// Fallback for contradictory clearances: shifts the whole hand to the nearest side of the deepest body. For
/// a side with the normal n and height h, the deepest capsule is at min n.a - r - h < 0, and the hand is
/// outside after a shift by that along n.
void HandRenderer::shift_out() {
  constexpr int kMaxBodies = 4;
  for (int attempt = 0; attempt < kMaxBodies; ++attempt) {
    const auto deepest =
        std::min_element(clearances_.begin(), clearances_.end(),
                         [](const Clearance& a, const Clearance& b) { return a.gap < b.gap; });
    Vector3 shift = Vector3::Zero();
    double min_gap = std::numeric_limits<double>::max();
    for (const Clearance& side : clearances_) {
      if (side.key.body != deepest->key.body || side.key.shape != deepest->key.shape) continue;
      double reach = std::numeric_limits<double>::max();
      for (const Capsule& capsule : placed_->capsules) {
        if (capsule.radius <= 0.0) continue;
        const double lowest = std::min(side.normal.dot(capsule.start), side.normal.dot(capsule.end));
        reach = std::min(reach, lowest - capsule.radius - side.height);
      }
      if (-reach >= min_gap) continue;
      min_gap = -reach;
      shift = -reach * side.normal;
    }
    HandOffset shifted = offset_;
    shifted.shift += shift;
    if (restart(shifted) > -kMaxDepth) return;
  }
  trace_out();
}

/// Shifts the hand along the palm's axis on which it is outside after the shortest distance. Sphere tracing
/// (Hart 1996): with a gap of -d the hand is still inside after less than d, so that a step of d skips no
/// solution; kMinTraceStep ensures progress near the surface.
void HandRenderer::trace_out() {
  constexpr double kMaxTrace = 0.5, kMinTraceStep = 0.0005;  // [m]
  finder_.begin(*view_, offset_.shift.norm() + kMaxTrace);
  const Matrix3 palm = view_->track.current.palm.orientation.toRotationMatrix();
  double nearest = kMaxTrace;
  const Vector3 from = offset_.shift;
  HandOffset tried = offset_, out = offset_;
  for (int direction = 0; direction < 6; ++direction) {
    const Vector3 axis = (direction < 3 ? 1.0 : -1.0) * palm.col(direction % 3);
    for (double gone = 0.0; gone < nearest;) {
      tried.shift = from + gone * axis;
      const double min_gap = restart(tried);
      if (min_gap > -kMaxDepth) {
        nearest = gone;
        out = tried;
      }
      gone += std::max(-min_gap, kMinTraceStep);
    }
  }
  offset_ = out;
  chain_.place(offset_, *placed_);
}

}  // namespace mrhi
