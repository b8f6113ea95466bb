#pragma once

#include <ros/callback_queue.h>
#include <ros/poll_manager.h>
#include <ros/ros.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <boost/make_shared.hpp>

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <utility>

namespace mrhi {

/// A message of any type, as publish_large() passes it to roscpp.
struct SerializedBefore {
  ros::SerializedMessage bytes;
};

}  // namespace mrhi

namespace ros {
namespace message_traits {
template <>
struct MD5Sum<mrhi::SerializedBefore> {
  static const char* value(const mrhi::SerializedBefore&) { return "*"; }
};
template <>
struct DataType<mrhi::SerializedBefore> {
  static const char* value(const mrhi::SerializedBefore&) { return "*"; }
};
}  // namespace message_traits

namespace serialization {
template <>
inline SerializedMessage serializeMessage(const mrhi::SerializedBefore& message) {
  return message.bytes;
}
}  // namespace serialization
}  // namespace ros

namespace mrhi {

/// Publishes a large message, from any thread: all other topics wait while roscpp serializes one itself.
template <class Message>
void publish_large(const ros::Publisher& publisher, const Message& message) {
  publisher.publish(SerializedBefore{ros::serialization::serializeMessage(message)});
}

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

/// A callback queue with a thread of its own, for what hands must not wait for: frames come first where
/// processors are few.
class BackgroundQueue : public ros::CallbackQueue {
 public:
  ~BackgroundQueue() { stop(); }

  void start() {
    run([] { setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNiceness); });
    spinner_.start();
  }
  /// Waits for the task that runs; later ones are not called.
  void stop() { spinner_.stop(); }
  void run(std::function<void()> task) { addCallback(boost::make_shared<QueuedTask>(std::move(task))); }

 private:
  static constexpr int kNiceness = 10;  // of the thread alone, and of processes that it starts

  ros::AsyncSpinner spinner_{1, this};
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
