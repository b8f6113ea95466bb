#include "object_request_message.h"

#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {

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
