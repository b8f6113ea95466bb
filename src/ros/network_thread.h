#pragma once

#include <ros/callback_queue.h>
#include <ros/poll_manager.h>
#include <ros/ros.h>
#include <boost/make_shared.hpp>

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <utility>

namespace mrhi {

/// A function in a callback queue.
class QueuedTask : public ros::CallbackInterface {
 public:
  explicit QueuedTask(std::function<void()> run) : run_(std::move(run)) {}
  CallResult call() override {
    run_();
    return Success;
  }

 private:
  std::function<void()> run_;
};

/// A callback queue that roscpp's network thread calls, which receives and sends all messages: a frame goes
/// from its arrival to the departure of its results without waking another thread. Callbacks run one at a
/// time, as under ros::spin(). They must not call services, whose responses arrive in the same thread.
///
/// In each cycle, roscpp calls its listeners in their order of registration. A queue made before the first
/// ros::NodeHandle is called before what was published is sent, and saves the frame a cycle.
class NetworkThreadQueue : public ros::CallbackQueue {
 public:
  NetworkThreadQueue() : listener_(ros::PollManager::instance()->addPollThreadListener([this] { call(); })) {}
  ~NetworkThreadQueue() { stop(); }

  /// A handle whose callbacks this queue calls.
  ros::NodeHandle handle(const ros::NodeHandle& node) {
    ros::NodeHandle here(node);
    here.setCallbackQueue(this);
    return here;
  }

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner) override {
    ros::CallbackQueue::addCallback(callback, owner);
    ros::PollManager::instance()->getPollSet().signal();
  }

  /// Calls callbacks until the node ends, and none after; rethrows exceptions. Spins the global queue.
  void spin() {
    const struct StopOnExit {
      NetworkThreadQueue& queue;
      ~StopOnExit() { queue.stop(); }
    } at_end{*this};
    spinning_ = true;
    ros::PollManager::instance()->getPollSet().signal();
    ros::spin();
  }

 private:
  /// Waits for the network thread to leave call(), which is not called again.
  void stop() { ros::PollManager::instance()->removePollThreadListener(listener_); }

  void call() {
    if (!spinning_ || isEmpty()) return;  // much cheaper than callAvailable()
    try {
      callAvailable();
    } catch (...) {
      disable();
      ros::getGlobalCallbackQueue()->addCallback(boost::make_shared<QueuedTask>(
          [error = std::current_exception()] { std::rethrow_exception(error); }));
    }
  }

  std::atomic<bool> spinning_{false};
  boost::signals2::connection listener_;
};

}  // namespace mrhi
