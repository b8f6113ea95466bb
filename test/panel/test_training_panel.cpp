#include <gtest/gtest.h>
#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/HandFrame.h>
#include <mr_hand_interaction/TrainingStatus.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rviz/panel.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <pluginlib/class_loader.hpp>

#include <QApplication>
#include <QLabel>
#include <QPushButton>
#include <QTest>
#include <map>
#include <memory>

namespace {

using Status = mr_hand_interaction::TrainingStatus;

constexpr double kLimit = 60.0;  // far beyond what an answer takes [s]

/// Plays training_node, and drives the panel as rviz does: callbacks and events in one thread.
class PanelTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto offer = [this](const std::string& name) {
      services_.push_back(training_.advertiseService<std_srvs::Trigger::Request, std_srvs::Trigger::Response>(
          "/training_node/" + name, [this, name](auto&, auto& response) {
            ++asked_[name];
            response.success = name != "repeat";
            response.message = name == "repeat" ? "nothing to repeat" : "";
            return true;
          }));
    };
    training_.setCallbackQueue(&queue_);
    for (const char* name : {"next", "skip", "repeat"}) offer(name);
    services_.push_back(training_.advertiseService<std_srvs::SetBool::Request, std_srvs::SetBool::Response>(
        "/training_node/pause", [this](auto& request, auto& response) {
          ++asked_[request.data ? "pause" : "go on"];
          response.success = true;
          return true;
        }));
    spinner_ = std::make_unique<ros::AsyncSpinner>(1, &queue_);
    spinner_->start();
    status_ = training_.advertise<Status>("training/status", 1, true);
    contacts_ = training_.advertise<mr_hand_interaction::ContactArray>("contacts", 1, true);
    hands_ = training_.advertise<mr_hand_interaction::HandFrame>("hand_frame", 1, true);
    panel_ = loader_.createUniqueInstance("mr_hand_interaction/TrainingPanel");
    panel_->show();
  }
  void TearDown() override {
    panel_.reset();
    spinner_.reset();
  }

  template <class Condition>
  bool comes(Condition condition) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kLimit);
    while (!condition() && ros::WallTime::now() < end) {
      if (told_) status_.publish(*told_);
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
      QApplication::processEvents();
    }
    return condition();
  }
  QString line(const char* name) { return panel_->findChild<QLabel*>(name)->text(); }
  QPushButton* button(const char* name) { return panel_->findChild<QPushButton*>(name); }
  void click(const char* name) {
    ASSERT_TRUE(comes([&] { return button(name)->isEnabled(); })) << name;
    QTest::mouseClick(button(name), Qt::LeftButton);
  }
  void tell(std::uint8_t phase) {
    Status status;
    status.phase = phase;
    status.participant = "P07";
    status.task = "pick_and_place";
    status.object = "cube";
    status.trial = 2;
    status.trials = 3;
    status.elapsed = 12.34;
    status.drops = 4;
    told_ = std::make_unique<Status>(status);
  }

  ros::CallbackQueue queue_;
  ros::NodeHandle training_;
  std::vector<ros::ServiceServer> services_;
  std::map<std::string, int> asked_;
  std::unique_ptr<ros::AsyncSpinner> spinner_;
  ros::Publisher status_, contacts_, hands_;
  std::unique_ptr<Status> told_;
  pluginlib::ClassLoader<rviz::Panel> loader_{"rviz", "rviz::Panel"};
  pluginlib::UniquePtr<rviz::Panel> panel_;
};

TEST_F(PanelTest, shows_who_does_what_and_how_it_goes) {
  EXPECT_TRUE(comes([&] { return line("phase") == "no training_node"; }));
  EXPECT_FALSE(button("button_next")->isEnabled());
  tell(Status::RUNNING);
  ASSERT_TRUE(comes([&] { return line("participant") == "P07"; }));
  EXPECT_EQ("2 of 3: cube, repetition 0", line("trial").toStdString());
  EXPECT_EQ("running, manipulation", line("phase").toStdString());
  EXPECT_EQ("12.3 s", line("time").toStdString());
  EXPECT_EQ("4", line("drops").toStdString());
}

TEST_F(PanelTest, shows_grip_and_how_well_the_hand_is_seen) {
  tell(Status::RUNNING);
  ASSERT_TRUE(comes([&] { return line("participant") == "P07"; }));
  mr_hand_interaction::ContactArray contacts;
  contacts.contacts.resize(3);  // two that press with 3 N from both sides, one on another object
  for (auto& contact : contacts.contacts) contact.object = "cube";
  contacts.contacts[0].normal.x = 1.0;
  contacts.contacts[0].force.x = -3.0;
  contacts.contacts[1].normal.x = -1.0;
  contacts.contacts[1].force.x = 3.0;
  contacts.contacts[2] = contacts.contacts[1];
  contacts.contacts[2].object = "other";
  mr_hand_interaction::HandFrame hands;
  hands.hands.resize(1);
  hands.hands[0].confidence = 0.75;
  ASSERT_TRUE(comes([&] {
    contacts_.publish(contacts);
    hands_.publish(hands);
    return line("grip") == "3.0 N" && line("tracking").startsWith("confidence 0.75");
  })) << line("grip").toStdString()
      << line("tracking").toStdString();
  EXPECT_TRUE(comes([&] { return line("grip") == "-" && line("tracking") == "no hand"; }))
      << "what is old is not shown";
}

TEST_F(PanelTest, buttons_call_the_services_and_tell_what_they_answer) {
  tell(Status::RUNNING);
  for (const char* name : {"next", "skip"}) {
    click((std::string("button_") + name).c_str());
    EXPECT_TRUE(comes([&] { return line("answer") == QString(name) + ": done"; }))
        << line("answer").toStdString();
    EXPECT_EQ(1, asked_[name]);
  }
  click("button_repeat");
  EXPECT_TRUE(comes([&] { return line("answer") == "nothing to repeat"; }));
}

TEST_F(PanelTest, pause_goes_on_where_it_is_paused) {
  tell(Status::RUNNING);
  click("button_pause");
  EXPECT_TRUE(comes([&] { return asked_["pause"] == 1; }));
  tell(Status::PAUSED);
  ASSERT_TRUE(comes([&] { return button("button_pause")->text() == "Go on"; }));
  click("button_pause");
  EXPECT_TRUE(comes([&] { return asked_["go on"] == 1; }));
}

}  // namespace

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "test_training_panel");
  QApplication application(argc, argv);
  const ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
