#include <mr_hand_interaction/SimulationInput.h>
#include <ros/message_traits.h>
#include <rosbag/view.h>

#include <map>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "bag_input.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using mr_hand_interaction::SimulationInput;

std::string text_of(const std::vector<std::uint8_t>& bytes) {
  return {bytes.begin(), bytes.end()};
}

LogEntry entry_of(const SimulationInput& message) {
  LogEntry entry;
  if (message.kind > SimulationInput::CHANGE)
    throw std::invalid_argument("recorded input: kind is not known");
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

/// By run and sequence: where recorded time goes back, as a bag that loops makes it, the bag's order is
/// another.
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
  }

  std::optional<LogEntry> next() override try {
    if (at_ == order_.end()) return std::nullopt;
    const auto message = (at_++)->second.instantiate<SimulationInput>();
    ++position_;
    return entry_of(*message);
  } catch (...) {
    refuse_bag(file_);
  }
  std::size_t position() const override { return position_; }
  std::size_t size() const override { return order_.size(); }

 private:
  std::string file_;
  rosbag::Bag bag_;
  rosbag::View view_;
  std::multimap<std::tuple<std::size_t, std::uint64_t>, rosbag::MessageInstance> order_;
  decltype(order_)::const_iterator at_;
  std::size_t position_ = 0;
};

struct Found {
  std::string topic, why_not;
};

Found find_log(const std::string& file) {
  using Traits = ros::message_traits::MD5Sum<SimulationInput>;
  const rosbag::Bag bag(file, rosbag::bagmode::Read);
  Found found;
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

OpenLog open_log(const ReplayArguments& arguments) {
  const std::string& file = arguments.input;
  try {
    check_readable(file);
    const Found found = find_log(file);
    OpenLog log;
    log.why_not = found.why_not.empty() ? "it has no simulation_input" : found.why_not;
    if (found.topic.empty()) return log;
    log.topic = found.topic;
    log.source = std::make_unique<BagLog>(file, found.topic);
    if (log.source->size() == 0) log.source.reset();
    return log;
  } catch (...) {
    refuse_bag(file);
  }
}

}  // namespace mrhi
