#pragma once

#include <mr_hand_interaction/SimulationInput.h>
#include <ros/ros.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "../record/record.h"
#include "../simulation/state_bytes.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/stamp_check.h"
#include "network_thread.h"

namespace mrhi {
/// Extrapolates the hand stream's time: the last stamp plus the time since its arrival. So stamps may come
/// from another clock, like those of a bag. The simulation's time excludes pauses.
class StampClock {
 public:
  /// Notes the arrival of a frame with this stamp.
  void take(Nanoseconds stamp, const ros::Time& now) {
    last_.started = true;
    last_.last = stamp;
    arrival_ = now;
  }

  /// Stamp of a frame sent now; now itself before the first frame. Never decreases, even if ROS time does.
  Nanoseconds stamp(const ros::Time& now) const {
    if (!last_.started) return from_ros_time(now);
    return last_.last + std::max<Nanoseconds>(0, from_ros_time(now) - from_ros_time(arrival_));
  }

  void pause(const ros::Time& now) {
    if (!paused_) pause_begin_ = stamp(now);
    paused_ = true;
  }

  void resume(const ros::Time& now) {
    if (paused_) pauses_ += std::max<Nanoseconds>(0, stamp(now) - pause_begin_);
    paused_ = false;
  }

  /// Leaves out time that was too long to simulate, like a pause.
  void leave_out(Nanoseconds time) { pauses_ += time; }

  /// Shortens the pauses if they move a frame's stamp out of the range of simulation time, as after a leap of
  /// ROS's clock. The frame is then so long before `reached`, the simulated time, that its stream restarts.
  void limit_pauses(Nanoseconds stamp, Nanoseconds reached) {
    if (to_simulation(stamp) < -StampCheck::kLatest)
      pauses_ = std::max<Nanoseconds>(0, stamp - (reached - kBeforeRestart));
  }

  bool paused() const { return paused_; }
  /// Check of frames that continue from the last accepted one.
  const StampCheck& check() const { return last_; }

  Nanoseconds to_simulation(Nanoseconds stamp) const { return stamp - pauses_; }
  Nanoseconds to_stamp(Nanoseconds simulation_time) const { return simulation_time + pauses_; }

 private:
  static constexpr Nanoseconds kBeforeRestart = 4 * StampCheck::kBack;  // the frames of a restart fit in

  StampCheck last_;  // of the last frame
  ros::Time arrival_;
  bool paused_ = false;
  Nanoseconds pause_begin_ = 0;
  Nanoseconds pauses_ = 0;
};

/// Wall time that simulation costs, so that one call of a scene slower than real time stays short.
class SimulationCost {
 public:
  void note(Nanoseconds simulated, ros::WallDuration wall) {
    if (simulated <= 0) return;
    const double cost = wall.toSec() / to_seconds(simulated);
    if (calls_ == 0) last_.fill(cost);
    last_[calls_++ % last_.size()] = cost;
  }

  /// Time that a call can simulate within kMaxCallTime, by the second most expensive of the last calls: one
  /// of them may have waited for a processor.
  Nanoseconds affordable() const {
    std::array<double, 4> sorted = last_;
    std::sort(sorted.begin(), sorted.end());
    const double cost = sorted[2];
    return static_cast<Nanoseconds>(1e9 * std::min(kMaxCallTime / std::max(cost, 1e-9), 1e6));
  }

 private:
  static constexpr double kMaxCallTime = 0.05;  // [s]: services wait for the frames before them
  std::array<double, 4> last_{};                // wall time over simulated time
  std::size_t calls_ = 0;
};

/// Detects jumps of ROS's clock. A jump is accepted once it persists: /clock may be of another time for a
/// moment, and a scene that followed it would be reset on its return.
class ClockLeaps {
 public:
  bool detect(Nanoseconds now) {
    const Nanoseconds before = std::exchange(last_now_, now), stride = std::exchange(stride_, now - before);
    return before != 0 && stride_ > kMinLeap && stride_ / 4 > stride;
  }

 private:
  static constexpr Nanoseconds kMinLeap =
      1'000'000'000;  // and farther than four times the last interval, as a clock may be fast

  Nanoseconds last_now_ = 0, stride_ = 0;  // of the last call, and its interval from the one before
};

/// Publishes `simulation_input`: all inputs of a simulation, in order, after they are applied. A new
/// subscriber first gets the present state. Costs little without subscribers.
class InputLog {
 public:
  InputLog(ros::NodeHandle& node, World world, const LiveSimulation& simulation, const StampClock& clock)
      : world_(std::move(world)),
        simulation_(simulation),
        clock_(clock),
        run_(ros::WallTime::now().toNSec()),
        publisher_(node.advertise<SimulationInput>(
            "simulation_input", kQueue,
            [this](const ros::SingleSubscriberPublisher& subscriber) { send_begin(subscriber); })) {}

  /// `hands`, `expected`: as for Simulation::begin(). `frame_id`: frame of the hands.
  void frame(HandFrame hands, const std::string& frame_id, Nanoseconds expected) {
    publish(SimulationInput::FRAME, [&](SimulationInput& input) {
      input.time = hands.stamp;
      input.expected = expected;
      hands.stamp = clock_.to_stamp(hands.stamp);
      input.hands = to_message(hands, frame_id);
      input.header.stamp = input.hands.header.stamp;
    });
  }

  void without_hands(Nanoseconds time) {
    publish(SimulationInput::SILENCE, [&](SimulationInput& input) { input.time = time; });
  }

  using SimulationInput = mr_hand_interaction::SimulationInput;

  /// Records a change, and returns its input without files, for send().
  SimulationInput note_change(const Change& change) {
    note(change, simulation_, world_);
    ++sequence_;
    SimulationInput input = message(SimulationInput::CHANGE);
    input.text = to_yaml(change);
    return input;
  }
  /// From any thread, as files may be large: readers sort by sequence.
  void send(SimulationInput input, const RecordedFiles& files) const {
    if (publisher_.getNumSubscribers() == 0) return;
    add(files, input);
    publish_large(publisher_, input);
  }

  void lost(std::uint64_t frames) { lost_ = frames; }

  std::uint64_t sequence() const { return sequence_; }

 private:
  static constexpr int kQueue = 1000;

  static std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

  static void add(const RecordedFiles& files, SimulationInput& message) {
    for (const RecordedFile& file : files) {
      message.files.emplace_back();
      message.files.back().name = file.name;
      message.files.back().bytes = bytes_of(file.bytes());
    }
  }

  void send_begin(const ros::SingleSubscriberPublisher& subscriber) {
    SimulationInput input = message(SimulationInput::BEGIN);
    input.text = to_yaml(world_);
    add(world_.files, input);
    input.state = bytes_of(to_bytes(simulation_.simulation().state()));
    subscriber.publish(input);
  }

  template <class Fill>
  void publish(std::uint8_t kind, const Fill& fill) {
    ++sequence_;
    if (publisher_.getNumSubscribers() == 0) return;
    SimulationInput input = message(kind);
    fill(input);
    publisher_.publish(input);
  }

  SimulationInput message(std::uint8_t kind) const {
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

  World world_;
  const LiveSimulation& simulation_;
  const StampClock& clock_;
  std::uint64_t run_, sequence_ = 0, lost_ = 0;
  ros::Publisher publisher_;
};

}  // namespace mrhi
