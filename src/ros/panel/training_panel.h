#pragma once

#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/HandFrame.h>
#include <mr_hand_interaction/TrainingStatus.h>
#include <ros/ros.h>
#include <rviz/panel.h>

#include <QString>
#include <map>
#include <string>
#include <thread>

class QLabel;
class QPushButton;
class QTimer;

namespace mrhi {

/// The experimenter's panel in rviz: who does what, and how it goes; next, pause, skip and repeat by the
/// services of training_node. All of it runs in rviz's thread but the call of a service, which may take a
/// while.
class TrainingPanel : public rviz::Panel {
 public:
  explicit TrainingPanel(QWidget* parent = nullptr);
  ~TrainingPanel() override;

 private:
  QLabel* add_line(const char* name, const char* what);
  QPushButton* add_button(const char* name, const char* text, const std::string& service);
  void take(const mr_hand_interaction::TrainingStatus& status);
  void take_contacts(const mr_hand_interaction::ContactArray& contacts);
  void take_hands(const mr_hand_interaction::HandFrame& frame);
  void refresh();
  void call(const std::string& service);
  void say(const QString& text);

  std::map<std::string, QLabel*> lines_;
  std::map<std::string, QPushButton*> buttons_;
  mr_hand_interaction::TrainingStatus status_;
  ros::WallTime told_, touched_, seen_;  ///< when the last message came
  double grip_ = 0.0;                    ///< on the trial's object: half of what presses on it [N]
  double confidence_ = 0.0;              ///< of the hand that is seen best
  int frames_ = 0;                       ///< of hands since the last refresh
  double rate_ = 0.0;                    ///< of them [Hz]
  ros::WallTime counted_;
  std::vector<ros::Subscriber> subscribers_;
  std::thread calling_;
  QTimer* timer_;
};

}  // namespace mrhi
