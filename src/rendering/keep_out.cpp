#include <algorithm>
#include <limits>

#include "renderer.h"

namespace mrhi {
namespace {

/// What stays as it was shown where a hand goes too far: its offset; or the palm, which lags, with axes that
/// the joints' limits ask for; or its axes as well, about which fingers bend.
enum class Stays { offset, palm, axes };

constexpr int kMaxPasses = 12;
constexpr int kMostInVain = 2;       // passes on end that bring a hand no better into step
constexpr double kBetter = 0.9;      // a gap of this share of the best one is better
constexpr double kSwing = 0.0005;    // that a fingertip may turn by in a frame, and this share of what hand
constexpr double kSwingShare = 0.8;  // and bodies move: the rest is the whole hand's to give way [m]
constexpr double kAnyway = 1.0;      // no bound [m]
constexpr double kPace = 0.0018;     // that a joint may go beyond what the farthest tracked one does [m]
/// A pass that moves no joint farther is not looked at again: what is met anew is no deeper than that [m].
constexpr double kSmallStep = 1e-4;

constexpr std::uint16_t kNoBody = std::numeric_limits<std::uint16_t>::max();

/// Of one end of a capsule: 0 its start, 1 its end.
ContactKey key_of(std::size_t capsule, int end) {
  ContactKey key{};
  key.point = key.shape = static_cast<std::uint8_t>(end);
  key.capsule = static_cast<std::uint8_t>(capsule);
  key.body = kNoBody;
  return key;
}

}  // namespace

/// How far the joints of a shown hand may go in a frame.
class Pace {
 public:
  /// From where they were in `before`, `way` at the most [m]. Keeps a reference.
  Pace(const Hand& before, double way) : before_(before), way_(way) {}

  /// By how much the joint goes too far that goes the farthest [m]; < 0: none does.
  double beyond(const Hand& placed) const { return farthest_joint(before_, placed) - way_; }

  /// Each joint that goes too far, and each in `clearances` already, must keep off the plane that touches the
  /// ball it may be in. Returns the least gap [m], at most 0.
  ///
  /// The ball |x - x0| <= way is not linear: its tangent plane at the joint's side, with n = (x0 - x) / |x0 -
  /// x|, has n.x >= n.x0 - way, and the gap there is way - |x - x0|. The height has the capsule's radius
  /// taken off, so that a clearance's gap, which takes it off too, is that of the axis. Where a joint moves
  /// aside, the plane turns from pass to pass.
  double keep(const Hand& placed, std::vector<Clearance>& clearances) const {
    double least = 0.0;
    for (std::size_t c = 0; c < kCapsules; ++c) {
      const Capsule &from = before_.capsules[c], &to = placed.capsules[c];
      if (from.radius <= 0.0 || to.radius <= 0.0) continue;
      for (int end = 0; end < 2; ++end) {
        const Vector3 &start = end == 0 ? from.start : from.end, &now = end == 0 ? to.start : to.end;
        const double gap = way_ - (now - start).norm();
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
        known->height = known->normal.dot(start) - way_ - to.radius;
        known->gap = gap;
        least = std::min(least, gap);
      }
    }
    return least;
  }

  /// Takes the joints out of `clearances` again.
  static void forget(std::vector<Clearance>& clearances) {
    const auto ours = [](const Clearance& clearance) { return clearance.key.body == kNoBody; };
    clearances.erase(std::remove_if(clearances.begin(), clearances.end(), ours), clearances.end());
  }

 private:
  const Hand& before_;
  double way_;
};

/// Deeper than kShallow the side on which the hand was shown before has a say, which the first look at the
/// frame did not know: gaps are found anew.
void HandRenderer::Impl::push_out(double least) {
  const HandOffset reference = offset;
  if (least < -ClearanceFinder::kShallow) begin_anew(reference);
  keep_out(reference, kSwingShare * setting->moved + kSwing);
}

/// A hand that is held away from the axis about which the tracked one turns swings farther: where the bodies
/// leave room, it gives way.
///
/// In turn: from what is solved, at the pace that bodies push at; at the hand's own; then from the offset
/// that leaves the hand as it was shown, with the palm's lag in more and more. The best so far is kept, and
/// only what is no deeper than allowed counts.
void HandRenderer::Impl::keep_pace(const HandOffset& reference) {
  if (farthest_joint(before, *placed) <= tracked_way + kPace) return;
  const Pace pace(before, tracked_way + kPace);
  const double pushed_by = pushed_way();
  const Pace hurried(before, tracked_way + pushed_by + kPace);
  double least_beyond = pace.beyond(*placed);
  HandOffset best = offset;
  const auto in_step = [&](const Pace& at, const HandOffset& nearest_to, double swing, double tolerated) {
    at.keep(*placed, clearances);
    settle(nearest_to, swing, &at, tolerated);
    Pace::forget(clearances);
    const double beyond = pace.beyond(*placed);
    if (beyond >= least_beyond || finder.find(*placed, *setting, kAhead, clearances) < -tolerated) return;
    least_beyond = beyond;
    best = offset;
  };
  const double swing = kSwingShare * setting->moved + kSwing;
  if (least_beyond > pushed_by) in_step(hurried, reference, swing, kTolerated);
  if (least_beyond > kTolerated && pushed_by > 0.0) in_step(pace, reference, swing, kTolerated);
  PalmLag lag = reference.lag;
  for (const Stays stays : {Stays::offset, Stays::palm, Stays::axes}) {
    if (least_beyond <= kTolerated + pushed_by) break;
    if (stays == Stays::palm) lag = lag_staying();
    if (stays == Stays::axes) lag.frame = frame_staying(lag.whole);
    chain.begin(setting->tracked, lag);
    const HandOffset stay = staying(lag);
    begin_anew(stay);
    in_step(hurried, stay, kAnyway, stays == Stays::offset ? kTolerated : kDeepest);
  }
  leap = std::max(0.0, least_beyond - pushed_by);
  offset = best;
  chain.begin(setting->tracked, offset.lag);
  chain.place(offset, *placed);
}

/// The longest way by which a body that the hand leans on has come towards it since the frame before [m]. n.v
/// of the body's point at the capsule's surface, n out of the body: > 0 comes at the hand.
double HandRenderer::Impl::pushed_way() const {
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

/// The hand does not move from where it was shown. Joints as they pointed, within the limits that they have
/// in the palm of now; the shift takes the palm's own way off.
HandOffset HandRenderer::Impl::staying(const PalmLag& lag) {
  HandOffset stay;
  stay.lag = lag;
  stay.shift = before.palm.position - setting->tracked.palm.position;
  for (int f = 0; f < kFingers; ++f)
    stay.fingers[static_cast<std::size_t>(f)] = chain.finger(f).like(before, finger_before(f));
  return stay;
}

/// Given up in this order: the bound on a fingertip's turn; nearness to the offset of before, for where the
/// hand was shown; bending round what is in the way, for a shift of the whole.
void HandRenderer::Impl::keep_out(const HandOffset& reference, double swing) {
  if (settle(reference, swing) > -kTolerated) return;
  begin_anew(reference);
  if (settle(reference, kAnyway) > -kTolerated) return;
  if (setting->shown_before != nullptr) {
    const HandOffset stay = staying(offset.lag);
    begin_anew(stay);
    if (settle(stay, kAnyway) > -kTolerated) return;
  }
  begin_anew(reference);
  shift_out();
}

/// Sequential quadratic programming: gaps are found where the hand is and linearised. Returns the least gap
/// [m].
///
/// Rows J of the gaps are n for the shift and FingerChain::gradient for joints. A plane is the surface's
/// tangent there: on what is curved, or once joints turn, it is right for small steps only, and gaps are
/// found anew at the place that was solved for.
double HandRenderer::Impl::settle(const HandOffset& reference, double swing, const Pace* pace,
                                  double tolerated) {
  const int most_in_vain = tolerated > kTolerated ? kMaxPasses : kMostInVain;
  double least = 0.0, best = std::numeric_limits<double>::lowest();
  int in_vain = 0;
  for (int pass = 0; pass < kMaxPasses && in_vain < most_in_vain; ++pass) {
    linearise();
    const HandOffset from = offset;
    const double expected = solve_offset(reference, {*last, swing}, chain, clearances, offset);
    chain.place(offset, *placed);
    if (expected > -kClear && way(from, offset) < kSmallStep) return expected;
    least = finder.find(*placed, *setting, kAhead, clearances);
    if (pace != nullptr) least = std::min(least, pace->keep(*placed, clearances));
    if (least > -kClear) return least;
    in_vain = pace != nullptr && least < kBetter * best ? in_vain + 1 : 0;
    best = std::max(best, least);
  }
  return least;
}

void HandRenderer::Impl::begin_anew(const HandOffset& reference) {
  offset = reference;
  chain.place(offset, *placed);
  clearances.clear();
  finder.find(*placed, *setting, kAhead, clearances);
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

double HandRenderer::Impl::way(const HandOffset& from, const HandOffset& to) {
  double farthest = 0.0;
  for (int f = 0; f < kFingers; ++f) {
    const auto i = static_cast<std::size_t>(f);
    const FingerOffset change = to.fingers[i] - from.fingers[i];
    if (!(change == 0.0).all()) farthest = std::max(farthest, chain.finger(f).way(change));
  }
  return farthest + (to.shift - from.shift).norm();
}

/// The clearances contradict each other: the hand as it is goes as a whole to that side of the deepest body
/// which is the nearest. For a side with the normal n and height h the hand's deepest capsule is at
/// min n.a - r - h < 0, and the hand is out by as much along n.
void HandRenderer::Impl::shift_out() {
  constexpr int kMaxBodies = 4;
  for (int attempt = 0; attempt < kMaxBodies; ++attempt) {
    const auto deepest =
        std::min_element(clearances.begin(), clearances.end(),
                         [](const Clearance& a, const Clearance& b) { return a.gap < b.gap; });
    Vector3 way = Vector3::Zero();
    double least = std::numeric_limits<double>::max();
    for (const Clearance& side : clearances) {
      if (side.key.body != deepest->key.body || side.key.shape != deepest->key.shape) continue;
      double reach = std::numeric_limits<double>::max();
      for (const Capsule& capsule : placed->capsules) {
        if (capsule.radius <= 0.0) continue;
        const double lowest = std::min(side.normal.dot(capsule.start), side.normal.dot(capsule.end));
        reach = std::min(reach, lowest - capsule.radius - side.height);
      }
      if (-reach >= least) continue;
      least = -reach;
      way = -reach * side.normal;
    }
    offset.shift += way;
    chain.place(offset, *placed);
    clearances.clear();
    if (finder.find(*placed, *setting, kAhead, clearances) > -kTolerated) return;
  }
  lead_out();
}

/// Leads the hand as it is out along that of its palm's axes on which it is out the soonest. No step is
/// longer than what is left of the way out. Sphere tracing (Hart 1996): with a gap of -d the hand cannot be
/// out before it has gone d, so that a step of d passes over no way out; near the surface kShortestStep gets
/// it on.
void HandRenderer::Impl::lead_out() {
  constexpr double kFarthestOut = 0.5;      // [m]
  constexpr double kShortestStep = 0.0005;  // [m]
  finder.begin(*setting, offset.shift.norm() + kFarthestOut);
  const Matrix3 palm = setting->tracked.palm.orientation.toRotationMatrix();
  double nearest = kFarthestOut;
  const Vector3 from = offset.shift;
  Vector3 out = from;
  for (int direction = 0; direction < 6; ++direction) {
    const Vector3 way = (direction < 3 ? 1.0 : -1.0) * palm.col(direction % 3);
    for (double gone = 0.0; gone < nearest;) {
      offset.shift = from + gone * way;
      chain.place(offset, *placed);
      clearances.clear();
      const double least = finder.find(*placed, *setting, kAhead, clearances);
      if (least > -kTolerated) {
        nearest = gone;
        out = offset.shift;
      }
      gone += std::max(-least, kShortestStep);
    }
  }
  offset.shift = out;
  chain.place(offset, *placed);
}

}  // namespace mrhi
