#pragma once

#include <mr_hand_interaction/HandFrame.h>
#include <mr_hand_interaction/SimulationInput.h>
#include <ros/ros.h>

#include <functional>
#include <string>

#include "../record/world.h"
#include "stamp_clock.h"

namespace mrhi {

/// Publishes `simulation_input`: all that a simulation is given, in its order, after it has taken it. Who
/// begins to listen is sent first what the simulation is then. Costs next to nothing while nobody listens.
class InputLog {
 public:
  InputLog(ros::NodeHandle& node, World world, const LiveSimulation& simulation, const StampClock& clock);

  /// `time`, `expected`: as Simulation::begin got them.
  void frame(const mr_hand_interaction::HandFrame& hands, Nanoseconds time, Nanoseconds expected);
  void without_hands(Nanoseconds time);
  void change(const Change& change);
  void lost(std::uint64_t frames) { lost_ = frames; }

  std::uint64_t sequence() const { return sequence_; }

 private:
  void send_begin(const ros::SingleSubscriberPublisher& subscriber);
  mr_hand_interaction::SimulationInput message(std::uint8_t kind) const;
  bool heard() const { return publisher_.getNumSubscribers() > 0; }

  World world_;
  const LiveSimulation& simulation_;
  const StampClock& clock_;
  std::uint64_t run_, sequence_ = 0, lost_ = 0;
  ros::Publisher publisher_;
};

}  // namespace mrhi
