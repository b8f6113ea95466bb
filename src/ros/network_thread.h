#pragma once

#include <ros/callback_queue.h>
#include <ros/poll_manager.h>
#include <ros/ros.h>
#include <boost/make_shared.hpp>

#include <cstdint>
#include <exception>
#include <utility>

namespace mrhi {

/// A callback queue that roscpp's network thread calls, which receives and sends all messages: a frame goes
/// from its arrival to the departure of its results without waking another thread. Callbacks run one at a
/// time, as under ros::spin(). They must not call services, whose responses arrive in the same thread.
class NetworkThreadQueue : public ros::CallbackQueue {
 public:
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

  /// Calls callbacks until the node ends, and in this thread those of the global queue. Rethrows their
  /// exceptions.
  void spin() {
    const Listener listener([this] { call(); });
    ros::spin();
  }

 private:
  /// Called in each cycle of the network thread. After its destruction it is not called, nor running.
  class Listener {
   public:
    explicit Listener(const ros::VoidFunc& call)
        : connection_(ros::PollManager::instance()->addPollThreadListener(call)) {}
    ~Listener() { ros::PollManager::instance()->removePollThreadListener(connection_); }
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;

   private:
    boost::signals2::connection connection_;
  };

  /// Throws an exception of the network thread in the thread of ros::spin().
  class Failure : public ros::CallbackInterface {
   public:
    explicit Failure(std::exception_ptr exception) : exception_(std::move(exception)) {}
    CallResult call() override { std::rethrow_exception(exception_); }

   private:
    std::exception_ptr exception_;
  };

  void call() {
    if (isEmpty()) return;  // much cheaper than callAvailable()
    try {
      callAvailable();
    } catch (...) {
      disable();
      ros::getGlobalCallbackQueue()->addCallback(boost::make_shared<Failure>(std::current_exception()));
    }
  }
};

}  // namespace mrhi
