#include "mount_calibration.h"

#include <ros/callback_queue.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace mrhi {
namespace {

constexpr std::size_t kIndexTip = capsule_index(1, 3);
constexpr int kQueue = 100;

/// The capsule that ends in the index finger's tip, in the device's frame; nothing if no hand of the side has
/// one.
std::optional<Capsule> index_tip(const JointsFrame& joints, Side side) {
  std::vector<std::string> defects;
  const auto frame = complete_frame(joints, Pose{}, defects);
  if (!frame) return {};
  const auto hand = std::find_if(frame->hands.begin(), frame->hands.end(),
                                 [side](const Hand& found) { return found.side == side; });
  if (hand == frame->hands.end() || !hand->has(kIndexTip)) return {};
  return hand->capsules[kIndexTip];
}

}  // namespace

MountCalibration::MountCalibration(const ros::NodeHandle& node, const std::string& topic, Side side,
                                   TouchRecorder recorder, std::ostream& out)
    : node_(node), topic_(topic), side_(side), recorder_(std::move(recorder)), out_(out) {
  subscriber_ = node_.subscribe<topic_tools::ShapeShifter>(
      topic_, kQueue, [this](const topic_tools::ShapeShifter::ConstPtr& message) { take(*message); });
}

void MountCalibration::run() {
  const ros::WallTimer watch = node_.createWallTimer(
      ros::WallDuration(5.0), [this](const ros::WallTimerEvent&) { warn_of_no_frames(); });
  ask();
  while (node_.ok() && !recorder_.done())
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
}

void MountCalibration::take(const topic_tools::ShapeShifter& message) {
  try {
    const LeapHumanDecoder::Frame frame = reader_.read(message);
    device_frame_ = frame.frame_id;
    const auto tip = index_tip(frame.joints, side_);
    if (!tip) return recorder_.lose();
    if (recorder_.add(tip->end, tip->radius)) ask();
  } catch (const DecodeError& error) {
    ROS_WARN_THROTTLE(5.0, "%s: %s", message.getDataType().c_str(), error.what());
  }
}

void MountCalibration::ask() const {
  if (recorder_.taken() > 0) out_ << "taken\n";
  if (!recorder_.done()) {
    const TouchedPoint& next = recorder_.points()[recorder_.taken()];
    out_ << "point " << recorder_.taken() + 1 << " of " << recorder_.points().size() << ": touch "
         << next.name << " (" << next.world.x() << ' ' << next.world.y() << ' ' << next.world.z()
         << ") with the tip of the index finger and hold still\n";
  }
  out_.flush();
}

void MountCalibration::warn_of_no_frames() const {
  if (device_frame_.empty()) ROS_WARN("nothing has come on %s", node_.resolveName(topic_).c_str());
}

}  // namespace mrhi
