#include <mr_hand_interaction/ContactArray.h>
#include <mr_hand_interaction/HandFrame.h>
#include <mr_hand_interaction/TrainingStatus.h>
#include <ros/ros.h>
#include <rviz/panel.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <pluginlib/class_list_macros.hpp>

#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QString>
#include <QTimer>
#include <QVBoxLayout>
#include <algorithm>
#include <map>
#include <string>
#include <thread>

#include "../result_messages.h"

namespace mrhi {
namespace {

using Status = mr_hand_interaction::TrainingStatus;

constexpr int kRefreshPeriod = 100;  // [ms]
constexpr double kMaxAge = 1.0;      // of messages [s]
const char* const kNode = "training_node/";
const char* const kPauseService = "pause";

const std::vector<const char*> kPhaseNames{"ready", "running", "paused", "finished"};
const std::vector<const char*> kStageNames{"manipulation", "maintenance", "release"};

const char* name_in(const std::vector<const char*>& names, std::size_t number) {
  return number < names.size() ? names[number] : "?";
}

bool is_old(const ros::SteadyTime& time) {
  return time.isZero() || (ros::SteadyTime::now() - time).toSec() > kMaxAge;
}

/// Returns an error, or an empty string.
std::string call_service(const std::string& service, bool pause) {
  std_srvs::SetBool set;
  std_srvs::Trigger trigger;
  set.request.data = pause;
  const bool sets = service == kPauseService;
  if (!(sets ? ros::service::call(kNode + service, set) : ros::service::call(kNode + service, trigger)))
    return "training_node does not answer";
  const bool good = sets ? set.response.success : trigger.response.success;
  return good ? "" : sets ? set.response.message : trigger.response.message;
}

}  // namespace

/// The experimenter's panel in rviz. It calls the services of training_node in a thread, as they may block.
class TrainingPanel : public rviz::Panel {
 public:
  explicit TrainingPanel(QWidget* parent = nullptr) : rviz::Panel(parent), timer_(new QTimer(this)) {
    auto* const form = new QFormLayout;
    auto* const row = new QHBoxLayout;
    auto* const all = new QVBoxLayout(this);
    all->addLayout(form);
    all->addLayout(row);
    for (const char* what : {"participant", "task", "trial", "phase", "instruction", "time", "grasps",
                             "drops", "grip", "tracking", "result"})
      form->addRow(what, add_line(what, "-"));
    row->addWidget(add_button("next", "Next", "next"));
    row->addWidget(add_button("pause", "Pause", kPauseService));
    row->addWidget(add_button("skip", "Skip", "skip"));
    row->addWidget(add_button("repeat", "Repeat", "repeat"));
    all->addWidget(add_line("answer", ""));
    lines_["instruction"]->setWordWrap(true);
    lines_["answer"]->setWordWrap(true);

    ros::NodeHandle node;
    subscribers_ = {node.subscribe("training/status", 10, &TrainingPanel::take, this),
                    node.subscribe("contacts", 1, &TrainingPanel::take_contacts, this),
                    node.subscribe("hand_frame", 10, &TrainingPanel::take_hands, this)};
    counted_ = ros::SteadyTime::now();
    connect(timer_, &QTimer::timeout, this, [this] { refresh(); });
    timer_->start(kRefreshPeriod);
    refresh();
  }

  ~TrainingPanel() override {
    if (calling_.joinable()) calling_.join();
  }

 private:
  QLabel* add_line(const char* name, const char* what) {
    auto* const label = new QLabel(what);
    label->setObjectName(name);
    return lines_[name] = label;
  }

  QPushButton* add_button(const char* name, const char* text, const std::string& service) {
    auto* const button = new QPushButton(text);
    button->setObjectName(QString("button_") + name);
    connect(button, &QPushButton::clicked, this, [this, service] { call(service); });
    return buttons_[name] = button;
  }

  void take(const Status& status) {
    status_ = status;
    status_time_ = ros::SteadyTime::now();
  }

  void take_contacts(const mr_hand_interaction::ContactArray& message) {
    grip_ = grip_force(message, {status_.object});
    contacts_time_ = ros::SteadyTime::now();
  }

  void take_hands(const mr_hand_interaction::HandFrame& frame) {
    ++frames_;
    if (frame.hands.empty()) return;
    confidence_ = 0.0;
    for (const auto& hand : frame.hands) confidence_ = std::max<double>(confidence_, hand.confidence);
    hands_time_ = ros::SteadyTime::now();
  }

  void refresh() {
    const ros::SteadyTime now = ros::SteadyTime::now();
    if (const double passed = (now - counted_).toSec(); passed > kMaxAge) {
      rate_ = frames_ / passed;
      frames_ = 0;
      counted_ = now;
    }
    const bool silent = is_old(status_time_);
    for (const auto& button : buttons_) button.second->setEnabled(!silent && !calling_.joinable());
    const auto show = [this](const char* name, const QString& text) { lines_[name]->setText(text); };
    show("grip", is_old(contacts_time_) ? "-" : QString("%1 N").arg(grip_, 0, 'f', 1));
    show("tracking", is_old(hands_time_)
                         ? "no hand"
                         : QString("confidence %1, %2 Hz").arg(confidence_, 0, 'f', 2).arg(rate_, 0, 'f', 0));
    if (silent) {
      show("phase", "no training_node");
      return;
    }
    show("participant", QString::fromStdString(status_.participant));
    show("task", QString::fromStdString(status_.task));
    show("trial", QString("%1 of %2: %3, repetition %4")
                      .arg(status_.trial)
                      .arg(status_.trials)
                      .arg(QString::fromStdString(status_.object))
                      .arg(status_.repetition));
    show("phase",
         QString("%1, %2").arg(name_in(kPhaseNames, status_.phase)).arg(name_in(kStageNames, status_.stage)));
    show("instruction", QString::fromStdString(status_.instruction));
    show("time", QString("%1 s").arg(status_.elapsed, 0, 'f', 1));
    show("grasps", QString::number(status_.attempts));
    show("drops", QString::number(status_.drops));
    show("result", QString::fromStdString(status_.result));
    buttons_["pause"]->setText(status_.phase == Status::PAUSED ? "Go on" : "Pause");
  }

  /// One call at a time: the buttons are disabled until it returns.
  void call(const std::string& service) {
    if (calling_.joinable()) return;
    show_answer(QString::fromStdString(service) + " ...");
    const bool pause = status_.phase != Status::PAUSED;
    calling_ = std::thread([this, service, pause] {
      const QString wrong = QString::fromStdString(call_service(service, pause));
      QMetaObject::invokeMethod(
          this,
          [this, service, wrong] {
            calling_.join();
            show_answer(wrong.isEmpty() ? QString::fromStdString(service) + ": done" : wrong);
            refresh();
          },
          Qt::QueuedConnection);
    });
    refresh();
  }

  void show_answer(const QString& text) { lines_["answer"]->setText(text); }

  std::map<std::string, QLabel*> lines_;
  std::map<std::string, QPushButton*> buttons_;
  mr_hand_interaction::TrainingStatus status_;
  ros::SteadyTime status_time_, contacts_time_, hands_time_;  ///< of the last messages
  double grip_ = 0.0;        ///< on the trial's object: half the sum of the normal forces [N]
  double confidence_ = 0.0;  ///< highest confidence of the visible hands
  int frames_ = 0;           ///< frames of hands since the last refresh
  double rate_ = 0.0;        ///< of these frames [Hz]
  ros::SteadyTime counted_;
  std::vector<ros::Subscriber> subscribers_;
  std::thread calling_;
  QTimer* timer_;
};

}  // namespace mrhi

PLUGINLIB_EXPORT_CLASS(mrhi::TrainingPanel, rviz::Panel)
