#include "input_statistics.h"

#include <ros/console.h>

#include <algorithm>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/stamp_check.h"

namespace mrhi {
namespace {

constexpr double kLate = 0.05;  // a frame that is done with so long after it came is late [s]

}  // namespace

InputStatistics::InputStatistics(const std::vector<std::string>& reasons,
                                 const std::vector<std::string>& corrections)
    : period_start_(ros::WallTime::now()) {
  for (const std::string& reason : reasons) rejected_[reason];
  for (const std::string& kind : corrections) corrected_[kind];
}

void InputStatistics::taken(double latency) {
  ++taken_;
  ++taken_in_period_;
  latency_sum_ += latency;
  latency_max_ = std::max(latency_max_, latency);
}

void InputStatistics::waited(double seconds) {
  if (seconds > kLate) ++late_;
}

void InputStatistics::rejected(const std::string& reason, const std::string& detail) {
  const ros::WallDuration kQuiet(5.0);
  Refusals& refusals = rejected_[reason];
  ++refusals.count;
  refusals.last = detail;
  const ros::WallTime now = ros::WallTime::now();
  if (!refusals.logged.isZero() && now - refusals.logged < kQuiet) return;
  refusals.logged = now;
  ROS_WARN_STREAM(reason << ": " << detail << " (" << refusals.count << " so far)");
}

void InputStatistics::corrected(const std::string& kind, const std::string& detail) {
  if (++corrected_[kind] == 1) ROS_INFO_STREAM(kind << ": " << detail << " (more are counted only)");
}

void InputStatistics::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const ros::WallTime now = ros::WallTime::now();
  const double frames = static_cast<double>(taken_in_period_);
  const ros::WallDuration period = now - period_start_;
  status.summary(DiagnosticStatus::OK, taken_in_period_ > 0 ? "frames are coming" : "no frames");
  status.add("frames taken", taken_);
  status.add("rate [Hz]", frames / std::max(period.toSec(), 1e-3));
  status.add("latency mean [ms]", taken_in_period_ > 0 ? 1e3 * latency_sum_ / frames : 0.0);
  status.add("latency max [ms]", 1e3 * latency_max_);
  status.add("frames lost by queue", lost_);
  status.add("frames late by more than 50 ms", late_);
  if (lost_ > lost_reported_)
    status.mergeSummary(DiagnosticStatus::WARN, std::to_string(lost_) + " frames have not arrived");
  if (late_ > late_reported_)
    status.mergeSummary(DiagnosticStatus::WARN,
                        std::to_string(late_) + " frames were late by more than 50 ms");
  lost_reported_ = lost_;
  late_reported_ = late_;
  for (auto& [reason, refusals] : rejected_) {
    status.add("rejected: " + reason, refusals.count);
    if (refusals.count > refusals.reported)
      status.mergeSummary(DiagnosticStatus::WARN, reason + ": " + refusals.last);
    refusals.reported = refusals.count;
  }
  for (const auto& [kind, count] : corrected_) status.add(kind, count);
  period_start_ = now;
  taken_in_period_ = 0;
  latency_sum_ = latency_max_ = 0.0;
}

NodeDiagnostics::NodeDiagnostics(ros::NodeHandle node, const ros::NodeHandle& private_node,
                                 const std::string& hardware, const std::string& title,
                                 const std::vector<std::string>& reasons,
                                 const std::vector<std::string>& corrections, const Task& more)
    : InputStatistics(reasons, corrections), updater_(node, private_node) {
  updater_.setHardwareID(hardware);
  updater_.add(title, [this, more](diagnostic_updater::DiagnosticStatusWrapper& status) {
    report(status);
    if (more) more(status);
  });
  timer_ = node.createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) {
    // The updater adds its period to the clock, which throws where stamps end.
    if (from_ros_time(ros::Time::now()) <= StampCheck::kLatest) updater_.force_update();
    if (each_second_) each_second_();
  });
}

}  // namespace mrhi
