#include "placing.h"

#include <visualization_msgs/InteractiveMarker.h>

#include <algorithm>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::InteractiveMarker;
using visualization_msgs::InteractiveMarkerControl;
using Feedback = visualization_msgs::InteractiveMarkerFeedback;

/// rviz repeats itself four times a second while the mouse is down.
const ros::WallDuration kSilence(1.0);
constexpr double kRoom = 2.6;  // size of the handles, in radii of the body

InteractiveMarkerControl control(const char* name, const Vector3& axis, std::uint8_t mode) {
  InteractiveMarkerControl control;
  const Quaternion turn = Quaternion::FromTwoVectors(Vector3::UnitX(), axis);
  control.name = name;
  control.interaction_mode = mode;
  control.orientation = to_message(Pose{Vector3::Zero(), turn}).orientation;
  return control;
}

/// Arrows and rings along and about the body's axes.
InteractiveMarker marker_of(const Body& body, const Pose& pose, const std::string& frame) {
  InteractiveMarker marker;
  marker.header.frame_id = frame;
  marker.name = body.name;
  marker.scale = static_cast<float>(kRoom * body.bounding_radius);
  marker.pose = to_message(pose);
  const struct {
    const char *move, *turn;
    Vector3 axis;
  } axes[] = {{"move x", "turn x", Vector3::UnitX()},
              {"move y", "turn y", Vector3::UnitY()},
              {"move z", "turn z", Vector3::UnitZ()}};
  for (const auto& a : axes) {
    marker.controls.push_back(control(a.move, a.axis, InteractiveMarkerControl::MOVE_AXIS));
    marker.controls.push_back(control(a.turn, a.axis, InteractiveMarkerControl::ROTATE_AXIS));
  }
  return marker;
}

}  // namespace

Placing::Placing(const ros::NodeHandle& private_node, const std::string& fixed_frame)
    : topic_(private_node.resolveName("place")), fixed_frame_(fixed_frame) {}

void Placing::turn(bool on, const Simulation& simulation) {
  if (on == (server_ != nullptr)) return;
  server_ = on ? std::make_unique<interactive_markers::InteractiveMarkerServer>(topic_) : nullptr;
  if (on) renew(simulation);
  drags_.clear();
}

void Placing::renew(const Simulation& simulation) {
  if (!server_) return;
  server_->clear();
  for (std::size_t b = 0; b < simulation.scene().bodies.size(); ++b) {
    const Body& body = simulation.scene().bodies[b];
    if (body.fixed || body.is_operator) continue;
    server_->insert(
        marker_of(body, simulation.state().bodies[b].pose, fixed_frame_),
        [this](const visualization_msgs::InteractiveMarkerFeedbackConstPtr& feedback) { take(*feedback); });
  }
  server_->applyChanges();
}

void Placing::follow(const Simulation& simulation) {
  if (!server_) return;
  for (std::size_t b = 0; b < simulation.scene().bodies.size(); ++b) {
    const Body& body = simulation.scene().bodies[b];
    if (!body.fixed && !body.is_operator)
      server_->setPose(body.name, to_message(simulation.state().bodies[b].pose));
  }
  server_->applyChanges();
}

std::map<std::string, Pose> Placing::dragged() {
  std::map<std::string, Pose> poses;
  if (!server_) return poses;
  const ros::WallTime now = ros::WallTime::now();
  for (auto drag = drags_.begin(); drag != drags_.end();) {
    if (now - drag->second.heard > kSilence) {
      drag = drags_.erase(drag);
      continue;
    }
    poses[drag->first] = drag->second.pose;
    ++drag;
  }
  return poses;
}

void Placing::take(const Feedback& feedback) {
  const auto drag = drags_.find(feedback.marker_name);
  if (feedback.event_type == Feedback::MOUSE_UP && drag != drags_.end()) drags_.erase(drag);
  if (feedback.event_type == Feedback::KEEP_ALIVE && drag != drags_.end())
    drag->second.heard = ros::WallTime::now();
  Pose pose = from_message(feedback.pose);
  pose.orientation.normalize();
  const bool usable = pose.position.allFinite() && pose.orientation.coeffs().allFinite();
  if (feedback.event_type == Feedback::POSE_UPDATE && usable)
    drags_[feedback.marker_name] = {pose, ros::WallTime::now()};
}

}  // namespace mrhi
