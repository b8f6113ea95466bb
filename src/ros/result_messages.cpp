#include "result_messages.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "../math/rotation.h"
#include "../record/record.h"
#include "../scene/shape_kinds.h"
#include "../simulation/contact_phase.h"
#include "../text/text.h"
#include "mr_hand_interaction/interaction.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/markers.h"

namespace mrhi {

namespace msg = mr_hand_interaction;

static_assert(msg::Contact::IMPULSE == int(ContactPhase::impulse) &&
                  msg::Contact::STICKING == int(ContactPhase::sticking) &&
                  msg::Contact::SLIPPING == int(ContactPhase::slipping),
              "phases are numbered as in Contact.msg");

namespace {

bool has_load(const Contact& contact) {
  return contact.touching() || !contact.impulse.isZero(0.0) || !contact.force.isZero(0.0);
}

/// Sums the contacts of each phalanx with each body. They are sorted by body, then by hand and phalanx.
void add_phalanges(int slot, const Scene& scene, const std::vector<Contact>& contacts,
                   std::vector<msg::PhalanxHaptics>& phalanges) {
  for (auto contact = contacts.begin(); contact != contacts.end();) {
    const auto first = contact;
    Vector3 force = Vector3::Zero(), impulse = Vector3::Zero(), normals = Vector3::Zero();
    double depth = 0.0, peak = 0.0;
    bool loaded = false, slips = false;
    for (; contact != contacts.end() && first->key.same_phalanx(contact->key); ++contact) {
      if (first->key.hand != slot || !has_load(*contact)) continue;
      force += contact->force;
      impulse += contact->impulse;
      normals += contact->normal;
      depth = std::max(depth, contact->depth);
      peak = std::max(peak, contact->peak_force);
      slips = slips || (contact->touching() && contact->friction != Friction::sticking);
      loaded = true;
    }
    if (!loaded) continue;
    const Vector3 normal = normals.normalized();
    msg::PhalanxHaptics& phalanx = phalanges.emplace_back();
    phalanx.finger = finger_of(first->key.capsule);
    phalanx.bone = bone_of(first->key.capsule);
    phalanx.object = scene.bodies[first->key.body].name;
    phalanx.slip = slips ? phalanx.SLIPPING : phalanx.STICKING;
    phalanx.force = vector_message(force);
    phalanx.impulse = vector_message(impulse);
    phalanx.normal = vector_message(normal);
    phalanx.pressure = std::max(0.0, -normal.dot(force));
    phalanx.depth = depth;
    phalanx.peak_force = std::max(peak, force.norm());
  }
}

geometry_msgs::Pose joint_message(const Vector3& position, const Vector3& along) {
  return to_message(Pose{position, rotation_between(Vector3::UnitX(), along)});
}

void add_finger(const Hand& hand, int finger, geometry_msgs::PoseArray& message) {
  for (int joint = 0; joint < kBonesPerFinger; ++joint) {
    const int bone = capsule_index(finger, std::max(joint, 1));
    const Capsule& capsule = hand.capsules[bone];
    message.poses.push_back(
        hand.has(bone) ? joint_message(joint == 0 ? capsule.start : capsule.end, capsule.end - capsule.start)
                       : to_message(Pose{Vector3::Constant(std::numeric_limits<double>::quiet_NaN()),
                                         Quaternion::Identity()}));
  }
}

msg::SceneShape shape_message(const Shape& shape, const Pose& pose) {
  msg::SceneShape message;
  message.pose = to_message(pose);
  for (std::size_t type = 0; type < kShapeTypes.size(); ++type) {
    if (const auto size = find_shape_kind(kShapeTypes[type])->sizes_of(shape)) {
      message.type = type;
      message.size = *size;
    }
  }
  const Mesh* const mesh = std::get_if<Mesh>(&shape);
  if (mesh == nullptr) return message;
  message.type = msg::SceneShape::MESH;
  message.mesh = mesh->uri;
  message.scale = vector_message(mesh->scale);
  if (!mesh->triangles) return message;
  for (const Vector3& vertex : mesh->triangles->vertices) {
    geometry_msgs::Point32& point = message.vertices.emplace_back();
    point.x = vertex.x(), point.y = vertex.y(), point.z = vertex.z();
  }
  for (const auto& triangle : mesh->triangles->triangles)
    message.triangles.insert(message.triangles.end(), triangle.begin(), triangle.end());
  return message;
}

/// A request without an orientation has the identity.
Pose pose_or_identity(const geometry_msgs::Pose& message) {
  Pose pose = from_message(message);
  if (pose.orientation.coeffs().isZero(0.0)) pose.orientation.setIdentity();
  return pose;
}

}  // namespace

msg::HandFrame tracked_message(const Outcome& outcome, const std_msgs::Header& header) {
  msg::HandFrame message;
  message.header = header;
  for (const Hand& hand : outcome.result.tracked) message.hands.push_back(to_message(hand));
  return message;
}

msg::HandFrame rendered_message(const Outcome& outcome, const std_msgs::Header& header) {
  msg::HandFrame message;
  message.header = header;
  for (const RenderedHand& rendered : outcome.result.rendered) {
    message.hands.push_back(to_message(rendered.hand, rendered.touching));
  }
  return message;
}

msg::ObjectStateArray objects_message(const Outcome& outcome, const std_msgs::Header& header) {
  const auto& [scene, result, state] = outcome;
  msg::ObjectStateArray message;
  message.header = header;
  message.objects.reserve(scene.bodies.size());
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (body.fixed) continue;
    msg::ObjectState& object = message.objects.emplace_back();
    object.name = body.name;
    object.pose = to_message(state.bodies[i].pose);
    object.twist = to_message(twist_of(body, state.bodies[i]));
    object.mass = body.mass;
    object.held = is_held(i, state);
    object.is_operator = body.is_operator;
    const std::optional<GraspSupport> assist = assist_on(i, result);
    object.assisted = assist.has_value();
    object.assist_force = vector_message(assist.value_or(GraspSupport{}).force);
    object.assist_torque = vector_message(assist.value_or(GraspSupport{}).torque);
  }
  return message;
}

msg::ContactArray contacts_message(const Outcome& outcome, const std_msgs::Header& header) {
  const auto& [scene, result, state] = outcome;
  msg::ContactArray message;
  message.header = header;
  message.contacts.reserve(result.contacts.size());
  for (const Contact& contact : result.contacts) {
    msg::Contact& entry = message.contacts.emplace_back();
    entry.object = scene.bodies[contact.key.body].name;
    entry.hand_id = hand_id(contact, state);
    entry.finger = finger_of(contact.key.capsule);
    entry.bone = bone_of(contact.key.capsule);
    entry.phase = static_cast<std::uint8_t>(phase(contact));
    entry.position = to_message(contact.point);
    entry.normal = vector_message(contact.normal);
    entry.depth = contact.depth;
    entry.impulse = vector_message(contact.impulse);
    entry.force = vector_message(contact.force);
    const FrictionUse use = friction_use(contact, scene.bodies[contact.key.body].material);
    entry.normal_force = use.normal;
    entry.tangential_force = use.tangential;
    entry.friction_limit = use.limit;
    entry.peak_force = contact.peak_force;
    entry.torque = contact.torque;
  }
  return message;
}

msg::RenderedView view_message(const Outcome& outcome, const std_msgs::Header& header) {
  msg::RenderedView message;
  message.header = header;
  message.rendered_hands = rendered_message(outcome, header).hands;
  message.tracked_hands = tracked_message(outcome, header).hands;
  message.objects = objects_message(outcome, header).objects;
  message.contacts = contacts_message(outcome, header).contacts;
  return message;
}

msg::InteractionEvent event_message(const Scene& scene, const FrameResult& result, const Event& event,
                                    const std_msgs::Header& header) {
  msg::InteractionEvent message;
  message.header = header;
  message.kind = static_cast<std::uint8_t>(event.kind);
  if (event.body >= 0) {
    const std::size_t body = event.body;
    message.object = scene.bodies[body].name;
    message.assisted = assist_on(body, result).has_value();
  }
  message.hand_id = event.hand_id;
  return message;
}

std::vector<geometry_msgs::TransformStamped> object_transforms(const Scene& scene,
                                                               const SimulationState& state,
                                                               const std_msgs::Header& header) {
  std::vector<geometry_msgs::TransformStamped> transforms(scene.bodies.size());
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Pose link = state.bodies[i].pose * scene.bodies[i].link_in_body;
    geometry_msgs::TransformStamped& transform = transforms[i];
    transform.header = header;
    transform.child_frame_id = scene.bodies[i].name;
    transform.transform.translation = vector_message(link.position);
    transform.transform.rotation = to_message(link).orientation;
  }
  return transforms;
}

sensor_msgs::JointState joint_states_message(const Outcome& outcome, const std_msgs::Header& header) {
  const auto& [scene, result, state] = outcome;
  sensor_msgs::JointState message;
  message.header = header;
  for (std::size_t i = 0; i < scene.joints.size(); ++i) {
    message.name.push_back(scene.joints[i].name);
    message.position.push_back(state.joints[i].position);
    message.velocity.push_back(joint_velocity(scene, i, state.bodies));
    message.effort.push_back(state.joints[i].effort);
  }
  return message;
}

msg::HapticsArray haptics_message(const Scene& scene, const SimulationState& state,
                                  const std::vector<Contact>& contacts, const std_msgs::Header& header) {
  msg::HapticsArray message;
  message.header = header;
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    const HandTrack& track = state.hands[slot];
    if (!track.active) continue;
    msg::HandHaptics& hand = message.hands.emplace_back();
    hand.id = track.current.id;
    hand.side = static_cast<std::uint8_t>(track.current.side);
    add_phalanges(static_cast<int>(slot), scene, contacts, hand.phalanges);
  }
  return message;
}

msg::SceneDescription scene_message(const Scene& scene, const Configuration& configuration,
                                    const std_msgs::Header& header) {
  msg::SceneDescription message;
  message.header = header;
  message.name = scene.name;
  message.model = std::string(configuration.contact_model.name);
  message.gravity = vector_message(configuration.gravity.value_or(scene.gravity));
  for (const Body& body : scene.bodies) {
    msg::SceneBody entry;
    entry.name = body.name;
    entry.fixed = body.fixed;
    entry.is_operator = body.is_operator;
    if (body.is_operator) entry.link = to_message(body.link_in_body.position);
    entry.pose = to_message(body.start);
    entry.static_friction = body.material.static_friction;
    entry.dynamic_friction = body.material.dynamic_friction;
    for (const PlacedShape& placed : body.shapes)
      entry.shapes.push_back(shape_message(placed.shape, placed.pose));
    for (const Visual& visual : body.visuals) {
      const bool own = !visual.has_color && std::holds_alternative<Mesh>(visual.shape);
      const auto& c = visual.rgba;
      entry.visuals.push_back(shape_message(visual.shape, visual.pose));
      entry.visuals.back().color = color(c[0], c[1], c[2], own ? 0.0 : c[3]);
    }
    message.bodies.push_back(std::move(entry));
  }
  return message;
}

geometry_msgs::PoseArray pose_array_message(const Hand& hand, const std_msgs::Header& header) {
  geometry_msgs::PoseArray message;
  message.header = header;
  message.poses.push_back(joint_message(hand.wrist, hand.palm.position - hand.wrist));
  for (int finger = 0; finger < kFingers; ++finger) add_finger(hand, finger, message);
  return message;
}

geometry_msgs::Wrench wrench_message(std::size_t body, const FrameResult& result,
                                     const SimulationState& state) {
  Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
  for (const Contact& contact : result.contacts) {
    if (contact.key.body != body) continue;
    force += contact.force;
    torque += (contact.point - state.bodies[body].pose.position).cross(contact.force) +
              contact.torque * contact.normal;
  }
  geometry_msgs::Wrench message;
  message.force = vector_message(force);
  message.torque = vector_message(torque);
  return message;
}

std::string held_objects(const Scene& scene, const SimulationState& state) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (!scene.bodies[i].fixed && is_held(i, state)) names.push_back(scene.bodies[i].name);
  return text::joined(names, ",");
}

double grip_force(const msg::ContactArray& message, const std::set<std::string>& bodies) {
  double normal_force = 0.0;
  for (const auto& contact : message.contacts) {
    if (bodies.count(contact.object) > 0)
      normal_force += std::max(0.0, -from_message(contact.normal).dot(from_message(contact.force)));
  }
  return 0.5 * normal_force;
}

ObjectRequest from_message(const msg::SpawnObject::Request& message) {
  ObjectRequest request;
  request.name = message.name;
  request.urdf = message.urdf;
  request.shape = message.shape;
  request.size = message.size;
  request.mass = message.mass;
  request.pose = pose_or_identity(message.pose);
  request.twist = from_message(message.twist);
  request.material = message.material;
  const auto& color = message.color;
  // A request without a colour has opacity 0. NaN is passed on.
  if (color.a != 0.0f) request.rgba = {{color.r, color.g, color.b, color.a}};
  return request;
}

ObjectRequest from_message(const msg::SpawnUrdf::Request& message) {
  ObjectRequest request;
  request.whole = true;
  request.name = message.name;
  request.urdf = message.urdf;
  request.joints = message.joints;
  request.pose = pose_or_identity(message.pose);
  return request;
}

LogEntry from_message(const msg::SimulationInput& message) {
  const auto text_of = [](const std::vector<std::uint8_t>& bytes) {
    return std::string(bytes.begin(), bytes.end());
  };
  LogEntry entry;
  if (message.kind > message.CHANGE) throw std::invalid_argument("recorded input: kind is not known");
  entry.kind = static_cast<LogEntry::Kind>(message.kind);
  entry.run = message.run;
  entry.sequence = message.sequence;
  entry.stamp = from_ros_time(message.header.stamp);
  entry.time = message.time;
  entry.expected = message.expected;
  entry.text = message.text;
  for (const auto& file : message.files) entry.files.push_back({file.name, text_of(file.bytes)});
  entry.state = text_of(message.state);
  entry.state_hash = message.state_hash;
  entry.lost = message.lost_by_queue;
  if (entry.kind != LogEntry::Kind::frame) return entry;
  try {
    entry.hands = from_message(message.hands);
    entry.hands->stamp = message.time;
  } catch (const std::invalid_argument& error) {
    entry.text = error.what();
  }
  return entry;
}

}  // namespace mrhi
