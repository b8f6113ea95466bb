#include "inputs.h"

#include <mr_hand_interaction/HandFrame.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <iterator>
#include <map>
#include <new>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "../ros/result_messages.h"
#include "../ros/tracker_reader.h"
#include "../text/files.h"
#include "../text/text.h"
#include "../text/untrusted_input.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"

namespace mrhi {
namespace {

const char* const kLeapTopic = "/leap_motion/leap_device";
const char* const kFirstStampOff = "first stamp of another clock";
const char* const kHandFrame = "mr_hand_interaction/HandFrame";

const char* const kAllowedBag = "; allowed: a whole bag (rosbag reindex or rosbag fix may save one)";

/// Reads every message, as a replay of all topics would.
std::string read_all(const std::string& file) {
  const rosbag::Bag bag(file, rosbag::bagmode::Read);
  std::vector<std::uint8_t> bytes;
  rosbag::View view(bag);
  for (const rosbag::MessageInstance& message : view) {
    bytes.resize(message.size());
    ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    message.write(stream);
  }
  return "";
}

/// Reads the whole bag in a child process first. The bag library trusts every length in a file, reports no
/// cause of an error, and may end the process for a corrupt file. Throws BagError. Returns the file's name.
const std::string& readable(const std::string& file) {
  constexpr std::size_t kMemory = std::size_t{2} << 30, kOutput = 1 << 16;
  constexpr std::uintmax_t kMinReadRate = 5u << 19;  // bytes a second, compressed
  const std::string why = why_unreadable(file);
  if (!why.empty()) throw BagError(file + ": " + why + "; allowed: a bag that may be read");
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  try {
    const ChildLimits limits{120.0 + static_cast<double>(error ? 0 : size / kMinReadRate), kMemory, kOutput};
    run_in_child(limits, [&file] { return read_all(file); });
  } catch (const std::runtime_error& problem) {
    throw BagError(file + ": is corrupt: " + text::one_line(problem.what()) + kAllowedBag);
  }
  return file;
}

/// Call in a handler. Rethrows errors of the bag library as a BagError, and all others unchanged.
[[noreturn]] void refuse_bag(const std::string& file) {
  try {
    throw;
  } catch (const ros::Exception& error) {
    throw BagError(file + ": is corrupt: " + text::one_line(error.what()) + kAllowedBag);
  } catch (const std::bad_alloc&) {
    throw BagError(file + ": is corrupt: it asks for more memory than there is" + kAllowedBag);
  }
}

const std::set<std::string> kTypes = [] {
  std::set<std::string> types = TrackerReader::types();
  types.insert(kHandFrame);
  return types;
}();
/// Topics of other trackers' hands, which are read together.
const std::set<std::string> kPointTopics = [] {
  std::set<std::string> topics;
  for (const std::string& topic : TrackerReader::topics())
    topics.insert(topic[0] == '/' ? topic : "/" + topic);
  topics.erase(kLeapTopic);
  return topics;
}();

std::set<std::string> chosen_topics(const std::string& file, const rosbag::Bag& bag,
                                    const std::optional<std::string>& requested, const HandOptions& hands) {
  std::set<std::string> fitting;
  for (const rosbag::ConnectionInfo* connection : rosbag::View(bag).getConnections()) {
    if (kTypes.count(connection->datatype) > 0) fitting.insert(connection->topic);
  }
  const auto found = [&](const std::string& name) {
    for (const std::string& topic : {name, "/" + name}) {
      if (fitting.count(topic) > 0) return topic;
    }
    throw BagError(file + ": no topic '" + name + "' with hands; allowed: " + text::joined_or_none(fitting));
  };
  if (requested) return {found(*requested)};
  if (!hands.topics.empty()) {
    std::set<std::string> named;
    for (const auto& [topic, stands_for] : hands.topics) named.insert(found(topic));
    return named;
  }
  if (fitting.count(kLeapTopic) > 0) return {kLeapTopic};
  std::set<std::string> points;
  std::set_intersection(fitting.begin(), fitting.end(), kPointTopics.begin(), kPointTopics.end(),
                        std::inserter(points, points.end()));
  if (!points.empty()) return points;
  if (fitting.size() == 1) return fitting;
  throw BagError(file + (fitting.empty()
                             ? ": no topic has hands; allowed types: " + text::joined_or_none(kTypes)
                             : ": --topic must choose one of " + text::joined_or_none(fitting)));
}

SourceFrame refused(const std::string& reason, const std::string& detail) {
  SourceFrame frame;
  frame.reason = reason;
  frame.detail = detail;
  return frame;
}

const char* const kWorld = "world";
const char* const kLeapFrame = "leap_hands";

/// Poses of trackers in world: that of the command line, or from the bag's /tf_static and /tf received before
/// the hands. The Leap's frame has a default mount.
class DeviceFrames {
 public:
  DeviceFrames(const rosbag::Bag& bag, const std::optional<Pose>& device_in_world)
      : device_in_world_(device_in_world),
        moving_(bag, rosbag::TopicQuery(std::vector<std::string>{"/tf", "tf"})),
        next_(moving_.begin()) {
    rosbag::View fixed(bag, rosbag::TopicQuery(std::vector<std::string>{"/tf_static", "tf_static"}));
    for (const rosbag::MessageInstance& message : fixed)
      each_in(message, [&](const auto& transform) { transforms_.set_fixed(transform); });
  }

  /// Pose of the tracker of hands that were recorded at `arrival`. Throws tf2::TransformException.
  Pose pose(const std::string& frame_id, Nanoseconds stamp, const ros::Time& arrival) {
    if (device_in_world_) return *device_in_world_;
    for (; next_ != moving_.end() && next_->getTime() <= arrival; ++next_)
      each_in(*next_,
              [&](const auto& transform) { transforms_.set(transform, from_ros_time(next_->getTime())); });
    if (transforms_.connects(kWorld, frame_id)) return transforms_.pose(kWorld, frame_id, stamp);
    if (without_slash(frame_id) == kLeapFrame) return default_device_mount();
    throw tf2::LookupException(
        "frame '" + text::one_line(frame_id, 64) +
        "' has no transform to 'world'; allowed: one that the bag's /tf_static or /tf has, or "
        "--hand-transform");
  }

 private:
  template <class See>
  static void each_in(const rosbag::MessageInstance& message, const See& see) {
    const auto transforms = message.instantiate<tf2_msgs::TFMessage>();
    if (!transforms) return;
    for (const geometry_msgs::TransformStamped& transform : transforms->transforms) see(transform);
  }

  std::optional<Pose> device_in_world_;
  TransformMemory transforms_;
  rosbag::View moving_;
  rosbag::View::iterator next_;
};

/// A frame with the faults of the one that waited for it.
SourceFrame with_faults(const SourceFrame& waiting, SourceFrame frame) {
  frame.corrected.insert(frame.corrected.begin(), waiting.corrected.begin(), waiting.corrected.end());
  frame.left_out.insert(frame.left_out.begin(), waiting.left_out.begin(), waiting.left_out.end());
  return frame;
}

/// Reads a few messages ahead.
class BagInput : public FrameSource {
 public:
  BagInput(const std::string& of_file, const std::optional<std::string>& requested,
           const std::optional<Pose>& device, const HandOptions& of_hands)
      : file_(of_file),
        bag_(readable(file_), rosbag::bagmode::Read),
        topics_(chosen_topics(file_, bag_, requested, of_hands)),
        view_(bag_, rosbag::TopicQuery(std::vector<std::string>(topics_.begin(), topics_.end()))),
        options_(of_hands),
        reader_({Side::right, options_.order, options_.scale}),
        devices_(bag_, device),
        at_(view_.begin()) {
    size_ = view_.size();
  }

  std::optional<SourceFrame> next() override try {
    SourceFrame waiting;
    for (look_ahead(); !ahead_.empty(); look_ahead()) {
      SourceFrame frame = with_faults(waiting, std::move(ahead_.front().second));
      ahead_.pop_front();
      ++position_;
      if (!frame.waits) return frame;
      waiting = std::move(frame);
    }
    SourceFrame last;
    last.frame = reader_.rest();
    if (!last.frame) return std::nullopt;
    return with_faults(waiting, std::move(last));
  } catch (...) {
    refuse_bag(file_);
  }
  std::string topic() const { return text::joined_or_none(topics_); }

 private:
  SourceFrame read_tracker(const rosbag::MessageInstance& message) {
    TrackerReader::Message arrived{stands_for(message.getTopic()), message.getCallerId(),
                                   message.getDataType(),          message.getMD5Sum(),
                                   serialised_bytes(message),      from_ros_time(message.getTime())};
    return reader_.read(std::move(arrived), [&](const std::string& frame_id, Nanoseconds stamp) {
      return devices_.pose(frame_id, stamp, message.getTime());
    });
  }

  /// The name of the topic in a live node, which determines the side.
  std::string stands_for(const std::string& recorded) const {
    for (const std::string& name : {recorded, recorded.substr(1)}) {
      if (const auto found = options_.topics.find(name); found != options_.topics.end()) return found->second;
    }
    return recorded;
  }

  SourceFrame read_hand_frame(const rosbag::MessageInstance& message) {
    const auto hands = message.instantiate<mr_hand_interaction::HandFrame>();
    if (!hands) return refused("unknown version", "HandFrame with md5 " + message.getMD5Sum());
    const std::string& frame_id = hands->header.frame_id;
    if (without_slash(frame_id) != kWorld)
      return refused("wrong frame", "frame_id '" + frame_id + "'; allowed: world");
    SourceFrame frame;
    frame.frame = from_message(*hands);
    return frame;
  }

  SourceFrame read_hands(const rosbag::MessageInstance& message) {
    try {
      return message.getDataType() == kHandFrame ? read_hand_frame(message) : read_tracker(message);
    } catch (const ros::serialization::StreamOverrunException& error) {
      return refused("malformed", error.what());
    } catch (const tf2::TransformException& error) {
      return refused("no transform", text::one_line(error.what()));
    } catch (const std::invalid_argument& error) {
      return refused(JointsInput::kUnusable, error.what());
    }
  }

  /// Reads on to the third message of a stream, which shows if the first has a stamp of another clock.
  void look_ahead() {
    constexpr std::size_t kMessages = 12;
    while (at_ != view_.end() && ahead_.size() < kMessages) {
      const std::string stream = at_->getCallerId() + " " + at_->getTopic();
      SourceFrame frame = read_hands(*at_);
      frame.arrival = from_ros_time(at_->getTime());
      ++at_;
      const auto first =
          std::find_if(ahead_.begin(), ahead_.end(), [&](const auto& one) { return one.first == stream; });
      if (frame.first_was_off && position_ + ahead_.size() < kMessages && first != ahead_.end())
        first->second = refused(kFirstStampOff, "the first frame of " + stream);
      ahead_.emplace_back(stream, std::move(frame));
    }
  }

  std::string file_;
  rosbag::Bag bag_;
  std::set<std::string> topics_;
  rosbag::View view_;
  HandOptions options_;
  TrackerReader reader_;
  DeviceFrames devices_;
  rosbag::View::iterator at_;
  std::deque<std::pair<std::string, SourceFrame>> ahead_;  // with their streams
};

using mr_hand_interaction::SimulationInput;

/// Entries by run and sequence. The bag's own order differs if recorded time goes back, as in a looping bag.
class BagLog : public LogSource {
 public:
  BagLog(const std::string& file, const std::string& topic)
      : file_(file), bag_(file, rosbag::bagmode::Read), view_(bag_, rosbag::TopicQuery(topic)) {
    std::map<std::uint64_t, std::size_t> runs;
    for (const rosbag::MessageInstance& message : view_) {
      const auto input = message.instantiate<SimulationInput>();
      if (!input) continue;
      const std::size_t run = runs.emplace(input->run, runs.size()).first->second;
      order_.emplace(std::make_tuple(run, input->sequence), message);
    }
    at_ = order_.begin();
    size_ = order_.size();
  }

  std::optional<LogEntry> next() override try {
    if (at_ == order_.end()) return std::nullopt;
    const auto message = (at_++)->second.instantiate<SimulationInput>();
    ++position_;
    return from_message(*message);
  } catch (...) {
    refuse_bag(file_);
  }

 private:
  std::string file_;
  rosbag::Bag bag_;
  rosbag::View view_;
  std::multimap<std::tuple<std::size_t, std::uint64_t>, rosbag::MessageInstance> order_;
  decltype(order_)::const_iterator at_;
};

/// The topic of the log, or the reason why there is none.
OpenLog find_log(const std::string& file) {
  using Traits = ros::message_traits::MD5Sum<SimulationInput>;
  const rosbag::Bag bag(file, rosbag::bagmode::Read);
  OpenLog found;
  found.why_not = "it has no simulation_input";
  for (const rosbag::ConnectionInfo* connection : rosbag::View(bag).getConnections()) {
    if (connection->datatype != "mr_hand_interaction/SimulationInput") continue;
    if (connection->md5sum == Traits::value()) {
      found.topic = connection->topic;
    } else {
      found.why_not = connection->topic + " is of another version of this package";
    }
  }
  return found;
}

}  // namespace

ReplayInput open_bag(const std::string& file, const std::optional<std::string>& topic,
                     const std::optional<Pose>& device_in_world, const HandOptions& hands) {
  try {
    auto bag = std::make_unique<BagInput>(file, topic, device_in_world, hands);
    const std::string read = bag->topic();
    return {std::move(bag), read};
  } catch (...) {
    refuse_bag(file);
  }
}

OpenLog open_log(const ReplayArguments& arguments) {
  const std::string& file = arguments.input;
  try {
    OpenLog log = find_log(readable(file));
    if (log.topic.empty()) return log;
    log.source = std::make_unique<BagLog>(file, log.topic);
    if (log.source->size() == 0) log.source.reset();
    return log;
  } catch (...) {
    refuse_bag(file);
  }
}

}  // namespace mrhi
