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
#include "node.h"
#include "tracker_reader.h"
#include "tracker_transforms.h"
#include "update_diagnostics.h"

namespace mrhi {
namespace {

constexpr int kQueue = 10;

const char* const kStampNotIncreasing = "stamp repeats or goes back";
const char* const kNoTransform = "no transform";

std::vector<std::string> known_reasons() {
  std::vector<std::string> reasons{JointsInput::kUnusable, kStampNotIncreasing, JointsInput::kNoStamp,
                                   kNoTransform, TrackerTransforms::kReason};
  for (auto kind : {DecodeError::Kind::unknown_version, DecodeError::Kind::malformed,
                    DecodeError::Kind::wrong_count, DecodeError::Kind::unknown_order})
    reasons.emplace_back(DecodeError(kind, "").reason());
  return reasons;
}

Side parse_side(const std::string& name) {
  if (name == "left") return Side::left;
  if (name == "right") return Side::right;
  throw std::invalid_argument("parameter side: '" + name + "' is neither left nor right");
}

TrackerReader::Options options_from(const ros::NodeHandle& parameters) {
  TrackerReader::Options options;
  std::string side = "right";
  read_parameter(parameters, "side", "a string", side);
  options.side = parse_side(side);
  read_parameter(parameters, "order", "a string", options.order);
  read_parameter(parameters, "scale", "a number", options.scale);
  return options;
}

}  // namespace

struct HandTracking::Impl {
  Impl(const ros::NodeHandle& node, const ros::NodeHandle& parameters);

  using Event = ros::MessageEvent<const topic_tools::ShapeShifter>;
  /// A topic that may carry any tracker's message.
  struct Source {
    std::string topic;  ///< before remapping
    ros::Subscriber subscriber;
    bool seen = false;  ///< a publisher, by the present subscription
  };

  void subscribe(Source& source);
  /// roscpp keeps a topic to the type that it met first, so a publisher of another type or version needs a
  /// new subscription.
  void accept_other_types();
  void take(Source& source, const Event& event);
  void publish(const HandFrame& frame, const ros::Time& receipt);
  bool accept_stamp(Nanoseconds stamp);

  Sink sink_;
  std::string fixed_frame_;
  TrackerReader reader_;
  StampCheck stamps_;
  InputStatistics statistics_;
  SequenceWatch sequences_;

  ros::NodeHandle node_;
  TrackerTransforms transforms_;
  ros::Publisher publisher_;
  std::vector<Source> sources_;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer timer_;
};

HandTracking::Impl::Impl(const ros::NodeHandle& node, const ros::NodeHandle& parameters)
    : fixed_frame_(parameters.param<std::string>("fixed_frame", "world")),
      reader_(options_from(parameters)),
      statistics_(known_reasons(), {JointsInput::corrections().begin(), JointsInput::corrections().end()}),
      node_(node),
      transforms_(
          node_, [this](const char* reason, const std::string& what) { statistics_.rejected(reason, what); }),
      diagnostics_(node, parameters, ros::this_node::getName()) {
  publisher_ = node_.advertise<mr_hand_interaction::HandFrame>("hand_frame", kQueue);
  for (const std::string& topic : TrackerReader::topics()) sources_.push_back({topic, {}});
  for (Source& source : sources_) subscribe(source);
  diagnostics_.setHardwareID("hand tracker");
  diagnostics_.add("hand input", [this](auto& status) { statistics_.report(status); });
  timer_ = node_.createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) {
    update(diagnostics_);
    accept_other_types();
  });
}

void HandTracking::Impl::subscribe(Source& source) {
  source.seen = false;
  source.subscriber = node_.subscribe<topic_tools::ShapeShifter>(
      source.topic, kQueue,
      boost::function<void(const Event&)>([this, &source](const Event& event) { take(source, event); }),
      nullptr, ros::TransportHints().tcpNoDelay());
}

void HandTracking::Impl::accept_other_types() {
  for (Source& source : sources_) {
    const bool connected = source.subscriber.getNumPublishers() > 0;
    source.seen = source.seen || connected;
    if (!source.seen || connected) continue;
    source.subscriber.shutdown();
    subscribe(source);
  }
}

void HandTracking::Impl::take(Source& source, const Event& event) {
  const topic_tools::ShapeShifter& message = *event.getConstMessage();
  source.seen = true;
  TrackerReader::Message arrived{source.topic,
                                 event.getPublisherName(),
                                 message.getDataType(),
                                 message.getMD5Sum(),
                                 std::vector<std::uint8_t>(message.size()),
                                 from_ros_time(event.getReceiptTime())};
  ros::serialization::OStream stream(arrived.bytes.data(), message.size());
  message.write(stream);
  std::optional<std::uint32_t> sequence;
  SourceFrame frame;
  try {
    frame = reader_.read(
        std::move(arrived),
        [this](const std::string& frame_id, Nanoseconds stamp) {
          return transforms_.pose(fixed_frame_, frame_id, stamp);
        },
        &sequence);
  } catch (const tf2::TransformException& error) {
    frame.reason = kNoTransform;
    frame.detail = error.what();
  }
  if (sequence)
    statistics_.lost(sequences_.missing(event.getPublisherName() + " " + source.topic, *sequence));
  for (const auto& [kind, what] : frame.corrected) statistics_.corrected(kind, what);
  for (const std::string& defect : frame.left_out) statistics_.rejected(JointsInput::kUnusable, defect);
  if (!frame.reason.empty()) statistics_.rejected(frame.reason, frame.detail);
  if (frame.frame) publish(*frame.frame, event.getReceiptTime());
}

void HandTracking::Impl::publish(const HandFrame& frame, const ros::Time& receipt) {
  if (!accept_stamp(frame.stamp)) return;
  const auto message =
      boost::make_shared<const mr_hand_interaction::HandFrame>(to_message(frame, fixed_frame_));
  if (sink_) sink_(*message, receipt);
  publisher_.publish(message);
  statistics_.taken(to_seconds(from_ros_time(ros::Time::now()) - frame.stamp));
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
