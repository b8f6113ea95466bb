#include <chrono>

#include "contact_history.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/simulation.h"
#include "recording.h"
#include "trial.h"

namespace mrhi::real_grasps {
namespace {

constexpr double kUnbounded = 1e3;      // no bounds: a lost body stays lost [m]
constexpr double kColumn = 0.5;         // height of the column under a resting body [m]
constexpr double kColumnRadius = 0.02;  // [m]

Body column_under(const Row& row, const Pose& place) {
  Body column;
  column.name = "column";
  column.fixed = true;
  column.start.position = place.position - Vector3(0.0, 0.0, 0.5 * (row.size + kColumn));
  column.shapes.push_back({Cylinder{kColumnRadius, 0.5 * kColumn}, {}});
  return column;
}

Scene scene_of(const Row& row, const Closing& closing, const Configuration& configuration) {
  Scene scene;
  scene.name = row.name;
  scene.bounds = {Vector3::Constant(-kUnbounded), Vector3::Constant(kUnbounded)};
  scene.bodies.push_back(body_of(row, closing.place, default_material(configuration)));
  if (row.rests) {
    scene.gravity.z() = -9.81;
    scene.bodies.push_back(column_under(row, closing.place));
  }
  return scene;
}

void look(const Simulation& simulation, Playback& playback) {
  const FrameResult& result = simulation.result();
  const BodyState& state = simulation.state().bodies.front();
  if (!playback.first_motion && !playback.moments.empty())
    playback.first_motion =
        first_motion(simulation, 0, to_seconds(result.stamp) - playback.moments.back().time);
  Moment moment{to_seconds(result.stamp), state.pose.position,
                twist_of(simulation.scene().bodies.front(), state).linear};
  for (const Contact& contact : result.contacts) moment.loaded |= contact.touching();
  playback.moments.push_back(moment);
  for (const Grip& grip : simulation.state().grips) playback.assisted |= grip.active;
  add_finger_forces(result, playback.forces);
  for (const Event& event : result.events) {
    const bool begins = event.kind == EventKind::grasp_begin;
    if (!begins && event.kind != EventKind::grasp_end) continue;
    auto& first = begins ? playback.grasp_began : playback.grasp_ended;
    if (!first) first = to_seconds(event.stamp);
  }
}

}  // namespace

Playback play_ours(const std::vector<JointsFrame>& frames, const Closing& closing, const Row& row,
                   const Configuration& configuration) {
  using Clock = std::chrono::steady_clock;
  Simulation simulation(scene_of(row, closing, configuration), configuration);
  Playback playback;
  playback.has_grasps = true;
  std::vector<std::string> left_out;
  for (const JointsFrame& joints : frames) {
    const auto frame = complete_frame(joints, device_mount(), left_out);
    if (!frame) continue;
    const auto begin = Clock::now();
    if (simulation.advance(*frame) != Rejection::none) continue;
    playback.frame_times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
    look(simulation, playback);
  }
  return playback;
}

}  // namespace mrhi::real_grasps
