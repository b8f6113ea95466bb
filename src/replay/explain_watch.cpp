#include <algorithm>
#include <cmath>

#include "explain.h"
#include "grip_margin.h"

namespace mrhi {
namespace {

std::string face_of(const Vector3& outward_in_body) {
  int axis = 0;
  outward_in_body.cwiseAbs().maxCoeff(&axis);
  return std::string(outward_in_body[axis] < 0.0 ? "-" : "+") + "xyz"[axis];
}

/// While its contacts are gathered, `outward` is their normals weighed by their pushes.
FingerTouch& touch_of(std::uint32_t hand, int finger, std::vector<FingerTouch>& touches) {
  for (FingerTouch& touch : touches)
    if (touch.hand_id == hand && touch.finger == finger) return touch;
  touches.emplace_back();
  touches.back().hand_id = hand;
  touches.back().finger = finger;
  touches.back().slips = true;
  return touches.back();
}

struct Gathered {
  std::vector<FingerTouch> fingers;
  double limit = 0.0;
  Vector3 thumb_side = Vector3::Zero(),
          other_side = Vector3::Zero();  // places, weighed by their pushes [N m]
  double thumb_push = 0.0, other_push = 0.0;
  std::vector<GripContact> grips;
  Load load;  // that friction bears
};

/// Of a round patch that presses evenly: of its radius.
constexpr double kPatchTorque = 2.0 / 3.0;

void add(const Contact& contact, const Material& material, std::uint32_t hand, Gathered& all) {
  const FrictionUse use = friction_use(contact, material);
  const int finger = finger_of(contact.key.capsule);
  FingerTouch& touch = touch_of(hand, finger, all.fingers);
  touch.normal += use.normal;
  touch.tangential += use.tangential;
  touch.limit += use.limit;
  touch.depth = std::max(touch.depth, contact.depth);
  touch.slips &= contact.friction == Friction::slipping;
  touch.outward += std::max(use.normal, 1e-6) * contact.normal;
  all.limit += use.limit;
  all.grips.push_back({contact.point, contact.normal, use.limit, kPatchTorque * contact.patch});
  const Vector3 along = contact.force + use.normal * contact.normal;
  all.load.force += along;
  all.load.torque += (contact.point - all.load.about).cross(along);
  const double push = std::max(use.normal, 0.0);
  const bool thumb = finger == 0 || finger == kFingers;
  (thumb ? all.thumb_side : all.other_side) += push * contact.point;
  (thumb ? all.thumb_push : all.other_push) += push;
}

double torque_about_grip(const Gathered& all, const std::vector<Contact>& contacts, std::size_t body) {
  if (all.thumb_push <= 0.0 || all.other_push <= 0.0) return 0.0;
  const Vector3 a = all.thumb_side / all.thumb_push, b = all.other_side / all.other_push;
  if ((b - a).norm() < 1e-3) return 0.0;
  const Vector3 axis = (b - a).normalized();
  double torque = 0.0;
  for (const Contact& contact : contacts)
    if (contact.key.body == body && contact.touching())
      torque += axis.dot((contact.point - a).cross(contact.force));
  return torque;
}

Gathered gathered(const Simulation& simulation, std::size_t body) {
  Gathered all;
  all.load.about = simulation.state().bodies[body].pose.position;
  const Material& material = simulation.scene().bodies[body].material;
  for (const Contact& contact : simulation.result().contacts)
    if (contact.key.body == body && contact.touching())
      add(contact, material, hand_id(contact, simulation.state()), all);
  const Quaternion to_body = simulation.state().bodies[body].pose.orientation.conjugate();
  for (FingerTouch& touch : all.fingers) {
    touch.outward.normalize();
    touch.face = face_of(to_body * touch.outward);
  }
  return all;
}

bool is_helped(std::size_t body, const SimulationState& state) {
  return std::any_of(state.grips.begin(), state.grips.end(),
                     [&](const Grip& grip) { return grip.body == body && grip.bears; });
}

std::string joint_of(std::size_t body, const Scene& scene) {
  for (const Joint& joint : scene.joints)
    if (joint.child == static_cast<int>(body)) return joint.name;
  return "";
}

void add_blows(const Simulation& simulation, std::size_t body, ObjectSample& sample) {
  for (const Contact& contact : simulation.result().contacts) {
    if (contact.key.body != body || contact.touching() || contact.impulse.isZero(0.0)) continue;
    const int finger = finger_of(contact.key.capsule);
    if (std::find(sample.struck.begin(), sample.struck.end(), finger) == sample.struck.end())
      sample.struck.push_back(finger);
    sample.struck_by = hand_id(contact, simulation.state());
  }
}

InteractionLevel level_of(const SimulationState& state, std::size_t body) {
  InteractionLevel level = InteractionLevel::none;
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot)
    level = std::max(level, state.interactions[slot * state.bodies.size() + body].level);
  return level;
}

/// `before`: what came before it; nothing at first.
Course course_of(const ObjectSample& sample, const ObjectSample* before) {
  if (sample.level == InteractionLevel::grasp) {
    const bool all_slip = std::all_of(sample.fingers.begin(), sample.fingers.end(),
                                      [](const FingerTouch& touch) { return touch.slips; });
    return all_slip ? Course::slip : Course::hold;
  }
  if (!sample.fingers.empty() || sample.level == InteractionLevel::contact) return Course::contact;
  if (before == nullptr || before->course == Course::free) return Course::free;
  const bool held_before = before->level == InteractionLevel::grasp || before->course == Course::drop;
  return held_before ? Course::drop : Course::free;
}

Vector3 half_of(const Body& body) {
  const Box* box = body.shapes.size() == 1 ? std::get_if<Box>(&body.shapes[0].shape) : nullptr;
  return box == nullptr ? Vector3(Vector3::Zero()) : box->half_extents;
}

}  // namespace

const char* to_string(Course course) {
  constexpr const char* kNames[] = {"free", "contact", "hold", "slip", "drop"};
  return kNames[static_cast<std::size_t>(course)];
}

void Explainer::watch(const Simulation& simulation) {
  const FrameResult& result = simulation.result();
  if (!begun_) first_ = result.stamp;
  begun_ = true;
  const double time = to_seconds(result.stamp - first_);
  story_.times.push_back(time);
  story_.gravity = simulation.configuration().gravity.value_or(simulation.scene().gravity);
  for (const HandTrack& track : simulation.state().hands) {
    if (!track.active) continue;
    std::vector<HandSample>& hand = story_.hands[track.current.id];
    HandSample sample{time, track.current.id, 0.0, track.current.confidence, track.held, track.current};
    if (!hand.empty() && time > hand.back().time)
      sample.speed =
          (sample.hand.palm.position - hand.back().hand.palm.position).norm() / (time - hand.back().time);
    hand.push_back(sample);
  }
  for (std::size_t b = 0; b < simulation.scene().bodies.size(); ++b)
    if (!simulation.scene().bodies[b].fixed) watch_object(simulation, b, time);
  for (std::size_t j = 0; j < simulation.scene().joints.size(); ++j) watch_joint(simulation, j, time);
  for (const Event& event : result.events) {
    const bool has_body = event.body >= 0;
    story_.events.push_back(
        {to_seconds(event.stamp - first_), event.kind,
         has_body ? simulation.scene().bodies[static_cast<std::size_t>(event.body)].name : std::string(),
         event.hand_id});
  }
}

void Explainer::watch_joint(const Simulation& simulation, std::size_t joint, double time) {
  const Joint& what = simulation.scene().joints[joint];
  JointStory& story = story_.joints[what.name];
  story.body = simulation.scene().bodies[static_cast<std::size_t>(what.child)].name;
  story.turns = what.kind == JointKind::turning;
  story.lower = what.lower;
  story.upper = what.upper;
  story.samples.push_back({time, simulation.state().joints[joint].position});
}

void Explainer::watch_object(const Simulation& simulation, std::size_t body, double time) {
  const Body& what = simulation.scene().bodies[body];
  const BodyState& state = simulation.state().bodies[body];
  ObjectStory& story = story_.objects[what.name];
  story.mass = what.mass;
  story.material = what.material;
  story.radius = what.bounding_radius;
  story.half = half_of(what);
  story.joint = joint_of(body, simulation.scene());
  const Gathered all = gathered(simulation, body);
  ObjectSample sample;
  sample.time = time;
  sample.level = level_of(simulation.state(), body);
  sample.helped = is_helped(body, simulation.state());
  sample.fingers = all.fingers;
  add_blows(simulation, body, sample);
  sample.position = state.pose.position;
  sample.orientation = state.pose.orientation;
  sample.velocity = twist_of(what, state).linear;
  sample.torque = torque_about_grip(all, simulation.result().contacts, body);
  sample.margin = std::max(0.0, all.limit - all.load.force.norm());
  sample.bearable = bearable(all.grips, all.load);
  sample.course = course_of(sample, story.samples.empty() ? nullptr : &story.samples.back());
  story.samples.push_back(sample);
}

Explanation Explainer::explain(const std::string& input) {
  story_.input = input;
  find_losses(story_);
  story_.moments = picture_moments(story_);
  return story_;
}

}  // namespace mrhi
