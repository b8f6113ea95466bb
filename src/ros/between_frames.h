#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <functional>
#include <mutex>

namespace mrhi {

/// Service calls that take long run in a thread of their own, beside the frames. What such a call does to the
/// simulation it hands to run(), which has it done between two frames by the thread that spins the node.
class BetweenFrames {
 public:
  explicit BetweenFrames(const ros::NodeHandle& node);
  /// Drops what waits; who waits for it gets an exception.
  ~BetweenFrames();
  BetweenFrames(const BetweenFrames&) = delete;
  BetweenFrames& operator=(const BetweenFrames&) = delete;

  /// A node handle whose services run beside the frames, after start().
  ros::NodeHandle node_beside(const ros::NodeHandle& node);
  void start() { spinner_.start(); }
  /// Blocks until `task` is done. Rethrows what it throws; throws std::runtime_error if the node ends before.
  void run(const std::function<void()>& task);

 private:
  std::uint64_t id() const { return reinterpret_cast<std::uintptr_t>(this); }

  ros::NodeHandle node_;
  std::mutex ending_mutex_;
  bool ends_ = false;
  ros::CallbackQueue beside_;
  ros::AsyncSpinner spinner_{1, &beside_};
};

}  // namespace mrhi
