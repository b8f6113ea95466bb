#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/stamp_check.h"

namespace mrhi {

/// Counts accepted and rejected input, for /diagnostics, and logs each kind of rejection: at once, then after
/// pauses of 5 s that double up to a minute while rejections of the kind continue.
class InputStatistics {
 public:
  /// Reasons and corrections that are listed from the start; others are added as they occur.
  explicit InputStatistics(const std::vector<std::string>& reasons,
                           const std::vector<std::string>& corrections = {})
      : period_start_(ros::SteadyTime::now()) {
    for (const std::string& reason : reasons) rejected_[reason];
    for (const std::string& kind : corrections) corrected_[kind];
  }

  /// `latency`: from the frame's stamp until now.
  void taken(double latency) {
    ++taken_;
    ++taken_in_period_;
    latency_sum_ += latency;
    latency_max_ = std::max(latency_max_, latency);
  }
  void rejected(const std::string& reason, const std::string& detail) {
    Refusals& refusals = rejected_[reason];
    ++refusals.count;
    refusals.last = detail;
    const ros::SteadyTime now = ros::SteadyTime::now();
    const ros::WallDuration since =
        refusals.logged.isZero() ? ros::WallDuration(kMaxSilence) : now - refusals.logged;
    if (since.toSec() < refusals.silence) return;
    const bool continues = since.toSec() < 2.0 * refusals.silence;
    refusals.silence = continues ? std::min(2.0 * refusals.silence, kMaxSilence) : kMinSilence;
    refusals.logged = now;
    ROS_WARN_STREAM(reason << ": " << detail << " (" << refusals.count << " so far)");
  }
  /// Counts a corrected fault of the input; logs the first of each kind as information.
  void corrected(const std::string& kind, const std::string& detail) {
    if (++corrected_[kind] == 1) ROS_INFO_STREAM(kind << ": " << detail << " (more are counted only)");
  }
  /// Counts frames that were sent and have not arrived.
  void lost(std::uint64_t frames) { lost_.count += frames; }
  std::uint64_t lost() const { return lost_.count; }
  /// Notes the time from a frame's arrival to the end of its processing [s].
  void waited(double seconds) {
    if (seconds > kMaxWait) ++late_.count;
  }
  /// Counts since the start; rate and latency since the last report.
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) {
    using diagnostic_msgs::DiagnosticStatus;
    const ros::SteadyTime now = ros::SteadyTime::now();
    const double frames = static_cast<double>(taken_in_period_);
    const ros::WallDuration period = now - period_start_;
    status.summary(DiagnosticStatus::OK, taken_in_period_ > 0 ? "frames are coming" : "no frames");
    status.add("frames taken", taken_);
    status.add("rate [Hz]", frames / std::max(period.toSec(), 1e-3));
    status.add("latency mean [ms]", taken_in_period_ > 0 ? 1e3 * latency_sum_ / frames : 0.0);
    status.add("latency max [ms]", 1e3 * latency_max_);
    status.add("frames lost by queue", lost_.count);
    status.add("frames late by more than 50 ms", late_.count);
    const auto warn_if_grown = [&](Count& count, const std::string& text) {
      if (std::exchange(count.reported, count.count) < count.count)
        status.mergeSummary(DiagnosticStatus::WARN, text);
    };
    warn_if_grown(lost_, std::to_string(lost_.count) + " frames have not arrived");
    warn_if_grown(late_, std::to_string(late_.count) + " frames were late by more than 50 ms");
    for (auto& [reason, refusals] : rejected_) {
      status.add("rejected: " + reason, refusals.count);
      warn_if_grown(refusals, reason + ": " + refusals.last);
    }
    for (const auto& [kind, count] : corrected_) status.add(kind, count);
    period_start_ = now;
    taken_in_period_ = 0;
    latency_sum_ = latency_max_ = 0.0;
  }

 private:
  static constexpr double kMaxWait = 0.05;  // from arrival to end of processing; late beyond it [s]
  static constexpr double kMinSilence = 5.0, kMaxSilence = 60.0;  // between two lines of a kind [s]

  struct Count {
    std::uint64_t count = 0, reported = 0;  ///< now, and at the last report
  };
  struct Refusals : Count {
    std::string last;
    ros::SteadyTime logged;
    double silence = kMinSilence;  ///< until the next line [s]
  };

  std::uint64_t taken_ = 0;
  Count lost_, late_;
  std::map<std::string, Refusals> rejected_;
  std::map<std::string, std::uint64_t> corrected_;
  std::uint64_t taken_in_period_ = 0;
  double latency_sum_ = 0.0, latency_max_ = 0.0;
  ros::SteadyTime period_start_;
};

/// Publishes the statistics, and other states of a node, on /diagnostics once a second.
class NodeDiagnostics : public InputStatistics {
 public:
  /// `title`: of the status with the statistics; `more` adds to it.
  using Task = std::function<void(diagnostic_updater::DiagnosticStatusWrapper&)>;
  NodeDiagnostics(ros::NodeHandle node, const ros::NodeHandle& private_node, const std::string& hardware,
                  const std::string& title, const std::vector<std::string>& reasons = {},
                  const std::vector<std::string>& corrections = {}, const Task& more = {})
      : InputStatistics(reasons, corrections), updater_(node, private_node) {
    updater_.setHardwareID(hardware);
    updater_.add(title, [this, more](diagnostic_updater::DiagnosticStatusWrapper& status) {
      report(status);
      if (more) more(status);
    });
    timer_ = node.createSteadyTimer(ros::WallDuration(1.0), [this](const ros::SteadyTimerEvent&) {
      // The updater adds its period to the time, which throws at the end of the range of stamps.
      if (from_ros_time(ros::Time::now()) <= StampCheck::kLatest) updater_.force_update();
      if (each_second_) each_second_();
    });
  }

  void add(const std::string& title, const Task& task) { updater_.add(title, task); }
  void each_second(const std::function<void()>& task) { each_second_ = task; }

 private:
  diagnostic_updater::Updater updater_;
  std::function<void()> each_second_;
  ros::SteadyTimer timer_;
};

/// Counts messages that have not arrived, by the sequence numbers of their publishers.
class SequenceWatch {
 public:
  /// Number missing before this one. A number that goes back or far ahead restarts the count.
  std::uint64_t missing(const std::string& publisher, std::uint32_t sequence) {
    constexpr std::uint32_t kMaxStep = 1'000'000;
    const auto [known, is_new] = last_.try_emplace(publisher, sequence);
    const std::uint32_t step = sequence - known->second;
    known->second = sequence;
    return is_new || step == 0 || step > kMaxStep ? 0 : step - 1;
  }

 private:
  std::map<std::string, std::uint32_t> last_;
};

}  // namespace mrhi
