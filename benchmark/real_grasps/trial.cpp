#include "trial.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "statistics.h"

namespace mrhi::real_grasps {
namespace {

constexpr double kLossAllowed = 0.06;  // time before opening at which a grasp may end [s]
constexpr double kLoadedBefore =
    0.15;                             // a hand that opens slowly releases before its aperture has widened [s]
constexpr double kLeastAway = 0.025;  // minimum of the allowed distance from the grip, for small bodies [m]
constexpr double kPalmWindow = 0.05;  // averaging time of the palm's velocity, to both sides [s]

/// Entry with the nearest time.
template <typename Timed>
const Timed& nearest(const std::vector<Timed>& all, double time) {
  return *std::min_element(all.begin(), all.end(), [time](const Timed& a, const Timed& b) {
    return std::abs(a.time - time) < std::abs(b.time - time);
  });
}

Vector3 palm_velocity(const Track& track, double time) {
  const Sighting &from = nearest(track, time - kPalmWindow), &to = nearest(track, time + kPalmWindow);
  const auto middle = [](const Sighting& hand) {  // of the knuckles, which every tracker reports
    return Vector3(0.25 * (hand.joints[1][1] + hand.joints[2][1] + hand.joints[3][1] + hand.joints[4][1]));
  };
  return (middle(to) - middle(from)) / (to.time - from.time);
}

double fastest(const Playback& playback) {
  double speed = 0.0;
  for (const Moment& moment : playback.moments) speed = std::max(speed, moment.velocity.norm());
  return speed;
}

void measure_release(const Playback& playback, const Track& track, double opens, Outcome& outcome) {
  const auto free =
      std::find_if(playback.moments.begin(), playback.moments.end(),
                   [opens](const Moment& moment) { return moment.time > opens && !moment.loaded; });
  if (free == playback.moments.end()) return;
  outcome.released = free->time;
  outcome.release = (free->velocity - palm_velocity(track, free->time)).norm();
}

bool loaded_until(const Playback& playback, double time) {
  return std::any_of(playback.moments.begin(), playback.moments.end(), [time](const Moment& moment) {
    return moment.loaded && moment.time <= time && moment.time >= time - kLoadedBefore;
  });
}

}  // namespace

Body body_of(const Row& row, const Pose& place, const Material& material) {
  Body body;
  body.name = "placed";
  body.mass = row.mass;
  body.inertia = row.mass * row.size * row.size * (row.sphere ? 0.1 : 1.0 / 6.0) * Matrix3::Identity();
  body.start = place;
  body.material = material;
  if (row.sphere) {
    body.shapes.push_back({Sphere{0.5 * row.size}, {}});
  } else {
    body.shapes.push_back({Box{Vector3::Constant(0.5 * row.size)}, {}});
  }
  return body;
}

Outcome outcome_of(const Playback& playback, const Track& track, const Closing& closing, const Row& row) {
  Outcome outcome;
  outcome.early = (nearest(playback.moments, closing.closed).place - closing.place.position).norm();
  outcome.away = (nearest(playback.moments, closing.opens).place - closing.grip_at_end).norm();
  outcome.force = quantile(playback.forces, 0.9);
  outcome.speed = fastest(playback) / closing.hand_speed;
  outcome.frame_times = playback.frame_times;
  outcome.assisted = playback.assisted;
  outcome.first_motion = playback.first_motion;
  outcome.grasp_began = playback.grasp_began;
  outcome.grasp_ended = playback.grasp_ended;
  const bool began = playback.grasp_began && *playback.grasp_began < closing.opens;
  const bool lost = playback.grasp_ended && *playback.grasp_ended < closing.opens - kLossAllowed;
  const bool in_hand = outcome.away < std::max(kLeastAway, row.size);
  outcome.carried = in_hand && loaded_until(playback, closing.opens);
  outcome.held = playback.has_grasps ? began && !lost && in_hand : outcome.carried;
  measure_release(playback, track, closing.opens, outcome);
  return outcome;
}

Outcome play(const Recording& recording, const Closing& closing, const Row& row,
             const Disturbance& disturbance, const Player& player) {
  Outcome outcome;
  try {
    const Playback playback =
        player(disturbed(recording.frames, closing.begin, closing.last, disturbance), closing, row);
    if (!playback.moments.empty()) return outcome_of(playback, recording.tracks[closing.track], closing, row);
    outcome.note = "no usable frame";
  } catch (const std::exception& error) {
    outcome.note = error.what();
  }
  return outcome;
}

}  // namespace mrhi::real_grasps
