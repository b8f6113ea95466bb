#include "result_conversion.h"

#include "../simulation/contact_phase.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {

static_assert(mr_hand_interaction::Contact::IMPULSE == int(ContactPhase::impulse) &&
                  mr_hand_interaction::Contact::STICKING == int(ContactPhase::sticking) &&
                  mr_hand_interaction::Contact::SLIPPING == int(ContactPhase::slipping),
              "phases are numbered as in Contact.msg");

mr_hand_interaction::HandFrame tracked_message(const FrameResult& result, const std_msgs::Header& header) {
  mr_hand_interaction::HandFrame message;
  message.header = header;
  for (const Hand& hand : result.tracked) message.hands.push_back(to_message(hand));
  return message;
}

mr_hand_interaction::HandFrame rendered_message(const FrameResult& result, const std_msgs::Header& header) {
  mr_hand_interaction::HandFrame message;
  message.header = header;
  for (const RenderedHand& rendered : result.rendered) {
    message.hands.push_back(to_message(rendered.hand, rendered.touching));
  }
  return message;
}

mr_hand_interaction::ObjectStateArray objects_message(const Scene& scene, const FrameResult& result,
                                                      const SimulationState& state,
                                                      const std_msgs::Header& header) {
  mr_hand_interaction::ObjectStateArray message;
  message.header = header;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (body.fixed) continue;
    const Twist twist = twist_of(body, state.bodies[i]);
    mr_hand_interaction::ObjectState object;
    object.name = body.name;
    object.pose = to_message(state.bodies[i].pose);
    object.twist.linear = vector_message(twist.linear);
    object.twist.angular = vector_message(twist.angular);
    object.mass = body.mass;
    object.held = is_held(i, state);
    object.is_operator = body.is_operator;
    const std::optional<Vector3> assist = assist_force(i, result);
    object.assisted = assist.has_value();
    object.assist_force = vector_message(assist.value_or(Vector3::Zero()));
    message.objects.push_back(object);
  }
  return message;
}

mr_hand_interaction::ContactArray contacts_message(const Scene& scene, const FrameResult& result,
                                                   const SimulationState& state,
                                                   const std_msgs::Header& header) {
  mr_hand_interaction::ContactArray message;
  message.header = header;
  for (const Contact& contact : result.contacts) {
    mr_hand_interaction::Contact touch;
    touch.object = scene.bodies[contact.key.body].name;
    touch.hand_id = hand_id(contact, state);
    touch.finger = static_cast<std::uint8_t>(finger_of(contact.key.capsule));
    touch.bone = static_cast<std::uint8_t>(bone_of(contact.key.capsule));
    touch.phase = static_cast<std::uint8_t>(phase(contact));
    touch.position = to_message(contact.point);
    touch.normal = vector_message(contact.normal);
    touch.depth = contact.depth;
    touch.impulse = vector_message(contact.impulse);
    touch.force = vector_message(contact.force);
    const FrictionUse use = friction_use(contact, scene.bodies[contact.key.body].material);
    touch.normal_force = use.normal;
    touch.tangential_force = use.tangential;
    touch.friction_limit = use.limit;
    message.contacts.push_back(touch);
  }
  return message;
}

mr_hand_interaction::InteractionEvent event_message(const Scene& scene, const FrameResult& result,
                                                    const Event& event, const std_msgs::Header& header) {
  mr_hand_interaction::InteractionEvent message;
  message.header = header;
  message.kind = static_cast<std::uint8_t>(event.kind);
  if (event.body >= 0) {
    const auto body = static_cast<std::size_t>(event.body);
    message.object = scene.bodies[body].name;
    message.assisted = assist_force(body, result).has_value();
  }
  message.hand_id = event.hand_id;
  return message;
}

std::vector<geometry_msgs::TransformStamped> object_transforms(const Scene& scene,
                                                               const SimulationState& state,
                                                               const std_msgs::Header& header) {
  std::vector<geometry_msgs::TransformStamped> transforms;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Pose link = state.bodies[i].pose * scene.bodies[i].link_in_body;
    geometry_msgs::TransformStamped transform;
    transform.header = header;
    transform.child_frame_id = scene.bodies[i].name;
    transform.transform.translation = vector_message(link.position);
    transform.transform.rotation = to_message(link).orientation;
    transforms.push_back(transform);
  }
  return transforms;
}

sensor_msgs::JointState joint_states_message(const Scene& scene, const SimulationState& state,
                                             const std_msgs::Header& header) {
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

ObjectRequest from_message(const mr_hand_interaction::SpawnObject::Request& message) {
  ObjectRequest request;
  request.name = message.name;
  request.urdf = message.urdf;
  request.shape = message.shape;
  request.size = message.size;
  request.mass = message.mass;
  request.pose = from_message(message.pose);
  if (request.pose.orientation.coeffs().isZero(0.0)) request.pose.orientation.setIdentity();
  request.twist = {from_message(message.twist.linear), from_message(message.twist.angular)};
  request.material = message.material;
  const auto& color = message.color;
  // Opacity 0 is that of a request that says nothing of its colour; what is no number is not.
  if (color.a != 0.0f) request.rgba = {{color.r, color.g, color.b, color.a}};
  return request;
}

ObjectRequest from_message(const mr_hand_interaction::SpawnUrdf::Request& message) {
  ObjectRequest request;
  request.whole = true;
  request.name = message.name;
  request.urdf = message.urdf;
  request.joints = message.joints;
  request.pose = from_message(message.pose);
  if (request.pose.orientation.coeffs().isZero(0.0)) request.pose.orientation.setIdentity();
  return request;
}

}  // namespace mrhi
