#include "closing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace mrhi::real_grasps {
namespace {

constexpr double kTip = 0.0088;           // radius of a fingertip [m]
constexpr double kPalm = 0.013;           // radius of the palm [m]
constexpr double kClear = 0.002;          // required gap between hand and body at the start [m]
constexpr std::size_t kEarliest = 90;     // maximum frames from that start to the closing
constexpr double kGap = 0.06;             // maximum time between a track's frames [s]
constexpr double kShortest = 0.15;        // of a closing [s]
constexpr double kDeeper = 0.004;         // closing beyond the body's width [m]
constexpr double kAfterwards = 0.4;       // time after the hand has opened [s]
constexpr std::size_t kOpening = 6;       // frames after opening for the hand's speed
constexpr std::size_t kMaxClosings = 10;  // closings of one recording
constexpr double kOpen = 0.02;            // aperture of a passing hand beyond the body's width [m]
constexpr double kPassing = 1.0;          // required duration of that [s]
constexpr double kLevel = 0.7;            // standing bodies are grasped from the side: sine of the elevation

const Vector3& thumb(const Sighting& hand) {
  return hand.joints[0][4];
}

Vector3 opposite(Kind kind, const Sighting& hand) {
  if (kind == Kind::pinch) return hand.joints[1][4];
  return 0.25 * (hand.joints[1][4] + hand.joints[2][4] + hand.joints[3][4] + hand.joints[4][4]);
}

double opening(Kind kind, const Sighting& hand) {
  return (thumb(hand) - opposite(kind, hand)).norm();
}

Vector3 grip(Kind kind, const Sighting& hand) {
  return 0.5 * (thumb(hand) + opposite(kind, hand));
}

/// Orientation about the vertical with x along `x`.
std::optional<Pose> upright(const Vector3& centre, const Vector3& x) {
  if (!centre.allFinite() || !(std::abs(x.z()) < kLevel)) return std::nullopt;
  return Pose{centre, Quaternion(Eigen::AngleAxisd(std::atan2(x.y(), x.x()), Vector3::UnitZ()))};
}

/// Centre of the closing parts; x from the thumb to the opposing part, y along the index's distal bone.
std::optional<Pose> place_in(const Row& row, const Sighting& hand) {
  const Kind kind = row.kind;
  const Vector3 x = (opposite(kind, hand) - thumb(hand)).normalized();
  if (row.rests) return upright(grip(kind, hand), x);
  Vector3 along = hand.joints[1][4] - hand.joints[1][3];
  if (!along.allFinite()) along.setZero();
  const Vector3 y = (along - x * x.dot(along)).normalized();
  Matrix3 axes;
  axes << x, y, x.cross(y);
  const Vector3 centre = grip(kind, hand);
  if (!centre.allFinite() || !axes.allFinite() || y.isZero()) return std::nullopt;
  return Pose{centre, Quaternion(axes)};
}

double signed_distance(const Vector3& point, const Row& row, const Pose& place) {
  const Vector3 local = place.to_local(point);
  const double half = 0.5 * row.size;
  if (row.sphere) return local.norm() - half;
  const Vector3 outside = local.cwiseAbs() - Vector3::Constant(half);
  return outside.cwiseMax(0.0).norm() + std::min(outside.maxCoeff(), 0.0);
}

/// Frames of a track from `closed` to before `opened`, in which the hand is closed.
struct Span {
  std::size_t closed, opened;
};

std::vector<Span> closed_spans(const Track& track, Kind kind, double limit) {
  std::vector<double> open;
  for (const Sighting& hand : track) open.push_back(opening(kind, hand));
  const auto follows = [&](std::size_t i) { return track[i].time - track[i - 1].time < kGap; };
  std::vector<Span> spans;
  for (std::size_t k = 1; k < open.size(); ++k) {
    if (!(open[k] < limit && limit <= open[k - 1] && follows(k))) continue;
    std::size_t end = k;
    double least = open[k];
    for (; end < open.size() && open[end] < limit && (end == k || follows(end)); ++end)
      least = std::min(least, open[end]);
    const bool seen_to_open = end < open.size() && follows(end);
    if (seen_to_open && track[end - 1].time - track[k].time > kShortest && least < limit - kDeeper)
      spans.push_back({k, end});
    k = end;
  }
  return spans;
}

/// Times in which a hand stays open; the body is placed at their middle.
std::vector<Span> open_spans(const Track& track, Kind kind, double limit) {
  std::vector<Span> spans;
  std::size_t from = 0;
  for (std::size_t k = 0; k < track.size(); ++k) {
    const bool open = opening(kind, track[k]) > limit + kOpen;
    if (!open || (k > from && track[k].time - track[k - 1].time > kGap)) from = open ? k : k + 1;
    if (!open || track[k].time - track[from].time < kPassing) continue;
    spans.push_back({(from + k) / 2, k});
    from = k + 1;
  }
  return spans;
}

/// Last of the track's frames before `closed` in which no hand is near the body.
std::optional<std::size_t> clear_before(std::size_t closed, const Recording& recording, const Track& track,
                                        const Row& row, const Pose& place) {
  for (std::size_t m = closed; m-- > 0 && m + kEarliest > closed;) {
    if (track[m + 1].time - track[m].time > kGap) return std::nullopt;
    if (clearance(recording.sightings[track[m].frame], row, place) > kClear) return m;
  }
  return std::nullopt;
}

double fastest(const Track& track, std::size_t begin, std::size_t end) {
  double speed = 0.0;
  for (std::size_t m = std::max<std::size_t>(1, begin); m < std::min(end + kOpening, track.size()); ++m) {
    for (std::size_t f = 0; f < kFingers; ++f) {
      for (std::size_t j = 0; j < 5; ++j) {
        const double way = (track[m].joints[f][j] - track[m - 1].joints[f][j]).norm();
        if (std::isfinite(way)) speed = std::max(speed, way / (track[m].time - track[m - 1].time));
      }
    }
  }
  return speed;
}

std::size_t last_frame_until(const Recording& recording, std::size_t from, double time) {
  while (from + 1 < recording.frames.size() && to_seconds(recording.frames[from + 1].stamp) <= time) ++from;
  return from;
}

std::optional<Closing> closing(const Recording& recording, std::size_t track_index, const Span& span,
                               const Row& row) {
  const Track& track = recording.tracks[track_index];
  const auto place = place_in(row, track[span.closed]);
  if (!place) return std::nullopt;
  const auto begin = clear_before(span.closed, recording, track, row, *place);
  if (!begin) return std::nullopt;
  Closing result;
  result.track = track_index;
  result.hand = track.front().id;
  result.place = *place;
  result.begin = track[*begin].frame;
  result.closed = track[span.closed].time;
  result.opens = track[span.opened - 1].time;
  result.last = last_frame_until(recording, track[span.opened - 1].frame, result.opens + kAfterwards);
  result.grip_at_end = grip(row.kind, track[span.opened - 1]);
  result.hand_speed = fastest(track, *begin, span.opened);
  return result;
}

}  // namespace

std::vector<Row> all_rows() {
  return {{"pinch20", Kind::pinch, false, 0.02, 0.03},
          {"pinch30", Kind::pinch, false, 0.03, 0.06},
          {"pinch40", Kind::pinch, false, 0.04, 0.1},
          {"grab_sphere60", Kind::grab, true, 0.06, 0.1},
          {"grab_sphere80", Kind::grab, true, 0.08, 0.1},
          {"grab_cube60", Kind::grab, false, 0.06, 0.1},
          {"grab_cube80", Kind::grab, false, 0.08, 0.1},
          {"rest_sphere60", Kind::grab, true, 0.06, 0.1, true},
          {"rest_sphere100", Kind::grab, true, 0.1, 0.2, true},
          {"rest_cube60", Kind::grab, false, 0.06, 0.1, true},
          {"rest_cube100", Kind::grab, false, 0.1, 0.2, true},
          {"pass_sphere40", Kind::pass, true, 0.04, 0.1},
          {"pass_cube40", Kind::pass, false, 0.04, 0.1},
          {"pass_sphere60", Kind::pass, true, 0.06, 0.1, true},
          {"pass_cube60", Kind::pass, false, 0.06, 0.1, true}};
}

double clearance(const std::vector<Sighting>& hands, const Row& row, const Pose& place) {
  double best = std::numeric_limits<double>::infinity();
  for (const Sighting& hand : hands) {
    for (const auto& finger : hand.joints) {
      for (std::size_t j = 0; j < 4; ++j) {
        for (int u = 0; u <= 8; ++u) {
          const Vector3 point = finger[j] + u / 8.0 * (finger[j + 1] - finger[j]);
          if (point.allFinite()) best = std::min(best, signed_distance(point, row, place) - kTip);
        }
      }
    }
    if (hand.palm.allFinite()) best = std::min(best, signed_distance(hand.palm, row, place) - kPalm);
  }
  return best;
}

std::vector<Closing> closings(const Recording& recording, const Row& row) {
  std::vector<Closing> found;
  std::size_t tried = 0;
  for (std::size_t t = 0; t < recording.tracks.size(); ++t) {
    const double limit = row.size + 2.0 * kTip;
    const Track& track = recording.tracks[t];
    for (const Span& span :
         row.kind == Kind::pass ? open_spans(track, row.kind, limit) : closed_spans(track, row.kind, limit)) {
      if (tried++ == kMaxClosings) return found;
      if (auto next = closing(recording, t, span, row)) found.push_back(std::move(*next));
    }
  }
  return found;
}

}  // namespace mrhi::real_grasps
