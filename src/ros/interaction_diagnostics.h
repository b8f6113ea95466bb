#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "../math/duration_histogram.h"
#include "input_statistics.h"

namespace mrhi {

/// What the interaction node tells on /diagnostics once a second: rate, latency, step time, what it took and
/// refused.
class InteractionDiagnostics {
 public:
  InteractionDiagnostics(ros::NodeHandle node, ros::NodeHandle parameters, const std::string& scene);

  /// Latency: from the frame's stamp until its results are published [s].
  void taken(double latency) { input_.taken(latency); }
  /// From the arrival of the hand's message until its markers were published [s].
  void picture(double latency) { picture_latency_.add(static_cast<Nanoseconds>(1e9 * latency)); }
  void rejected(const std::string& reason, const std::string& detail) { input_.rejected(reason, detail); }
  void lost(std::uint64_t frames) { input_.lost(frames); }
  std::uint64_t lost() const { return input_.lost(); }
  /// From the arrival of a frame until it was done with [s].
  void waited(double seconds) { input_.waited(seconds); }
  void dropped_while_paused() { ++dropped_; }
  /// Tells the state, in a status of its own.
  using Teller = std::function<void(diagnostic_updater::DiagnosticStatusWrapper&)>;
  void watch(Teller teller) { teller_ = std::move(teller); }
  void step(Nanoseconds duration) { step_times_.add(duration); }

 private:
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);
  void report_state(diagnostic_updater::DiagnosticStatusWrapper& status);

  Teller teller_;
  InputStatistics input_;
  DurationHistogram step_times_, picture_latency_;  ///< since the last report
  std::uint64_t dropped_ = 0;
  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
};

}  // namespace mrhi
