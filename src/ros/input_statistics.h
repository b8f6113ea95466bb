#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace mrhi {

/// Counts what a node takes and refuses, for /diagnostics, and logs each kind of refusal at most every five
/// seconds.
class InputStatistics {
 public:
  /// Reasons and corrections that are listed from the start; others are added as they occur.
  explicit InputStatistics(const std::vector<std::string>& reasons,
                           const std::vector<std::string>& corrections = {});

  /// Latency: from the frame's stamp until now.
  void taken(double latency);
  void rejected(const std::string& reason, const std::string& detail);
  /// A fault of the input that was put right: counted, and logged as information when it is the first of its
  /// kind.
  void corrected(const std::string& kind, const std::string& detail);
  /// Frames that were sent and have not arrived.
  void lost(std::uint64_t frames) { lost_ += frames; }
  std::uint64_t lost() const { return lost_; }
  /// A frame was here for so long before it was done with [s].
  void waited(double seconds);
  /// Counts since the start; rate and latency since the last report.
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  struct Refusals {
    std::uint64_t count = 0;
    std::uint64_t reported = 0;
    std::string last;
    ros::WallTime logged;
  };

  std::uint64_t taken_ = 0;
  std::uint64_t lost_ = 0, late_ = 0;
  std::uint64_t lost_reported_ = 0, late_reported_ = 0;
  std::map<std::string, Refusals> rejected_;
  std::map<std::string, std::uint64_t> corrected_;
  std::uint64_t taken_in_period_ = 0;
  double latency_sum_ = 0.0, latency_max_ = 0.0;
  ros::WallTime period_start_;
};

/// These, and what else a node reports, on /diagnostics once a second.
class NodeDiagnostics : public InputStatistics {
 public:
  /// `title` of the status that has the statistics; `more` adds to it.
  using Task = std::function<void(diagnostic_updater::DiagnosticStatusWrapper&)>;
  NodeDiagnostics(ros::NodeHandle node, const ros::NodeHandle& private_node, const std::string& hardware,
                  const std::string& title, const std::vector<std::string>& reasons = {},
                  const std::vector<std::string>& corrections = {}, const Task& more = {});

  void add(const std::string& title, const Task& task) { updater_.add(title, task); }
  void each_second(const std::function<void()>& task) { each_second_ = task; }

 private:
  diagnostic_updater::Updater updater_;
  std::function<void()> each_second_;
  ros::WallTimer timer_;
};

/// Counts messages that have not arrived (a queue was full, or the way was), by the numbers that ROS gives
/// those of a publisher.
class SequenceWatch {
 public:
  /// How many are missing before this one. A number that goes back, or far ahead, begins anew.
  std::uint64_t missing(const std::string& publisher, std::uint32_t sequence) {
    constexpr std::uint32_t kFar = 1'000'000;
    const auto [known, is_new] = last_.emplace(publisher, sequence);
    const std::uint32_t step = sequence - known->second;
    known->second = sequence;
    return is_new || step == 0 || step > kFar ? 0 : step - 1;
  }

 private:
  std::map<std::string, std::uint32_t> last_;
};

}  // namespace mrhi
