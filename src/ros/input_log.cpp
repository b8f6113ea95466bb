#include "input_log.h"

#include <boost/make_shared.hpp>

#include <algorithm>
#include <utility>

#include "../simulation/state_bytes.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using mr_hand_interaction::SimulationInput;

constexpr int kQueue = 1000;

std::vector<std::uint8_t> bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

void add(const RecordedFiles& files, SimulationInput& message) {
  for (const RecordedFile& file : files) {
    message.files.emplace_back();
    message.files.back().name = file.name;
    message.files.back().bytes = bytes_of(file.bytes);
  }
}

}  // namespace

InputLog::InputLog(ros::NodeHandle& node, World world, const LiveSimulation& simulation,
                   const StampClock& clock)
    : world_(std::move(world)),
      simulation_(simulation),
      clock_(clock),
      run_(ros::WallTime::now().toNSec()),
      publisher_(node.advertise<SimulationInput>(
          "simulation_input", kQueue,
          [this](const ros::SingleSubscriberPublisher& subscriber) { send_begin(subscriber); })) {}

void InputLog::frame(const mr_hand_interaction::HandFrame& hands, Nanoseconds time, Nanoseconds expected) {
  ++sequence_;
  if (!heard()) return;
  SimulationInput input = message(SimulationInput::FRAME);
  input.header.stamp = hands.header.stamp;
  input.time = time;
  input.expected = expected;
  input.hands = hands;
  publisher_.publish(input);
}

void InputLog::without_hands(Nanoseconds time) {
  ++sequence_;
  if (!heard()) return;
  SimulationInput input = message(SimulationInput::SILENCE);
  input.time = time;
  publisher_.publish(input);
}

void InputLog::change(const Change& change) {
  ++sequence_;
  note(change, simulation_, world_);
  if (!heard()) return;
  SimulationInput input = message(SimulationInput::CHANGE);
  input.text = to_yaml(change);
  add(files_of(change), input);
  publisher_.publish(input);
}

void InputLog::send_begin(const ros::SingleSubscriberPublisher& subscriber) {
  SimulationInput input = message(SimulationInput::BEGIN);
  input.text = to_yaml(world_);
  add(world_.files, input);
  input.state = bytes_of(to_bytes(simulation_.simulation().state()));
  subscriber.publish(input);
}

SimulationInput InputLog::message(std::uint8_t kind) const {
  const SimulationState& state = simulation_.simulation().state();
  SimulationInput input;
  input.kind = kind;
  input.run = run_;
  input.sequence = sequence_;
  input.header.stamp = to_ros_time(clock_.to_stamp(state.time));
  input.state_hash = hash(state);
  input.lost_by_queue = lost_;
  return input;
}

namespace {

constexpr Nanoseconds kLeap =
    1'000'000'000;  // farther than four times what passed before, too: a clock may be fast

}  // namespace

void StampClock::take(Nanoseconds stamp, const ros::Time& now) {
  started_ = true;
  last_stamp_ = stamp;
  arrival_ = now;
}

Nanoseconds StampClock::stamp(const ros::Time& now) const {
  if (!started_) return from_ros_time(now);
  return last_stamp_ + std::max<Nanoseconds>(0, from_ros_time(now) - from_ros_time(arrival_));
}

void StampClock::pause(const ros::Time& now) {
  if (!paused_) pause_begin_ = stamp(now);
  paused_ = true;
}

void StampClock::resume(const ros::Time& now) {
  if (paused_) pauses_ += std::max<Nanoseconds>(0, stamp(now) - pause_begin_);
  paused_ = false;
}

bool ClockLeaps::look(Nanoseconds now) {
  const Nanoseconds before = std::exchange(looked_, now), stride = std::exchange(stride_, now - before);
  return before != 0 && stride_ > kLeap && stride_ / 4 > stride;
}

}  // namespace mrhi
