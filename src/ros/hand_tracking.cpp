#include "mr_hand_interaction/ros/hand_tracking.h"

#include <mr_hand_interaction/HandFrame.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <tf2_msgs/TFMessage.h>

#include <boost/make_shared.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "input_statistics.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/stamp_check.h"
#include "node.h"
#include "tracker_reader.h"

namespace mrhi {

/// The bytes of any message. A topic_tools::ShapeShifter would also copy the definition each time.
struct AnyMessage {
  std::vector<std::uint8_t> bytes;
};

}  // namespace mrhi

namespace ros {
namespace message_traits {
template <>
struct MD5Sum<mrhi::AnyMessage> {
  static const char* value() { return "*"; }
};
template <>
struct DataType<mrhi::AnyMessage> : MD5Sum<mrhi::AnyMessage> {};
}  // namespace message_traits
namespace serialization {
template <>
struct Serializer<mrhi::AnyMessage> {
  template <typename Stream>
  static void read(Stream& stream, mrhi::AnyMessage& message) {
    const std::uint8_t* const begin = stream.getData();
    message.bytes.assign(begin, begin + stream.getLength());
  }
};
}  // namespace serialization
}  // namespace ros

namespace mrhi {
namespace {

constexpr int kQueue = 10;

const char* const kStampNotIncreasing = "stamp repeats or goes back";
const char* const kNoTransform = "no transform";

/// Parameters of the node on the parameter server.
struct Parameters {
  explicit Parameters(const ros::NodeHandle& node) {
    NodeParameters known;
    known.text("fixed_frame", fixed_frame).text("order", reader.order);
    known.choice<Side>("side", {{"left", Side::left}, {"right", Side::right}}, reader.side);
    known.number("scale", 1e-6, 1e6, reader.scale, ", metres per unit of the tracker").read(node);
  }

  std::string fixed_frame = "world";
  TrackerReader::Options reader;
};

}  // namespace

/// A TransformMemory of /tf and /tf_static. Messages of /tf wait in a queue of their own until they are
/// needed: this node itself sends one for each frame, which must not wake the thread that waits for hands.
class TrackerTransforms : public TransformMemory {
 public:
  static constexpr const char* kReason = "unusable transform";

  TrackerTransforms(ros::NodeHandle node, InputStatistics& statistics) : statistics_(statistics) {
    constexpr std::uint32_t kMaxFixed = 100, kMaxWaiting = 1000;  // a second of messages, the longest wait
    ros::NodeHandle later(node);
    later.setCallbackQueue(&waiting_);
    moving_ = later.subscribe("/tf", kMaxWaiting, &TrackerTransforms::take, this);
    fixed_ = node.subscribe("/tf_static", kMaxFixed, &TrackerTransforms::take_fixed, this);
  }

  /// Takes the messages that wait.
  void take_waiting() { waiting_.callAvailable(); }

 private:
  using Arrival = ros::MessageEvent<const tf2_msgs::TFMessage>;

  /// This node's own transforms are of objects, which carry no tracker.
  void take(const Arrival& arrival) {
    if (arrival.getPublisherName() == ros::this_node::getName()) return;
    for (const auto& transform : arrival.getConstMessage()->transforms) {
      const std::string why = set(transform, from_ros_time(arrival.getReceiptTime()));
      if (!why.empty()) statistics_.rejected(kReason, why);
    }
  }

  void take_fixed(const tf2_msgs::TFMessage& message) {
    for (const auto& transform : message.transforms) set_fixed(transform);
  }

  InputStatistics& statistics_;
  ros::CallbackQueue waiting_;
  ros::Subscriber moving_, fixed_;
};

std::vector<std::string> known_reasons() {
  std::vector<std::string> reasons{JointsInput::kUnusable,    kStampNotIncreasing, JointsInput::kNoStamp,
                                   JointsInput::kStray,       JointsInput::kBurst, kNoTransform,
                                   TrackerTransforms::kReason};
  for (auto kind : {DecodeError::Kind::unknown_version, DecodeError::Kind::malformed,
                    DecodeError::Kind::wrong_count, DecodeError::Kind::unknown_order})
    reasons.emplace_back(DecodeError(kind, "").reason());
  return reasons;
}

struct HandTracking::Impl {
  Impl(const ros::NodeHandle& node, const ros::NodeHandle& private_node, const Parameters& parameters)
      : fixed_frame_(parameters.fixed_frame),
        reader_(parameters.reader),
        statistics_(node, private_node, "hand tracker", "hand input", known_reasons(),
                    {JointsInput::corrections().begin(), JointsInput::corrections().end()}),
        node_(node),
        transforms_(node_, statistics_) {
    publisher_ = node_.advertise<mr_hand_interaction::HandFrame>("hand_frame", kQueue);
    for (const std::string& topic : TrackerReader::topics()) sources_.push_back({topic, {}});
    for (Source& source : sources_) subscribe(source);
    statistics_.each_second([this] {
      transforms_.take_waiting();
      accept_other_types();
    });
  }

  using Event = ros::MessageEvent<AnyMessage>;
  /// A topic that may carry any tracker's message.
  struct Source {
    std::string topic;  ///< before remapping
    ros::Subscriber subscriber;
    bool seen = false;  ///< the present subscription has seen a publisher
  };

  void subscribe(Source& source) {
    source.seen = false;
    source.subscriber = node_.subscribe<AnyMessage>(
        source.topic, kQueue,
        boost::function<void(const Event&)>([this, &source](const Event& event) { take(source, event); }),
        nullptr, ros::TransportHints().tcpNoDelay());
  }

  /// roscpp fixes the type at the first message: another type or version needs a new subscription.
  void accept_other_types() {
    for (Source& source : sources_) {
      const bool connected = source.subscriber.getNumPublishers() > 0;
      source.seen = source.seen || connected;
      if (!source.seen || connected) continue;
      source.subscriber.shutdown();
      subscribe(source);
    }
  }

  void take(Source& source, const Event& event) {
    source.seen = true;
    ros::M_string& connection = event.getConnectionHeader();
    const std::string& publisher = connection["callerid"];
    TrackerReader::Message arrived{source.topic,
                                   publisher,
                                   connection["type"],
                                   connection["md5sum"],
                                   std::move(event.getMessage()->bytes),
                                   from_ros_time(event.getReceiptTime())};
    std::optional<std::uint32_t> sequence;
    SourceFrame frame;
    try {
      frame = reader_.read(
          std::move(arrived),
          [this](const std::string& frame_id, Nanoseconds stamp) {
            transforms_.take_waiting();
            return transforms_.pose(fixed_frame_, frame_id, stamp);
          },
          &sequence);
    } catch (const tf2::TransformException& error) {
      frame.reason = kNoTransform;
      frame.detail = error.what();
    }
    if (sequence) statistics_.lost(sequences_.missing(publisher + " " + source.topic, *sequence));
    for (const auto& [kind, what] : frame.corrected) statistics_.corrected(kind, what);
    for (const std::string& defect : frame.left_out) statistics_.rejected(JointsInput::kUnusable, defect);
    if (!frame.reason.empty()) statistics_.rejected(frame.reason, frame.detail);
    if (frame.frame) publish(*frame.frame, event.getReceiptTime());
  }

  void publish(const HandFrame& frame, const ros::Time& receipt) {
    if (!accept_stamp(frame.stamp)) return;
    if (sink_) sink_(frame, fixed_frame_, receipt);
    if (publisher_.getNumSubscribers() > 0)
      publisher_.publish(
          boost::make_shared<const mr_hand_interaction::HandFrame>(to_message(frame, fixed_frame_)));
    statistics_.taken(to_seconds(from_ros_time(ros::Time::now()) - frame.stamp));
  }

  /// The simulation gets stray stamps too, as it checks the following ones; hand_frame does not.
  bool accept_stamp(Nanoseconds stamp) {
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

  Sink sink_;
  std::string fixed_frame_;
  TrackerReader reader_;
  StampCheck stamps_;
  NodeDiagnostics statistics_;
  SequenceWatch sequences_;

  ros::NodeHandle node_;
  TrackerTransforms transforms_;
  ros::Publisher publisher_;
  std::vector<Source> sources_;
};

HandTracking::HandTracking(const ros::NodeHandle& node, const ros::NodeHandle& private_node)
    : impl_(std::make_unique<Impl>(node, private_node, Parameters(private_node))) {}

HandTracking::~HandTracking() = default;

void HandTracking::pass_to(Sink sink) {
  impl_->sink_ = std::move(sink);
}

std::uint64_t HandTracking::lost() const {
  return impl_->statistics_.lost();
}

}  // namespace mrhi
