#include "hand_filter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "../math/minimum_jerk.h"
#include "../math/rotation.h"

namespace mrhi {

// With the minimum-jerk fraction s(u) at the fraction u of the duration T, the hand is at s (distance + speed
// u T) from where it was held: its acceleration is at most speed/T max|u s'' + 2 s'| + distance/T^2 max|s''|.
Nanoseconds rejoin_duration(double distance, double speed) {
  // Largest acceleration [m/s^2]: an object held with 1.5 times the force that its weight needs withstands
  // it.
  constexpr double kMaxAcceleration = 5.0;
  constexpr double kMinDuration = 0.05, kMaxDuration = 0.4;  // [s]
  // The maxima of |u s'' + 2 s'| and |s''|.
  constexpr double kSpeedFactor = 4.63, kDistanceFactor = 5.78;
  // With s = 10 u^3 - 15 u^4 + 6 u^5: max |120 u^2 - 300 u^3 + 180 u^4| at u = 0.386, and max |s''| = 10 /
  // sqrt(3) at u = (3 - sqrt(3)) / 6. Then a T^2 = b T + kDistanceFactor distance, of which T is the positive
  // root.
  const double b = kSpeedFactor * speed;
  const double duration =
      (b + std::sqrt(b * b + 4.0 * kMaxAcceleration * kDistanceFactor * distance)) / (2.0 * kMaxAcceleration);
  return static_cast<Nanoseconds>(1e9 * std::clamp(duration, kMinDuration, kMaxDuration));
}

///     x = from + s(u) (tracked - from),   u = (t - begin) / duration,   s' = s'' = 0 at both ends
/// The motion begins at rest, as the held hand was, and ends with the tracked hand's velocity. The duration
/// is fixed at the start, for a hand that keeps its speed.
Hand catching_up(const Rejoin& rejoin, const Hand& tracked, Nanoseconds stamp) {
  const double u = std::min(1.0, to_seconds(stamp - rejoin.begin) / to_seconds(rejoin.duration));
  return blend(rejoin.from, tracked, minimum_jerk(u));
}

/// Compares squares and takes one root, which gives the same bits because a root is monotonic.
double farthest_joint(const Hand& from, const Hand& to) {
  double distance_squared = 0.0;
  for (std::size_t c = 0; c < kCapsules; ++c) {
    const Capsule &a = from.capsules[c], &b = to.capsules[c];
    if (a.radius <= 0.0 || b.radius <= 0.0) continue;
    distance_squared =
        std::max({distance_squared, (a.start - b.start).squaredNorm(), (a.end - b.end).squaredNorm()});
  }
  return std::sqrt(distance_squared);
}

/// Interpolates quaternions along the shorter arc (slerp: Shoemake 1985) and points along lines. At fraction
/// 1 the result is `to`, bit for bit. A capsule that only one of them has is as in `to`.
Hand blend(const Hand& from, const Hand& to, double fraction) {
  if (fraction >= 1.0) return to;
  Hand hand = to;
  for (std::size_t p = 0; p < kHandPoints; ++p) {
    if (!has_point(from, p)) continue;
    const Vector3 &a = hand_point(from, p), &b = hand_point(to, p);
    hand_point(hand, p) = a + fraction * (b - a);
  }
  hand.palm.orientation = from.palm.orientation.slerp(fraction, to.palm.orientation).normalized();
  return hand;
}

PathWeights PathWeights::between(double from, double to, double seconds) {
  if (seconds <= 0.0) return {0.0, 0.0, 0.0};
  const double rate = 1.0 / seconds, f = from;
  if (to <= from) return {rate, rate * (1.0 - f) * (1.0 - 3.0 * f), -rate * f * (2.0 - 3.0 * f)};
  const PathWeights a = at(from), b = at(to);
  const double over = rate / (to - from);
  return {rate, over * (b.start_bend - a.start_bend), over * (b.end_bend - a.end_bend)};
}

namespace {

/// Largest distance by which a path overshoots a stop from one frame to the next [m].
constexpr double kMaxOvershoot = 1e-4;
/// Energy of white noise in the extrapolated part of the velocity over that in its last term: 21 to 70 / 16
/// variances of a sample, at even intervals.
constexpr double kNoiseRatio = 21.0 / (70.0 / 16.0);
/// Weight of the newest frame in the running means of both energies.
constexpr double kNewWeight = 1.0 / 16.0;
/// Largest growth of the extrapolated part from frame to frame, and its largest first displacement in a frame
/// [m]: a sudden acceleration is a stop or a start, which does not continue.
constexpr double kMaxGrowth = 4.0, kMaxOnset = 4.0 * kMaxOvershoot;
/// Additional overshoot, as a fraction of the displacement by the extrapolated velocity.
constexpr double kBendFraction = 0.125;

/// All numbers of a HandVelocity side by side: its points and, last, its turn.
constexpr int kNumbers = 3 * (static_cast<int>(kHandPoints) + 1);
static_assert(sizeof(HandVelocity) == kNumbers * sizeof(double), "points and turn lie side by side");
using Numbers = Eigen::Array<double, kNumbers, 1>;

Eigen::Map<Numbers> numbers(HandVelocity& velocity) {
  return Eigen::Map<Numbers>(velocity.points[0].data());
}

double longest_point(const HandVelocity& of) {
  double squared = 0.0;
  for (const Vector3& point : of.points) squared = std::max(squared, point.squaredNorm());
  return std::sqrt(squared);
}

double energy_of_points(const HandVelocity& velocity) {
  using Points = Eigen::Map<const Eigen::Matrix<double, 3 * static_cast<int>(kHandPoints), 1>>;
  return Points(velocity.points[0].data()).squaredNorm();
}

/// Mean velocities of a frame; zero of points that the hand lacks.
HandVelocity mean_velocity(const Hand& from, const Hand& to, double elapsed) {
  const double rate = 1.0 / elapsed;
  HandVelocity mean;
  for (std::size_t p = 0; p < kHandPoints; ++p)
    if (has_point(to, p)) mean.points[p] = rate * (hand_point(to, p) - hand_point(from, p));
  mean.turn = rate * rotation_vector(to.palm.orientation * from.palm.orientation.conjugate());
  return mean;
}

bool same_points(const Hand& a, const Hand& b) {
  for (int c = 0; c < kCapsules; ++c)
    if (a.has(c) != b.has(c)) return false;
  return true;
}

}  // namespace

// Newton's form of the interpolating polynomial, with T1 the newest interval and D_k the backward divided
// differences: p'(t) = D_1 + T1 D_2 + T1 (T1 + T2) D_3 + T1 (T1 + T2) (T1 + T2 + T3) D_4.
void extend_path(double elapsed, HandTrack& track) {
  HandPath& path = track.path;
  if (!same_points(track.previous, track.current)) path = HandPath();
  HandVelocity chord = mean_velocity(track.previous, track.current, elapsed);

  // The polynomial's velocity relative to the chord's, and its last term.
  const double two = elapsed + path.intervals[0], three = two + path.intervals[1],
               four = three + path.intervals[2];
  const double over_two = 1.0 / two, over_three = 1.0 / three, of_last = elapsed * two * three / four;
  HandVelocity &beyond = path.end_bend, &last = path.start_bend;
  auto mean = numbers(chord), extrapolated = numbers(beyond), fourth = numbers(last),
       d1 = numbers(path.differences[0]), d2 = numbers(path.differences[1]),
       d3 = numbers(path.differences[2]);
  const Numbers second = over_two * (mean - d1), third = over_three * (second - d2);
  fourth = of_last * (third - d3);
  extrapolated = elapsed * (second + two * third) + fourth;
  d1 = mean, d2 = second, d3 = third;
  path.intervals = {elapsed, path.intervals[0], path.intervals[1]};
  if (path.order > 2) {
    path.noise += kNewWeight * (energy_of_points(last) - path.noise);
    path.energy += kNewWeight * (energy_of_points(beyond) - path.energy);
  }
  double kept = path.energy > 0.0 ? std::max(0.0, 1.0 - kNoiseRatio * path.noise / path.energy) : 0.0;
  const double limit = kMaxGrowth * path.extrapolated + kMaxOnset / elapsed, fastest = longest_point(beyond);
  if (kept * fastest > limit) kept = limit / fastest;
  path.extrapolated = kept * fastest;

  // The path arrived with a velocity that differs from the start of a smooth one. The fraction of the
  // difference that is kept limits the detour, 4/27 of T times it.
  auto start = numbers(path.start_bend), arrived = numbers(path.velocity);
  const double known = path.order > 0 ? 1.0 : 0.0;
  extrapolated *= kept;
  start = known * (arrived - mean + extrapolated);
  arrived = mean + extrapolated;
  const double detour = 4.0 / 27.0 * elapsed * longest_point(path.start_bend);
  const double allowed = kMaxOvershoot + kBendFraction * elapsed * path.extrapolated;
  const double part = detour > allowed ? allowed / detour : 1.0;
  start = elapsed * (part * start - extrapolated);
  extrapolated *= elapsed;
  const double renewed = 1.0 - std::exp(-elapsed / kMeanVelocity);
  auto mean_velocity = numbers(track.mean_velocity);
  mean_velocity += renewed * (mean - mean_velocity);
  path.longest_bend = 27.0 / 4.0 * std::min(detour, allowed) + elapsed * path.extrapolated;
  path.order = std::min(path.order + 1, 3);
}

namespace {

/// Largest distance at which a hand with a new id continues a held one [m].
constexpr double kSameHandDistance = 0.3;

/// Time in which one filter takes over from another [s].
constexpr double kFilterTransition = 0.2;

using Assignment = std::array<int, kMaxHands>;  // slot -> index in the frame, -1: none

/// True for a free slot with a noise estimate of hands of this side.
bool was_last_here(const HandTrack& track, const Hand& hand) {
  return !track.active && track.filter.noise.size > 0 && track.current.side == hand.side;
}

/// Criteria by which a hand continues a track, in order of certainty.
constexpr bool (*kCriteria[])(const HandTrack&, const Hand&) = {
    [](const HandTrack& track, const Hand& hand) {
      return track.active && track.current.id == hand.id && track.current.side == hand.side;
    },
    // A tracker that confuses left and right.
    [](const HandTrack& track, const Hand& hand) { return track.active && track.current.id == hand.id; },
    // A new id near a held hand.
    [](const HandTrack& track, const Hand& hand) {
      return track.active && track.current.side == hand.side &&
             (track.current.palm.position - hand.palm.position).norm() < kSameHandDistance;
    },
    // Free slots, those with the noise of this side first.
    was_last_here,
    [](const HandTrack& track, const Hand&) { return !track.active && track.filter.noise.size == 0; },
    [](const HandTrack& track, const Hand&) { return !track.active; }};

/// Applies each criterion to all slots before the next. Slots and hands are tried in order, so that equal
/// frames give equal tracks.
Assignment assign_hands(const std::vector<Hand>& seen, std::uint32_t people,
                        const std::vector<HandTrack>& hands) {
  const auto of_one_person = [people](const HandTrack& track, const Hand& hand) {
    return !track.active || track.current.id % people == hand.id % people;
  };
  Assignment assignment;
  assignment.fill(-1);
  for (const auto fits : kCriteria)
    for (std::size_t slot = 0; slot < hands.size(); ++slot)
      for (int i = 0; i < static_cast<int>(seen.size()) && assignment[slot] < 0; ++i) {
        const bool assigned = std::find(assignment.begin(), assignment.end(), i) != assignment.end();
        if (!assigned && of_one_person(hands[slot], seen[i]) && fits(hands[slot], seen[i]))
          assignment[slot] = i;
      }
  return assignment;
}

/// Previous and current pose are the same, so that the hand has no velocity and causes no impact.
void appear(const Hand& hand, Nanoseconds stamp, HandTrack& track) {
  track.active = true;
  track.held = false;
  track.appeared = true;
  track.emerged = track.converges = false;
  track.filter.restart(hand);
  track.previous = track.current = hand;
  track.path = HandPath();
  track.mean_velocity = HandVelocity();
  track.last_seen = stamp;
  track.rejoin.duration = 0;
  track.filter_change.reset();
}

/// Both filters run on the same samples, and the hand is (1 - s) old + s new, with s of minimum jerk, whose
/// first two derivatives are 0 at both ends.
Hand filtered_through_change(const Hand& hand, Nanoseconds stamp, const Configuration& configuration,
                             HandTrack& track) {
  const double elapsed = to_seconds(stamp - track.last_seen);
  const Hand now = filtered(hand, elapsed, filter_of(configuration), track.filter);
  if (!track.filter_change) return now;
  FilterChange& change = *track.filter_change;
  const Hand before = filtered(hand, elapsed, change.from, change.memory);
  const double u = to_seconds(stamp - change.begin) / kFilterTransition;
  if (u >= 1.0) {
    track.filter_change.reset();
    return now;
  }
  return blend(before, now, minimum_jerk(u));
}

/// The tracked hand with the rotation of its fingers' bones in the palm limited to `speed` [rad/s] since
/// `before`, over `elapsed` seconds. Bones keep their lengths, and joints stay connected as tracked. The
/// limit applies from the first tracked bone after the metacarpal.
Hand with_limited_joint_speed(const Hand& before, const Hand& tracked, double speed, double elapsed) {
  Hand hand = tracked;
  const Quaternion palm = tracked.palm.orientation * before.palm.orientation.conjugate();
  for (int finger = 0; finger < kFingers; ++finger) {
    Vector3 moved = Vector3::Zero();  // displacement of the next joint from its tracked position
    for (int bone = 1; bone < kBonesPerFinger; ++bone) {
      const int c = capsule_index(finger, bone);
      Capsule& capsule = hand.capsules[c];
      const Capsule& last = before.capsules[c];
      if (capsule.radius <= 0.0 || last.radius <= 0.0) continue;
      const Vector3 is = capsule.end - capsule.start, was = palm * (last.end - last.start);
      const Quaternion turn = rotation_between(was, is);
      const double angle = 2.0 * std::acos(std::min(1.0, std::abs(turn.w())));
      capsule.start += moved;
      if (angle > speed * elapsed && was.norm() > 0.0) {
        const Quaternion part = Quaternion::Identity().slerp(speed * elapsed / angle, turn);
        moved += is.norm() * (part * was.normalized()) - is;
      }
      capsule.end += moved;
    }
  }
  return hand;
}

/// Time in which a missing hand coasts to rest [s].
constexpr double kCoastTime = 0.1;
/// Time constant at which a hand that returned while it coasted converges to the filtered hand [s], and the
/// distance at which it has converged [m].
constexpr double kConvergenceTime = 0.03, kConvergedDistance = 1e-5;

/// Returns the track's hand after `seconds` at its mean velocity.
Hand coast(const HandTrack& track, double seconds) {
  Hand hand = track.current;
  for (std::size_t p = 0; p < kHandPoints; ++p)
    if (has_point(hand, p)) hand_point(hand, p) += seconds * track.mean_velocity.points[p];
  hand.palm.orientation =
      (rotation_by(seconds * track.mean_velocity.turn) * hand.palm.orientation).normalized();
  return hand;
}

/// Returns the filtered hand plus the fraction `kept` of the offset of `shown` from `reference`.
Hand add_offset(const Hand& shown, const Hand& reference, double kept, const Hand& filtered) {
  Hand hand = filtered;
  for (std::size_t p = 0; p < kHandPoints; ++p)
    if (has_point(filtered, p) && has_point(shown, p) && has_point(reference, p))
      hand_point(hand, p) += kept * (hand_point(shown, p) - hand_point(reference, p));
  const Quaternion offset = shown.palm.orientation * reference.palm.orientation.conjugate();
  hand.palm.orientation =
      (Quaternion::Identity().slerp(kept, offset) * filtered.palm.orientation).normalized();
  return hand;
}

/// Jumps are detected in raw samples: filtered poses lag, and the lag would look like a jump. A hand that
/// returns while it coasts is filtered as if its tracker had sent no frames meanwhile. One that was lost for
/// longer restarts its filter, because its old samples say nothing about the present, and catches up from the
/// pose that was shown.
void follow(const Hand& hand, Nanoseconds stamp, double elapsed, const Configuration& configuration,
            HandTrack& track) {
  const double away = to_seconds(stamp - track.last_seen);
  const double speed = farthest_joint(track.filter.history.samples[0], hand) / away;
  if (speed > configuration.tracking.max_speed) {
    appear(hand, stamp, track);
    return;
  }
  const bool was_coasting = track.held && away <= kCoastTime && track.rejoin.duration == 0;
  if (track.held && !was_coasting) {
    track.filter.clear();
    track.filter_change.reset();
    track.converges = false;
    track.rejoin = {track.current, stamp, rejoin_duration(farthest_joint(track.current, hand), speed)};
  }
  track.emerged = track.appeared;
  track.appeared = track.held = false;
  Hand shown, reference;  // at the same time
  if (was_coasting) {
    shown = coast(track, elapsed);
  } else if (track.converges) {
    shown = track.current, reference = track.filter.filtered;
  }
  track.previous = track.current;
  track.current = filtered_through_change(hand, stamp, configuration, track);
  track.last_seen = stamp;
  if (was_coasting || track.converges) {
    const Hand now = track.current;
    track.current =
        add_offset(shown, was_coasting ? now : reference, std::exp(-elapsed / kConvergenceTime), now);
    track.converges = farthest_joint(track.current, now) > kConvergedDistance;
    if (!track.converges) track.current = now;
  }
  if (track.rejoin.duration > 0) {
    track.current = catching_up(track.rejoin, track.current, stamp);
    if (stamp - track.rejoin.begin >= track.rejoin.duration) track.rejoin.duration = 0;
  }
  if (std::isfinite(configuration.hand_joint_speed))
    track.current =
        with_limited_joint_speed(track.previous, track.current, configuration.hand_joint_speed, elapsed);
  extend_path(elapsed, track);
}

/// Lets a missing hand coast to rest, so that it does not lose what it carries. At rest, its last two poses
/// are the same.
void hold(Nanoseconds stamp, double elapsed, HandTrack& track) {
  track.held = true;
  track.emerged = track.appeared;
  track.appeared = false;
  track.previous = track.current;
  const double away = to_seconds(stamp - track.last_seen);
  const double spent = away / kCoastTime;
  if (spent < 1.0 && track.rejoin.duration == 0) {
    track.current = coast(track, elapsed * (1.0 - spent * spent));
    extend_path(elapsed, track);
  } else {
    track.path = HandPath();
    track.mean_velocity = HandVelocity();
  }
}

}  // namespace

void track_hands(const HandFrame& frame, double elapsed, std::uint32_t people,
                 const Configuration& configuration, std::vector<HandTrack>& hands,
                 std::vector<Event>& events) {
  const Assignment assignment = assign_hands(frame.hands, people, hands);
  for (std::size_t slot = 0; slot < hands.size(); ++slot) {
    HandTrack& track = hands[slot];
    if (assignment[slot] < 0) {
      if (track.active) hold(frame.stamp, elapsed, track);
      continue;
    }
    Hand hand = frame.hands[assignment[slot]];
    for (Capsule& capsule : hand.capsules) capsule.radius *= configuration.hand_radius_scale;
    if (track.active) {
      follow(hand, frame.stamp, elapsed, configuration, track);
    } else {
      if (!was_last_here(track, hand)) track.filter.noise = SeenNoise();
      appear(hand, frame.stamp, track);
      events.push_back({frame.stamp, EventKind::hand_found, -1, hand.id});
    }
  }
}

/// The new filter starts at rest from the last pose, with an unknown error. The old filter continues beside
/// it with its memory.
void change_filter(const FilterConfiguration& from, Nanoseconds now, std::vector<HandTrack>& hands) {
  for (HandTrack& track : hands) {
    if (!track.active || track.filter.empty()) continue;
    track.filter_change = FilterChange{from, track.filter, now};
    track.filter.velocity = HandVelocity();
    track.filter.variance = MotionVariance();
  }
}

/// The noise estimate stays in the slot, for the next hand of its side.
void lose_unseen_hands(Nanoseconds now, double hold_time, std::vector<HandTrack>& hands,
                       std::vector<Event>& events) {
  for (HandTrack& track : hands) {
    if (!track.active || to_seconds(now - track.last_seen) <= hold_time) continue;
    track.active = false;
    track.filter.clear();
    events.push_back({now, EventKind::hand_lost, -1, track.current.id});
  }
}

}  // namespace mrhi
