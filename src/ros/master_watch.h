#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

namespace mrhi {

/// Says in the log when the ROS master is gone, and when one is there again that does not know this node:
/// what is connected goes on without a master, but nobody new can find the node until it is started again.
/// Asks in a thread of its own, as a master on a network that is down keeps who asks waiting.
class MasterWatch {
 public:
  MasterWatch();
  ~MasterWatch();
  MasterWatch(const MasterWatch&) = delete;
  MasterWatch& operator=(const MasterWatch&) = delete;

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable ended_;
  bool end_ = false;
  std::thread thread_;
};

}  // namespace mrhi
