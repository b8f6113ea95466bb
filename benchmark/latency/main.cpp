// Latency from a hand's message to its rendered view, and the node's processor time, compared with a relay
// that only forwards messages: see docs/reliability.md.
#include <ros/network.h>
#include <ros/ros.h>
#include <topic_tools/shape_shifter.h>
#include <unistd.h>
#include <xmlrpcpp/XmlRpcClient.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "ros/leap_human_publisher.h"

namespace {

using topic_tools::ShapeShifter;
using Clock = std::chrono::steady_clock;

constexpr double kWarmUp = 8.0;  // excluded, in which rviz starts [s]
constexpr std::uint32_t kQueue = 10;

/// Forwards messages.
class Relay {
 public:
  explicit Relay(ros::NodeHandle& node) : node_(node) {
    in_ = node_.subscribe("relay_in", kQueue, &Relay::take, this, ros::TransportHints().tcpNoDelay());
  }

 private:
  void take(const ShapeShifter::ConstPtr& message) {
    if (!out_) out_ = message->advertise(node_, "relay_out", kQueue);
    out_.publish(message);
  }

  ros::NodeHandle& node_;
  ros::Subscriber in_;
  ros::Publisher out_;
};

/// Round trips: times of sending and durations.
class Track {
 public:
  /// `counted`: not in the warm-up.
  void sent(std::uint64_t stamp, bool counted) {
    const std::lock_guard<std::mutex> lock(mutex_);
    sent_[stamp] = {Clock::now(), counted};
  }
  void arrived(std::uint64_t stamp, Clock::time_point when, std::size_t bytes) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = sent_.find(stamp);
    if (found == sent_.end()) return;
    if (found->second.counted)
      times_.push_back(std::chrono::duration<double, std::milli>(when - found->second.when).count());
    bytes_ = std::max(bytes_, bytes);
    sent_.erase(found);
  }
  void report(const char* name, std::size_t frames) {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::sort(times_.begin(), times_.end());
    std::printf("| %s | %zu of %zu | %.1f | %.3f | %.3f | %.3f |\n", name, times_.size(), frames,
                1e-3 * static_cast<double>(bytes_), quantile(0.5), quantile(0.99),
                times_.empty() ? 0.0 : times_.back());
  }
  double quantile(double q) const {
    if (times_.empty()) return 0.0;
    return times_[std::min(times_.size() - 1,
                           static_cast<std::size_t>(q * static_cast<double>(times_.size())))];
  }

 private:
  struct Sent {
    Clock::time_point when;
    bool counted;
  };
  std::mutex mutex_;
  std::map<std::uint64_t, Sent> sent_;
  std::vector<double> times_;  // [ms]
  std::size_t bytes_ = 0;
};

/// Stamp of the first header, at `offset`, in a serialised message.
std::uint64_t stamp_in(const ShapeShifter& message, std::size_t offset) {
  std::vector<std::uint8_t> bytes(message.size());
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  message.write(stream);
  std::uint32_t time[2] = {0, 0};
  const std::size_t after_sequence = offset + 4;
  if (bytes.size() >= after_sequence + sizeof time)
    std::memcpy(time, bytes.data() + after_sequence, sizeof time);
  return std::uint64_t(time[0]) * 1000000000u + time[1];
}

/// Process of a node, from the node itself.
int process_of(const std::string& node) {
  XmlRpc::XmlRpcValue request, response, uri;
  request[0] = request[1] = ros::names::resolve(node);
  std::string host;
  std::uint32_t port = 0;
  if (!ros::master::execute("lookupNode", request, response, uri, false) ||
      !ros::network::splitURI(static_cast<std::string&>(uri), host, port))
    return 0;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port));
  request.clear();
  request[0] = ros::this_node::getName();
  return client.execute("getPid", request, response) && response.size() == 3 ? int(response[2]) : 0;
}

/// Processor time of a process up to now [s].
double processor_time(int process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(file, text);
  std::istringstream fields(text.substr(std::min(text.size(), text.rfind(')') + 1)));
  std::string skipped;
  for (int field = 3; field < 14; ++field) fields >> skipped;
  double user = 0.0, system = 0.0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// Processor time of a node from here on.
class Cost {
 public:
  explicit Cost(const std::string& node) : process_(process_of(node)), begin_(processor_time(process_)) {}
  double us_per(std::size_t frames) const {
    return 1e6 * (processor_time(process_) - begin_) / static_cast<double>(frames);
  }

 private:
  int process_;
  double begin_;
};

/// The other hand, beyond the device's middle.
mrhi::HandJoints mirrored(mrhi::HandJoints hand) {
  const auto turn = [](std::optional<mrhi::Vector3>& point) {
    if (point) point->x() *= -1.0;
  };
  ++hand.id;
  hand.side = hand.side == mrhi::Side::right ? mrhi::Side::left : mrhi::Side::right;
  turn(hand.palm_centre), turn(hand.wrist);
  for (auto& finger : hand.joints)
    for (auto& joint : finger) turn(joint);
  return hand;
}

class Measurement {
 public:
  /// `topics`: outputs of the node to wait for, each with its header first, or for /tf and markers in the
  /// first element.
  Measurement(ros::NodeHandle& node, const mrhi::SyntheticHandOptions& options,
              const std::vector<std::string>& topics, bool two_hands)
      : node_(node), rate_(options.rate), hand_(options), two_hands_(two_hands) {
    prepare({});  // advertised with its type
    to_node_ = message_.advertise(node_, "/leap_motion/leap_device", kQueue);
    to_relay_ = message_.advertise(node_, "relay_in", kQueue);
    const auto listen = [&](const std::string& topic, Track& track, std::size_t offset) {
      const auto handler = [&track, offset](const ShapeShifter::ConstPtr& message) {
        const Clock::time_point now = Clock::now();
        track.arrived(stamp_in(*message, offset), now, message->size());
      };
      listeners_.push_back(node_.subscribe<ShapeShifter>(
          topic, kQueue, boost::function<void(const ShapeShifter::ConstPtr&)>(handler), nullptr,
          ros::TransportHints().tcpNoDelay()));
    };
    for (const std::string& topic : topics)
      listen(topic, answers_[topic], topic == "markers" || topic == "/tf" ? 4 : 0);  // the array's length
    listen("relay_out", relayed_, 0);
  }

  void run(double seconds) {
    while (ros::ok() && (to_node_.getNumSubscribers() == 0 || to_relay_.getNumSubscribers() == 0))
      ros::WallDuration(0.05).sleep();
    ros::WallRate half_period(2.0 * rate_);
    const long warm_up = std::lround(kWarmUp * rate_), frames = warm_up + std::lround(seconds * rate_);
    std::optional<Cost> of_node, of_relay;
    for (long i = 0; i < frames && ros::ok(); ++i) {
      const bool counted = i >= warm_up;
      if (i == warm_up) of_node.emplace("interaction_node"), of_relay.emplace("relay");
      mrhi::JointsFrame frame = hand_.next();
      if (two_hands_ && !frame.hands.empty()) frame.hands.push_back(mirrored(frame.hands.front()));
      prepare(frame);
      for (auto& [topic, track] : answers_) track.sent(frame_stamp_, counted);
      to_node_.publish(message_);
      half_period.sleep();
      prepare(frame);
      relayed_.sent(frame_stamp_, counted);
      to_relay_.publish(message_);
      half_period.sleep();
    }
    ros::WallDuration(0.2).sleep();
    const auto counted = static_cast<std::size_t>(frames - warm_up);
    const double node_us = of_node ? of_node->us_per(counted) : 0.0,
                 relay_us = of_relay ? of_relay->us_per(counted) : 0.0;
    std::printf("| | arrived | message [kB] | p50 [ms] | p99 [ms] | max [ms] |\n|---|---|---|---|---|---|\n");
    relayed_.report("relay", counted);
    for (auto& [topic, track] : answers_) track.report(("hand to " + topic).c_str(), counted);
    for (const auto& [topic, track] : answers_)
      std::printf("%s: p50 %.2f, p99 %.2f times the relay's\n", topic.c_str(),
                  track.quantile(0.5) / relayed_.quantile(0.5),
                  track.quantile(0.99) / relayed_.quantile(0.99));
    std::printf("processor time a frame: interaction_node %.0f us, relay %.0f us: %.1f times\n", node_us,
                relay_us, node_us / relay_us);
    std::fflush(stdout);
  }

 private:
  void prepare(mrhi::JointsFrame frame) {
    frame.stamp = mrhi::from_ros_time(ros::Time::now());
    mrhi::write_leap(frame, "leap_hands", sequence_++, static_cast<float>(rate_), message_);
    frame_stamp_ = static_cast<std::uint64_t>(frame.stamp);
  }

  ros::NodeHandle& node_;
  double rate_;  // frames per second to each of the two
  mrhi::SyntheticHand hand_;
  bool two_hands_;
  ShapeShifter message_;
  ros::Publisher to_node_, to_relay_;
  std::vector<ros::Subscriber> listeners_;
  std::map<std::string, Track> answers_;  // by topic
  Track relayed_;
  std::uint32_t sequence_ = 0;
  std::uint64_t frame_stamp_ = 0;  // of the message [ns]
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "latency");
  ros::NodeHandle node;
  const ros::NodeHandle parameters("~");
  if (parameters.param("relay", false)) {
    const Relay relay(node);
    ros::spin();
    return 0;
  }
  mrhi::SyntheticHandOptions options;
  options.rate = parameters.param("rate", 120.0);
  options.motion = parameters.param<std::string>("motion", options.motion);
  std::istringstream topics(parameters.param<std::string>("topics", "rendered_view"));
  Measurement measurement(node, options, {std::istream_iterator<std::string>(topics), {}},
                          parameters.param("two_hands", false));
  ros::AsyncSpinner spinner(1);
  spinner.start();
  measurement.run(parameters.param("seconds", 30.0));
  return 0;
}
