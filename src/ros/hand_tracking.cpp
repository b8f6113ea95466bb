#include "mr_hand_interaction/ros/hand_tracking.h"

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>
#include <topic_tools/shape_shifter.h>

#include <boost/make_shared.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "input_statistics.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/leap_human.h"
#include "mr_hand_interaction/stamp_check.h"
#include "mr_hand_interaction/tracking/hand_pairs.h"
#include "mr_hand_interaction/tracking/joint_gaps.h"
#include "tracker_messages.h"
#include "tracker_transforms.h"
#include "update_diagnostics.h"

namespace mrhi {
namespace {

constexpr int kQueue = 10;

const char* const kUnusableHand = "unusable hand";
const char* const kStampNotIncreasing = "stamp repeats or goes back";
const char* const kNoStamp = "stamp out of range";
const char* const kNoTransform = "no transform";

std::vector<std::string> known_reasons() {
  std::vector<std::string> reasons{kUnusableHand, kStampNotIncreasing, kNoStamp, kNoTransform,
                                   TrackerTransforms::kReason};
  for (auto kind :
       {DecodeError::Kind::unknown_version, DecodeError::Kind::malformed, DecodeError::Kind::wrong_count})
    reasons.emplace_back(DecodeError(kind, "").reason());
  return reasons;
}

Side parse_side(const std::string& name) {
  if (name == "left") return Side::left;
  if (name == "right") return Side::right;
  throw std::invalid_argument("parameter side: '" + name + "' is neither left nor right");
}

}  // namespace

struct HandTracking::Impl {
  Impl(const ros::NodeHandle& node, const ros::NodeHandle& parameters);

  using LeapEvent = ros::MessageEvent<const topic_tools::ShapeShifter>;

  void subscribe_leap();
  /// roscpp keeps a topic to the version that it met first, so a driver of another version needs a new
  /// subscription.
  void accept_other_versions();
  void take_leap(const LeapEvent& event);
  template <class Tracker>
  void subscribe_points(const std::string& topic);
  void take_points(const TrackedPoints& tracked, const std::optional<Side>& of_topic,
                   const ros::Time& receipt);
  /// Nothing if it cannot be used.
  std::optional<HandFrame> place(JointsFrame frame, const std::string& frame_id, const ros::Time& receipt);
  void take(const std::optional<HandFrame>& frame, const ros::Time& receipt);

  bool accept_stamp(Nanoseconds stamp);

  Sink sink_;
  std::string fixed_frame_;
  Side side_ = Side::right;
  StampCheck stamps_;
  JointGaps gaps_;
  HandPairs pairs_;
  bool leap_seen_ = false;  ///< a driver, by the present subscription
  InputStatistics statistics_;
  SequenceWatch sequences_;

  ros::NodeHandle node_;
  TrackerTransforms transforms_;
  ros::Publisher publisher_;
  ros::Subscriber leap_subscriber_;
  std::vector<ros::Subscriber> point_subscribers_;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer timer_;
};

HandTracking::Impl::Impl(const ros::NodeHandle& node, const ros::NodeHandle& parameters)
    : fixed_frame_(parameters.param<std::string>("fixed_frame", "world")),
      side_(parse_side(parameters.param<std::string>("side", "right"))),
      statistics_(known_reasons()),
      node_(node),
      transforms_(
          node_, [this](const char* reason, const std::string& what) { statistics_.rejected(reason, what); }),
      diagnostics_(node, parameters, ros::this_node::getName()) {
  publisher_ = node_.advertise<mr_hand_interaction::HandFrame>("hand_frame", kQueue);
  subscribe_leap();
  for_each_tracker([this](auto tracker) {
    for (const std::string& topic : topics_of(tracker)) subscribe_points<decltype(tracker)>(topic);
  });
  diagnostics_.setHardwareID("hand tracker");
  diagnostics_.add("hand input", [this](auto& status) { statistics_.report(status); });
  timer_ = node_.createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) {
    update(diagnostics_);
    accept_other_versions();
  });
}

void HandTracking::Impl::subscribe_leap() {
  leap_seen_ = false;
  leap_subscriber_ = node_.subscribe<topic_tools::ShapeShifter>(
      "/leap_motion/leap_device", kQueue,
      boost::function<void(const LeapEvent&)>([this](const LeapEvent& event) { take_leap(event); }), nullptr,
      ros::TransportHints().tcpNoDelay());
}

template <class Tracker>
void HandTracking::Impl::subscribe_points(const std::string& topic) {
  using Message = typename Tracker::Message;
  using Event = ros::MessageEvent<const Message>;
  const std::optional<Side> of_topic = side_of_topic(topic);
  point_subscribers_.push_back(node_.subscribe<Message>(
      topic, kQueue, boost::function<void(const Event&)>([this, of_topic, topic](const Event& event) {
        const TrackedPoints tracked = Tracker::read(*event.getConstMessage());
        statistics_.lost(sequences_.missing(event.getPublisherName() + " " + topic, tracked.header.seq));
        take_points(tracked, of_topic, event.getReceiptTime());
      }),
      nullptr, ros::TransportHints().tcpNoDelay()));
}

void HandTracking::Impl::accept_other_versions() {
  const bool connected = leap_subscriber_.getNumPublishers() > 0;
  leap_seen_ = leap_seen_ || connected;
  if (!leap_seen_ || connected) return;
  leap_subscriber_.shutdown();
  subscribe_leap();
}

void HandTracking::Impl::take_leap(const LeapEvent& event) {
  const topic_tools::ShapeShifter& message = *event.getConstMessage();
  leap_seen_ = true;
  try {
    LeapFrame frame = read_leap(message);
    statistics_.lost(sequences_.missing(event.getPublisherName(), frame.sequence));
    take(place(std::move(frame.joints), frame.frame_id, event.getReceiptTime()), event.getReceiptTime());
  } catch (const DecodeError& error) {
    statistics_.rejected(error.reason(), message.getDataType() + ": " + error.what());
  }
}

void HandTracking::Impl::take_points(const TrackedPoints& tracked, const std::optional<Side>& of_topic,
                                     const ros::Time& receipt) {
  const std::string& frame_id = tracked.header.frame_id;
  const Side side = (of_topic ? of_topic : side_of_frame(frame_id)).value_or(side_);
  try {
    JointsFrame joints = joints_from_points(tracked, side);
    if (joints.stamp == 0) joints.stamp = from_ros_time(receipt);
    gaps_.fill(joints);
    const auto frame = place(std::move(joints), frame_id, receipt);
    take(frame && !has_both_hands(tracked) ? pairs_.take(side, *frame) : frame, receipt);
  } catch (const DecodeError& error) {
    statistics_.rejected(error.reason(), error.what());
  }
}

std::optional<HandFrame> HandTracking::Impl::place(JointsFrame joints, const std::string& frame_id,
                                                   const ros::Time& receipt) {
  if (joints.stamp == 0) joints.stamp = from_ros_time(receipt);
  if (joints.stamp > StampCheck::kLatest) {
    statistics_.rejected(kNoStamp, std::to_string(joints.stamp / 1'000'000'000) + " s");
    return std::nullopt;
  }
  try {
    const Pose device =
        joints.hands.empty() ? Pose{} : transforms_.pose(fixed_frame_, frame_id, joints.stamp);
    std::vector<std::string> defects;
    const auto frame = complete_frame(joints, device, defects);
    for (const std::string& found : defects) statistics_.rejected(kUnusableHand, found);
    return frame;
  } catch (const tf2::TransformException& error) {
    statistics_.rejected(kNoTransform, error.what());
    return std::nullopt;
  }
}

void HandTracking::Impl::take(const std::optional<HandFrame>& frame, const ros::Time& receipt) {
  if (!frame || !accept_stamp(frame->stamp)) return;
  const auto message =
      boost::make_shared<const mr_hand_interaction::HandFrame>(to_message(*frame, fixed_frame_));
  if (sink_) sink_(*message, receipt);
  publisher_.publish(message);
  statistics_.taken(to_seconds(from_ros_time(ros::Time::now()) - frame->stamp));
}

/// What is far from its stream goes on to the simulation, which sees what comes after it, as this does not
/// for those who listen to hand_frame.
bool HandTracking::Impl::accept_stamp(Nanoseconds stamp) {
  const Nanoseconds last = stamps_.last;
  const StampVerdict verdict = stamps_.check(stamp);
  if (verdict == StampVerdict::late) {
    statistics_.rejected(kStampNotIncreasing, std::to_string(to_seconds(stamp)) + " s after " +
                                                  std::to_string(to_seconds(last)) + " s");
    return false;
  }
  if (verdict == StampVerdict::restart) transforms_.clear();
  return true;
}

HandTracking::HandTracking(const ros::NodeHandle& node, const ros::NodeHandle& parameters)
    : impl_(std::make_unique<Impl>(node, parameters)) {}

HandTracking::~HandTracking() = default;

void HandTracking::pass_to(Sink sink) {
  impl_->sink_ = std::move(sink);
}

std::uint64_t HandTracking::lost() const {
  return impl_->statistics_.lost();
}

}  // namespace mrhi
