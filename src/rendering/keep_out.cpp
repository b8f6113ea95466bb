#include <algorithm>
#include <limits>

#include "renderer.h"

namespace mrhi {
namespace {

/// Part of a hand that stays as it was shown if the hand would move too far: its offset; or the palm, which
/// lags, with axes chosen by joint limits; or also its axes, about which fingers bend.
enum class Stays { offset, palm, axes };

constexpr int kMaxPasses = 12;
/// Passes without improvement after which the hand is not brought into step any further.
constexpr int kMaxVainPasses = 2;
/// A gap below this fraction of the best one is an improvement.
constexpr double kImprovement = 0.9;
/// Bound of a fingertip's turn in a frame: this [m] plus this fraction of the displacement of hand and
/// bodies. The whole hand takes the rest.
constexpr double kMinSwing = 0.0005, kSwingFraction = 0.8;
/// Swing without a bound [m].
constexpr double kUnbounded = 1.0;
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

/// Deeper than kShallow, gaps depend on the side on which the hand was shown before, which the first search
/// of the frame did not know: they are computed again.
void HandRenderer::Impl::push_out(double min_gap) {
  const HandOffset reference = offset;
  if (min_gap < -ClearanceFinder::kShallow) begin_anew(reference);
  keep_out(reference, kSwingFraction * setting->moved + kMinSwing);
}

/// A hand that is kept away from the axis about which the tracked hand turns would swing farther than it.
/// Limits that where the bodies leave space.
///
/// Tries in order: the solved offset at the pace of pushing bodies; at the hand's own pace; then the offset
/// that leaves the hand as it was shown, with more and more of the palm's lag. Keeps the best result that is
/// no deeper than allowed.
void HandRenderer::Impl::keep_pace(const HandOffset& reference) {
  if (farthest_joint(before, *placed) <= tracked_displacement + kPaceMargin) return;
  const Pace pace(before, tracked_displacement + kPaceMargin);
  const double push = push_distance();
  const Pace pushed_pace(before, tracked_displacement + push + kPaceMargin);
  double least_beyond = pace.beyond(*placed);
  HandOffset best = offset;
  const auto in_step = [&](const Pace& at, const HandOffset& nearest_to, double swing, double tolerated) {
    at.keep(*placed, clearances);
    settle(nearest_to, swing, &at, tolerated);
    Pace::forget(clearances);
    const double beyond = pace.beyond(*placed);
    if (beyond >= least_beyond || finder.find(*placed, *setting, kLookAhead, clearances) < -tolerated) return;
    least_beyond = beyond;
    best = offset;
  };
  const double swing = kSwingFraction * setting->moved + kMinSwing;
  if (least_beyond > push) in_step(pushed_pace, reference, swing, kMaxDepth);
  if (least_beyond > kMaxDepth && push > 0.0) in_step(pace, reference, swing, kMaxDepth);
  PalmLag lag = reference.lag;
  for (const Stays stays : {Stays::offset, Stays::palm, Stays::axes}) {
    if (least_beyond <= kMaxDepth + push) break;
    if (stays == Stays::palm) lag = lag_staying();
    if (stays == Stays::axes) lag.frame = frame_staying(lag.whole);
    chain.begin(setting->tracked, lag);
    const HandOffset stay = staying(lag);
    begin_anew(stay);
    in_step(pushed_pace, stay, kUnbounded, stays == Stays::offset ? kMaxDepth : kMaxPaceDepth);
  }
  leap = std::max(0.0, least_beyond - push);
  offset = best;
  chain.begin(setting->tracked, offset.lag);
  chain.place(offset, *placed);
}

/// Largest displacement of a loaded body towards the hand since the previous frame [m]: n.v of the body's
/// point at the capsule's surface, with n out of the body.
double HandRenderer::Impl::push_distance() const {
  double fastest = 0.0;
  for (const Clearance& clearance : clearances) {
    if (clearance.pressure <= 0.0) continue;
    const Capsule& capsule = placed->capsules[clearance.key.capsule];
    const Vector3 point = capsule.axis_point(clearance.s) - capsule.radius * clearance.normal;
    fastest =
        std::max(fastest, clearance.normal.dot(finder.velocity(clearance.key.body, point, setting->bodies)));
  }
  return fastest * elapsed;
}

/// The offset that leaves the hand where it was shown: joints keep their directions within their present
/// limits, and the shift cancels the palm's displacement.
HandOffset HandRenderer::Impl::staying(const PalmLag& lag) {
  HandOffset stay;
  stay.lag = lag;
  stay.shift = before.palm.position - setting->tracked.palm.position;
  for (int f = 0; f < kFingers; ++f)
    stay.fingers[static_cast<std::size_t>(f)] = chain.finger(f).like(before, finger_before(f));
  return stay;
}

/// Relaxes, in this order: the bound of a fingertip's turn; the reference offset, in favour of where the hand
/// was shown; bending around obstacles, in favour of a shift of the whole hand.
void HandRenderer::Impl::keep_out(const HandOffset& reference, double swing) {
  if (settle(reference, swing) > -kMaxDepth) return;
  begin_anew(reference);
  if (settle(reference, kUnbounded) > -kMaxDepth) return;
  if (setting->shown_before != nullptr) {
    const HandOffset stay = staying(offset.lag);
    begin_anew(stay);
    if (settle(stay, kUnbounded) > -kMaxDepth) return;
  }
  begin_anew(reference);
  shift_out();
}

/// Sequential quadratic programming: gaps are linearised where the hand is placed. Returns the smallest gap
/// [m].
///
/// Rows J of the gaps are n for the shift and FingerChain::gradient for joints. A plane is the surface's
/// tangent there. On curved surfaces, and once joints turn, it is right for small steps only, so that gaps
/// are computed again at the solution.
double HandRenderer::Impl::settle(const HandOffset& reference, double swing, const Pace* pace,
                                  double tolerated) {
  const int max_vain_passes = tolerated > kMaxDepth ? kMaxPasses : kMaxVainPasses;
  double min_gap = 0.0, best = std::numeric_limits<double>::lowest();
  int vain_passes = 0;
  for (int pass = 0; pass < kMaxPasses && vain_passes < max_vain_passes; ++pass) {
    linearise();
    const HandOffset from = offset;
    const double expected = solve_offset(reference, {*last, swing}, chain, clearances, offset);
    chain.place(offset, *placed);
    if (expected > -kClearDepth && displacement(from, offset) < kMinStep) return expected;
    min_gap = finder.find(*placed, *setting, kLookAhead, clearances);
    if (pace != nullptr) min_gap = std::min(min_gap, pace->keep(*placed, clearances));
    if (min_gap > -kClearDepth) return min_gap;
    vain_passes = pace != nullptr && min_gap < kImprovement * best ? vain_passes + 1 : 0;
    best = std::max(best, min_gap);
  }
  return min_gap;
}

void HandRenderer::Impl::begin_anew(const HandOffset& reference) {
  offset = reference;
  chain.place(offset, *placed);
  clearances.clear();
  finder.find(*placed, *setting, kLookAhead, clearances);
}

///     J = (n; a.((x - p) x n) for each joint with the axis a through p),   x the capsule's axis point
void HandRenderer::Impl::linearise() {
  for (Clearance& clearance : clearances) {
    const int capsule = clearance.key.capsule;
    const int finger_index = HandChain::finger_that_moves(capsule);
    clearance.by_shift << clearance.normal.array(), 0.0;
    if (finger_index < 0) continue;
    const Vector3 point = placed->capsules[clearance.key.capsule].axis_point(clearance.s);
    clearance.by_finger = chain.finger(finger_index).gradient(bone_of(capsule), point, clearance.normal);
  }
}

double HandRenderer::Impl::displacement(const HandOffset& from, const HandOffset& to) {
  double farthest = 0.0;
  for (int f = 0; f < kFingers; ++f) {
    const auto i = static_cast<std::size_t>(f);
    const FingerOffset change = to.fingers[i] - from.fingers[i];
    if (!(change == 0.0).all()) farthest = std::max(farthest, chain.finger(f).displacement(change));
  }
  return farthest + (to.shift - from.shift).norm();
}

/// Fallback for contradictory clearances: shifts the whole hand to the nearest side of the deepest body. For
/// a side with the normal n and height h, the deepest capsule is at min n.a - r - h < 0, and the hand is
/// outside after a shift by that along n.
void HandRenderer::Impl::shift_out() {
  constexpr int kMaxBodies = 4;
  for (int attempt = 0; attempt < kMaxBodies; ++attempt) {
    const auto deepest =
        std::min_element(clearances.begin(), clearances.end(),
                         [](const Clearance& a, const Clearance& b) { return a.gap < b.gap; });
    Vector3 shift = Vector3::Zero();
    double min_gap = std::numeric_limits<double>::max();
    for (const Clearance& side : clearances) {
      if (side.key.body != deepest->key.body || side.key.shape != deepest->key.shape) continue;
      double reach = std::numeric_limits<double>::max();
      for (const Capsule& capsule : placed->capsules) {
        if (capsule.radius <= 0.0) continue;
        const double lowest = std::min(side.normal.dot(capsule.start), side.normal.dot(capsule.end));
        reach = std::min(reach, lowest - capsule.radius - side.height);
      }
      if (-reach >= min_gap) continue;
      min_gap = -reach;
      shift = -reach * side.normal;
    }
    offset.shift += shift;
    chain.place(offset, *placed);
    clearances.clear();
    if (finder.find(*placed, *setting, kLookAhead, clearances) > -kMaxDepth) return;
  }
  lead_out();
}

/// Shifts the hand along the palm's axis on which it is outside after the shortest distance. Sphere tracing
/// (Hart 1996): with a gap of -d the hand is still inside after less than d, so that a step of d skips no
/// solution; kMinTraceStep ensures progress near the surface.
void HandRenderer::Impl::lead_out() {
  constexpr double kMaxTrace = 0.5, kMinTraceStep = 0.0005;  // [m]
  finder.begin(*setting, offset.shift.norm() + kMaxTrace);
  const Matrix3 palm = setting->tracked.palm.orientation.toRotationMatrix();
  double nearest = kMaxTrace;
  const Vector3 from = offset.shift;
  Vector3 out = from;
  for (int direction = 0; direction < 6; ++direction) {
    const Vector3 axis = (direction < 3 ? 1.0 : -1.0) * palm.col(direction % 3);
    for (double gone = 0.0; gone < nearest;) {
      offset.shift = from + gone * axis;
      chain.place(offset, *placed);
      clearances.clear();
      const double min_gap = finder.find(*placed, *setting, kLookAhead, clearances);
      if (min_gap > -kMaxDepth) {
        nearest = gone;
        out = offset.shift;
      }
      gone += std::max(-min_gap, kMinTraceStep);
    }
  }
  offset.shift = out;
  chain.place(offset, *placed);
}

}  // namespace mrhi
