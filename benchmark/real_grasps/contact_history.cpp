#include "contact_history.h"

#include <algorithm>
#include <map>
#include <utility>

#include "mr_hand_interaction/integration/body_state.h"

namespace mrhi::real_grasps {
namespace {

constexpr double kMinSpeed = 0.03;        // [m/s]
constexpr double kBack = -0.3;            // cosine of the normal to the direction out of the back of the hand
constexpr double kMinPalmSpeed = 0.1;     // of the palm towards the body [m/s]
constexpr double kMinPalmFraction = 0.5;  // and over the phalanx's speed
constexpr double kClosing = -0.1;         // rate of the distance between a finger's tip and the thumb's [m/s]

/// Contact with the largest impulse.
const Contact* hardest(const FrameResult& result, int body, double seconds) {
  const auto push = [seconds](const Contact& contact) {
    return contact.impulse.norm() + seconds * contact.force.norm();
  };
  const Contact* most = nullptr;
  for (const Contact& contact : result.contacts)
    if (contact.key.body == body && (most == nullptr || push(contact) > push(*most))) most = &contact;
  return most;
}

/// Distance from the thumb's tip to the finger's, or for the thumb to the index finger's [m].
double opening(const Hand& hand, int finger) {
  const auto tip = [&hand](int f) {
    return hand.capsules[static_cast<std::size_t>(capsule_index(f, kBonesPerFinger - 1))].end;
  };
  return (tip(std::clamp(finger, 1, kFingers - 1)) - tip(0)).norm();
}

MotionCause kind(const Contact& contact, const HandTrack& track, double seconds) {
  const Hand &from = track.previous, &to = track.current;
  if (contact.normal.dot(to.palm.orientation * Vector3::UnitZ()) < kBack) return MotionCause::back;
  const double palm = -contact.normal.dot(to.palm.position - from.palm.position) / seconds;
  const double phalanx = -contact.normal.dot(contact.hand_velocity);
  if (palm > std::max(kMinPalmSpeed, kMinPalmFraction * phalanx)) return MotionCause::sweep;
  const int finger = finger_of(contact.key.capsule);
  const bool closes = finger < kFingers && (opening(to, finger) - opening(from, finger)) / seconds < kClosing;
  return closes ? MotionCause::closing : MotionCause::open;
}

}  // namespace

const char* to_string(MotionCause cause) {
  switch (cause) {
    case MotionCause::back:
      return "back of the hand";
    case MotionCause::sweep:
      return "hand as a whole";
    case MotionCause::closing:
      return "closing finger";
    case MotionCause::open:
      break;
  }
  return "open hand";
}

std::optional<FirstMotion> first_motion(const Simulation& simulation, int body, double seconds) {
  const auto b = static_cast<std::size_t>(body);
  const Body& what = simulation.scene().bodies[b];
  if (!(seconds > 0.0) || twist_of(what, simulation.state().bodies[b]).linear.norm() < kMinSpeed)
    return std::nullopt;
  const Contact* contact = hardest(simulation.result(), body, seconds);
  if (contact == nullptr) return std::nullopt;
  return FirstMotion{to_seconds(simulation.result().stamp),
                     kind(*contact, simulation.state().hands[contact->key.hand], seconds)};
}

void add_finger_forces(const FrameResult& result, std::vector<double>& forces) {
  std::map<std::pair<int, int>, double> sums;  // by hand and finger
  for (const Contact& contact : result.contacts) {
    if (contact.impulse.isZero(0.0))
      sums[{contact.key.hand, finger_of(contact.key.capsule)}] += contact.force.norm();
  }
  for (const auto& [finger, sum] : sums) forces.push_back(sum);
}

}  // namespace mrhi::real_grasps
