#include "mr_hand_interaction/tracking/hand_track.h"

#include <algorithm>
#include <cmath>

#include "../math/minimum_jerk.h"

namespace mrhi {

// With s(u) the share of the way at the share u of the duration T, the hand is at s (way + speed u T) beyond
// where it was held: its acceleration is at most speed/T max|u s'' + 2 s'| + way/T^2 max|s''|.
Nanoseconds rejoin_duration(double way, double away) {
  // What an object endures that is held half as firmly again as its weight needs.
  constexpr double kAcceleration = 5.0;               // [m/s^2]
  constexpr double kShortest = 0.05, kLongest = 0.4;  // [s]
  constexpr double kOfSpeed = 4.63, kOfWay = 5.78;    // the two maxima of minimum jerk
  // With s = 10 u^3 - 15 u^4 + 6 u^5: max |120 u^2 - 300 u^3 + 180 u^4| at u = 0.386, and max |s''| = 10 /
  // sqrt(3) at u = (3 - sqrt(3)) / 6. Then a T^2 = b T + kOfWay way, of which T is the positive root.
  const double b = kOfSpeed * way / away;
  const double duration = (b + std::sqrt(b * b + 4.0 * kAcceleration * kOfWay * way)) / (2.0 * kAcceleration);
  return static_cast<Nanoseconds>(1e9 * std::clamp(duration, kShortest, kLongest));
}

///     x = from + s(u) (tracked - from),   u = (t - begin) / duration,   s' = s'' = 0 at both ends
/// It begins at rest, as the held hand was, and ends with the tracked hand's velocity. The duration is fixed
/// at the start, for a hand that goes on as fast.
Hand catching_up(const Rejoin& rejoin, const Hand& tracked, Nanoseconds stamp) {
  const double u = std::min(1.0, to_seconds(stamp - rejoin.begin) / to_seconds(rejoin.duration));
  return blend(rejoin.from, tracked, minimum_jerk(u));
}

/// Squares are compared, and one root is taken: the same bits, as a root keeps the order.
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

/// Quaternions by the shorter arc at one rate (slerp: Shoemake 1985), points on lines. At 1 it is `to` to the
/// last bit: a hand that has caught up owes nothing to where it was. A capsule that only one of them has is
/// as in `to`.
Hand blend(const Hand& from, const Hand& to, double fraction) {
  if (fraction >= 1.0) return to;
  Hand hand = to;
  const auto mix = [fraction](const Vector3& a, const Vector3& b) -> Vector3 {
    return a + fraction * (b - a);
  };
  hand.palm.position = mix(from.palm.position, to.palm.position);
  hand.palm.orientation = from.palm.orientation.slerp(fraction, to.palm.orientation).normalized();
  hand.wrist = mix(from.wrist, to.wrist);
  for (std::size_t c = 0; c < kCapsules; ++c) {
    if (from.capsules[c].radius <= 0.0) continue;
    hand.capsules[c].start = mix(from.capsules[c].start, to.capsules[c].start);
    hand.capsules[c].end = mix(from.capsules[c].end, to.capsules[c].end);
  }
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

/// Past a stop from one frame to the next a path swings on by this distance at most [m].
constexpr double kMaxOvershoot = 1e-4;
/// Energy of white noise in the extrapolated part of the velocity over that in its last term: 21 to 70 / 16
/// variances of a sample, at even intervals.
constexpr double kNoiseRatio = 21.0 / (70.0 / 16.0);

/// The extrapolated part grows from frame to frame by this factor at most, and begins with this over the
/// frame's time: an acceleration that appears from nothing is a stop or a start, which does not go on [m].
constexpr double kGrowth = 4.0, kOnset = 4.0 * kMaxOvershoot;

/// And by this fraction of the extrapolated velocity's displacement: what goes on accelerating bends as much.
constexpr double kOfTheBend = 0.125;

double fastest_point(const HandVelocity& velocity) {
  double squared = 0.0;
  for (const Vector3& point : velocity.points) squared = std::max(squared, point.squaredNorm());
  return std::sqrt(squared);
}

bool same_points(const Hand& a, const Hand& b) {
  for (int c = 0; c < kCapsules; ++c)
    if (a.has(c) != b.has(c)) return false;
  return true;
}

Vector3 rotation_vector(const Quaternion& from, const Quaternion& to) {
  const Eigen::AngleAxisd turn(to * from.conjugate());
  return turn.angle() * turn.axis();
}

/// Calls change(item i of each) for every point of a hand, and for its turn.
template <class Change, class... Velocities>
void for_each_rate(const Change& change, Velocities&... velocities) {
  for (std::size_t point = 0; point < kHandPoints; ++point) change(velocities.points[point]...);
  change(velocities.turn...);
}

}  // namespace

// Newton's form of the interpolating polynomial, with T1 the newest interval and D_k the backward divided
// differences: p'(t) = D_1 + T1 D_2 + T1 (T1 + T2) D_3 + T1 (T1 + T2) (T1 + T2 + T3) D_4.
void extend_path(double elapsed, HandTrack& track) {
  HandPath& path = track.path;
  if (!same_points(track.previous, track.current)) path = HandPath();
  HandVelocity chord;  // mean velocity of the frame
  for (std::size_t point = 0; point < kHandPoints; ++point) {
    if (!has_point(track.current, point)) continue;
    chord.points[point] = (hand_point(track.current, point) - hand_point(track.previous, point)) / elapsed;
  }
  chord.turn = rotation_vector(track.previous.palm.orientation, track.current.palm.orientation) / elapsed;

  const double two = elapsed + path.intervals[0], three = two + path.intervals[1],
               four = three + path.intervals[2];
  HandVelocity& extrapolated = path.end_bend;
  double noise = 0.0, all = 0.0;
  for_each_rate(
      [&](const Vector3& first, Vector3& d1, Vector3& d2, Vector3& d3, Vector3& sum) {
        const Vector3 second = (first - d1) / two, third = (second - d2) / three;
        const Vector3 last = elapsed * two * three * (third - d3) / four;
        sum = elapsed * (second + two * third) + last;
        noise += last.squaredNorm();
        all += sum.squaredNorm();
        d1 = first, d2 = second, d3 = third;
      },
      chord, path.differences[0], path.differences[1], path.differences[2], extrapolated);
  path.intervals = {elapsed, path.intervals[0], path.intervals[1]};
  const bool known = path.order > 2;
  path.order = std::min(path.order + 1, 3);
  double kept = known && all > 0.0 ? std::max(0.0, 1.0 - kNoiseRatio * noise / all) : 0.0;
  const double limit = kGrowth * path.extrapolated + kOnset / elapsed;
  const double fastest = fastest_point(extrapolated);
  if (kept * fastest > limit) kept = limit / fastest;
  path.extrapolated = kept * fastest;

  // The velocity that the path has arrived with, less that of a smooth path: of it the first is kept as far
  // as the detour, 4/27 of T times it, stays small.
  for_each_rate(
      [&](const Vector3& mean, const Vector3& arrived, Vector3& more, Vector3& off) {
        more *= kept;
        off = path.order > 1 ? Vector3(arrived - mean + more) : Vector3(Vector3::Zero());
      },
      chord, path.velocity, extrapolated, path.start_bend);
  const double detour = 4.0 / 27.0 * elapsed * fastest_point(path.start_bend);
  const double allowed = kMaxOvershoot + kOfTheBend * elapsed * path.extrapolated;
  const double part = detour > allowed ? allowed / detour : 1.0;
  for_each_rate(
      [&](const Vector3& mean, Vector3& velocity, Vector3& start, Vector3& end) {
        velocity = mean + end;
        start = elapsed * (part * start - end);
        end *= elapsed;
      },
      chord, path.velocity, path.start_bend, path.end_bend);
}

}  // namespace mrhi
