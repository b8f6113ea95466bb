#include "between_frames.h"

#include <ros/callback_queue_interface.h>

#include <boost/make_shared.hpp>
#include <future>
#include <stdexcept>

namespace mrhi {
namespace {

/// A task in the queue of the node. One that is dropped breaks its promise.
class Job : public ros::CallbackInterface {
 public:
  explicit Job(const std::function<void()>& task) : task_(task) {}
  CallResult call() override {
    task_();
    return Success;
  }
  std::future<void> done() { return task_.get_future(); }

 private:
  std::packaged_task<void()> task_;
};

}  // namespace

BetweenFrames::BetweenFrames(const ros::NodeHandle& node) : node_(node) {}

BetweenFrames::~BetweenFrames() {
  {
    const std::lock_guard<std::mutex> lock(ending_mutex_);
    ends_ = true;
  }
  node_.getCallbackQueue()->removeByID(id());
  spinner_.stop();
}

ros::NodeHandle BetweenFrames::node_beside(const ros::NodeHandle& node) {
  ros::NodeHandle beside(node);
  beside.setCallbackQueue(&beside_);
  return beside;
}

void BetweenFrames::run(const std::function<void()>& task) {
  std::future<void> done;
  {
    const auto job = boost::make_shared<Job>(task);
    done = job->done();
    const std::lock_guard<std::mutex> lock(ending_mutex_);
    if (!ends_) node_.getCallbackQueue()->addCallback(job, id());
  }
  try {
    done.get();
  } catch (const std::future_error&) {
    throw std::runtime_error("the node ends");
  }
}

}  // namespace mrhi
