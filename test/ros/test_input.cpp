#include <gtest/gtest.h>
#include <std_msgs/ColorRGBA.h>
#include <xmlrpcpp/XmlRpc.h>

#include <atomic>
#include <cstdlib>
#include <functional>
#include <list>
#include <stdexcept>
#include <string>
#include <thread>

#include "ros/input_log.h"
#include "ros/input_statistics.h"
#include "ros/network_thread.h"

namespace mrhi {
namespace {

constexpr Nanoseconds kSecond = 1'000'000'000;

TEST(StampClock, before_the_first_frame_the_stamp_is_now) {
  EXPECT_EQ(StampClock().stamp(ros::Time(5, 7)), 5 * kSecond + 7);
}

TEST(StampClock, stamps_of_another_clock_go_on_as_time_passes) {
  StampClock clock;
  clock.take(1000 * kSecond, ros::Time(1700000000, 0));
  EXPECT_EQ(clock.stamp(ros::Time(1700000002, 0)), 1002 * kSecond);
}

TEST(StampClock, the_stamp_does_not_go_back_with_ros_time) {
  StampClock clock;
  clock.take(1000 * kSecond, ros::Time(1000, 0));
  EXPECT_EQ(clock.stamp(ros::Time(10, 0)), 1000 * kSecond);
}

TEST(StampClock, the_simulation_does_not_see_pauses) {
  StampClock clock;
  clock.take(100 * kSecond, ros::Time(100, 0));
  clock.pause(ros::Time(101, 0));
  clock.pause(ros::Time(103, 0));  // again: the first counts
  EXPECT_TRUE(clock.paused());
  clock.take(130 * kSecond, ros::Time(130, 0));
  clock.resume(ros::Time(131, 0));
  EXPECT_FALSE(clock.paused());
  EXPECT_EQ(clock.to_simulation(132 * kSecond), 102 * kSecond);
  EXPECT_EQ(clock.to_stamp(102 * kSecond), 132 * kSecond);
  clock.resume(ros::Time(140, 0));
  EXPECT_EQ(clock.to_simulation(132 * kSecond), 102 * kSecond);
}

TEST(StampClock, after_a_leap_of_ros_time_a_stream_is_as_far_back_as_one_that_restarts) {
  for (const Nanoseconds leap : {2'999'000'000 * kSecond, 4'294'966'295 * kSecond}) {
    StampClock clock;
    clock.take(1000 * kSecond, ros::Time(1000, 0));
    clock.leave_out(leap);  // nobody can simulate it
    Nanoseconds reached = 1001 * kSecond;
    StampCheck check;
    ASSERT_EQ(check.check(1000 * kSecond), StampVerdict::follows);
    StampVerdict verdict = StampVerdict::follows;
    for (int frame = 0; frame < 3; ++frame) {
      const Nanoseconds stamp =
          1000 * kSecond + frame * StampCheck::kBack;  // the slowest stream that restarts
      clock.limit_pauses(stamp, reached);
      EXPECT_EQ(clock.to_stamp(clock.to_simulation(stamp)), stamp);
      verdict = check.check(clock.to_simulation(stamp), reached, {});
    }
    EXPECT_EQ(verdict, StampVerdict::restart);
  }
}

TEST(StampClock, a_pause_that_leaves_stamps_in_range_stays) {
  StampClock clock;
  clock.take(1000 * kSecond, ros::Time(1000, 0));
  clock.leave_out(2'000'000'000 * kSecond);
  clock.limit_pauses(1001 * kSecond, 1000 * kSecond);
  EXPECT_EQ(clock.to_simulation(2'000'001'000 * kSecond), 1000 * kSecond);
}

TEST(ClockLeaps, one_of_another_time_for_a_moment_is_not_followed) {
  constexpr Nanoseconds kLook = 33'000'000, kFar = 3'000'000'000'000;
  ClockLeaps leaps;
  Nanoseconds now = 1'000'000'000'000;
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(leaps.detect(now += kLook));
  EXPECT_TRUE(leaps.detect(now + kFar));
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(leaps.detect(now += kLook));  // it is back
  EXPECT_TRUE(leaps.detect(now + kFar));
}

TEST(ClockLeaps, one_that_is_still_there_is_followed_and_so_is_a_fast_one) {
  constexpr Nanoseconds kLook = 33'000'000, kFar = 3'000'000'000'000;
  ClockLeaps leaps;
  Nanoseconds now = 1'000'000'000'000;
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(leaps.detect(now += kLook));
  EXPECT_TRUE(leaps.detect(now += kFar));
  EXPECT_FALSE(leaps.detect(now));  // a clock that stands
  EXPECT_FALSE(leaps.detect(now += kLook));
  EXPECT_TRUE(leaps.detect(now += 100 * kLook));  // a bag at a hundred times its speed
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(leaps.detect(now += 100 * kLook));
}

TEST(LostFrames, gaps_in_a_publisher_s_numbers_are_counted) {
  SequenceWatch watch;
  EXPECT_EQ(watch.missing("driver", 1000), 0u);
  EXPECT_EQ(watch.missing("driver", 1001), 0u);
  EXPECT_EQ(watch.missing("driver", 1005), 3u);
  EXPECT_EQ(watch.missing("driver", 1006), 0u);
}

TEST(LostFrames, each_publisher_has_numbers_of_its_own) {
  SequenceWatch watch;
  watch.missing("one", 5);
  EXPECT_EQ(watch.missing("other", 90), 0u);
  EXPECT_EQ(watch.missing("one", 6), 0u);
  EXPECT_EQ(watch.missing("other", 92), 1u);
}

TEST(LostFrames, numbers_that_repeat_or_begin_anew_are_no_loss) {
  SequenceWatch watch;
  watch.missing("driver", 7);
  EXPECT_EQ(watch.missing("driver", 7), 0u) << "who does not count";
  EXPECT_EQ(watch.missing("driver", 0), 0u) << "started again";
  EXPECT_EQ(watch.missing("driver", 2), 1u);
  watch.missing("driver", 4294967295u);
  EXPECT_EQ(watch.missing("driver", 0), 0u) << "the numbers come round";
}

std::string value_of(const diagnostic_updater::DiagnosticStatusWrapper& status, const std::string& key) {
  for (const auto& pair : status.values)
    if (pair.key == key) return pair.value;
  return "";
}

TEST(LostFrames, are_told_once_as_a_warning_and_counted_for_good) {
  using diagnostic_msgs::DiagnosticStatus;
  InputStatistics statistics({});
  statistics.taken(0.001);
  statistics.lost(3);
  statistics.waited(0.2);
  statistics.waited(0.001);
  diagnostic_updater::DiagnosticStatusWrapper first, second;
  statistics.report(first);
  EXPECT_EQ(first.level, DiagnosticStatus::WARN);
  EXPECT_NE(first.message.find("3 frames have not arrived"), std::string::npos);
  statistics.report(second);
  EXPECT_EQ(second.level, DiagnosticStatus::OK);
  EXPECT_EQ(value_of(second, "frames lost by queue"), "3");
  EXPECT_EQ(value_of(second, "frames late by more than 50 ms"), "1");
}

/// A ROS master that agrees to everything and knows of nobody, in a thread.
class StubMaster {
 public:
  StubMaster() {
    for (const char* method :
         {"registerService", "unregisterService", "registerPublisher", "unregisterPublisher",
          "registerSubscriber", "unregisterSubscriber", "getParam"})
      methods_.emplace_back(method, &server_);
    server_.bindAndListen(0);
    setenv("ROS_MASTER_URI", ("http://127.0.0.1:" + std::to_string(server_.get_port())).c_str(), 1);
    setenv("ROS_IP", "127.0.0.1", 1);
    thread_ = std::thread([this] {
      while (!ended_) server_.work(0.05);
    });
  }
  ~StubMaster() {
    ended_ = true;
    thread_.join();
  }

 private:
  struct Method : XmlRpc::XmlRpcServerMethod {
    Method(const std::string& name, XmlRpc::XmlRpcServer* server)
        : XmlRpc::XmlRpcServerMethod(name, server) {}
    void execute(XmlRpc::XmlRpcValue& /*request*/, XmlRpc::XmlRpcValue& response) override {
      response[0] = name() == "getParam" ? -1 : 1;
      response[1] = name();
      response[2].setSize(0);
    }
  };
  XmlRpc::XmlRpcServer server_;
  std::list<Method> methods_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

/// A process with a node whose queue is called by the network thread. A thread sends the numbers from 1 on to
/// `take` until the queue has ended and a thousand more are sent.
class NumbersNode {
 public:
  using Number = std_msgs::ColorRGBA;  // r
  explicit NumbersNode(const std::function<void(int number)>& take) {
    const StubMaster master;
    ros::init(ros::M_string{}, "numbers", ros::init_options::NoRosout | ros::init_options::NoSigintHandler);
    NetworkThreadQueue queue;
    ros::NodeHandle node;
    ros::NodeHandle here = queue.handle(node);
    const ros::Publisher publisher = node.advertise<Number>("numbers", 0);
    const auto handler = [&](const Number::ConstPtr& message) {
      late_ = late_ || ended_;
      take(static_cast<int>(message->r));
    };
    const ros::Subscriber subscriber =
        here.subscribe<Number>("numbers", 0, boost::function<void(const Number::ConstPtr&)>(handler));
    std::thread sender([&] {
      for (int sent = 0, after = 0; after < 1000; after += ended_) {
        const auto message = boost::make_shared<Number>();
        message->r = static_cast<float>(++sent);  // exact up to 2^24
        publisher.publish(message);
      }
    });
    try {
      queue.spin();
    } catch (const std::exception& error) {
      error_ = error.what();
    }
    ended_ = true;
    sender.join();
    ros::shutdown();
  }

  const std::string& error() const { return error_; }
  /// True if a number was taken after the queue had ended.
  bool was_late() const { return late_; }

 private:
  std::string error_;
  std::atomic<bool> ended_{false}, late_{false};
};

/// Each in a process of its own: a process can be a node once only.
class NetworkThread : public ::testing::Test {
 protected:
  void SetUp() override { ::testing::FLAGS_gtest_death_test_style = "threadsafe"; }
  static constexpr int kNumbers = 10000;

  template <class Run>
  static void passes(Run run) {
    EXPECT_EXIT(std::exit(run() ? 0 : 1), ::testing::ExitedWithCode(0), "");
  }
};

TEST_F(NetworkThread, takes_all_messages_in_order_and_none_once_the_node_has_ended) {
  passes([] {
    int last = 0;
    bool in_order = true;
    std::thread::id thread;
    const NumbersNode node([&](int number) {
      if (last == 0) thread = std::this_thread::get_id();
      in_order = in_order && number == ++last && thread == std::this_thread::get_id();
      if (last == kNumbers) ros::requestShutdown();
    });
    return in_order && last >= kNumbers && thread != std::this_thread::get_id() && node.error().empty() &&
           !node.was_late();
  });
}

TEST_F(NetworkThread, an_exception_in_a_callback_ends_the_spin_with_it_and_no_callback_follows) {
  passes([] {
    int last = 0;
    const NumbersNode node([&](int number) {
      last = number;
      if (number == kNumbers) throw std::runtime_error("at the last number");
    });
    return last == kNumbers && node.error() == "at the last number" && !node.was_late();
  });
}

struct Broken : ros::CallbackInterface {
  CallResult call() override { throw std::runtime_error("in the main thread"); }
};

TEST_F(NetworkThread, an_exception_in_the_main_thread_ends_the_spin_and_no_callback_follows) {
  passes([] {
    const NumbersNode node([&](int number) {
      if (number == kNumbers) ros::getGlobalCallbackQueue()->addCallback(boost::make_shared<Broken>());
    });
    return node.error() == "in the main thread" && !node.was_late();
  });
}

}  // namespace
}  // namespace mrhi
