#include "trial.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "statistics.h"

namespace mrhi::real_grasps {
namespace {

constexpr double kLossAllowed = 0.06;  // time before opening at which a grasp may end [s]
constexpr double kPressed = 0.15;     // a hand that opens slowly releases before its aperture has widened [s]
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

double fastest(const Story& story) {
  double speed = 0.0;
  for (const Moment& moment : story.moments) speed = std::max(speed, moment.velocity.norm());
  return speed;
}

void judge_release(const Story& story, const Track& track, double opens, Outcome& outcome) {
  const auto free = std::find_if(story.moments.begin(), story.moments.end(), [opens](const Moment& moment) {
    return moment.time > opens && !moment.pressed;
  });
  if (free == story.moments.end()) return;
  outcome.let_go = free->time;
  outcome.release = (free->velocity - palm_velocity(track, free->time)).norm();
}

bool pressed_until(const Story& story, double time) {
  return std::any_of(story.moments.begin(), story.moments.end(), [time](const Moment& moment) {
    return moment.pressed && moment.time <= time && moment.time >= time - kPressed;
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

Outcome outcome_of(const Story& story, const Track& track, const Closing& closing, const Row& row) {
  Outcome outcome;
  outcome.early = (nearest(story.moments, closing.closed).place - closing.place.position).norm();
  outcome.away = (nearest(story.moments, closing.opens).place - closing.grip_at_end).norm();
  outcome.force = quantile(story.forces, 0.9);
  outcome.speed = fastest(story) / closing.hand_speed;
  outcome.frame_times = story.frame_times;
  outcome.taken = story.taken;
  outcome.blow = story.blow;
  outcome.grasp_began = story.grasp_began;
  outcome.grasp_ended = story.grasp_ended;
  const bool began = story.grasp_began && *story.grasp_began < closing.opens;
  const bool lost = story.grasp_ended && *story.grasp_ended < closing.opens - kLossAllowed;
  const bool in_hand = outcome.away < std::max(kLeastAway, row.size);
  outcome.carried = in_hand && pressed_until(story, closing.opens);
  outcome.held = story.has_grasps ? began && !lost && in_hand : outcome.carried;
  judge_release(story, track, closing.opens, outcome);
  return outcome;
}

Outcome play(const Recording& recording, const Closing& closing, const Row& row,
             const Disturbance& disturbance, const Player& player) {
  Outcome outcome;
  try {
    const Story story =
        player(disturbed(recording.frames, closing.begin, closing.last, disturbance), closing, row);
    if (!story.moments.empty()) return outcome_of(story, recording.tracks[closing.track], closing, row);
    outcome.note = "no usable frame";
  } catch (const std::exception& error) {
    outcome.note = error.what();
  }
  return outcome;
}

}  // namespace mrhi::real_grasps
