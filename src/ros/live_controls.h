#pragma once

#include <dynamic_reconfigure/server.h>
#include <interactive_markers/interactive_marker_server.h>
#include <mr_hand_interaction/TuneConfig.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <visualization_msgs/InteractiveMarker.h>
#include <boost/make_shared.hpp>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../math/rotation.h"
#include "../text/text.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/simulation.h"
#include "network_thread.h"

namespace mrhi {
/// Runs long service calls in their own thread, concurrently with frames. Such a call passes its changes of
/// the simulation to run(), which executes them between two frames in the node's spinning thread.
class BetweenFrames {
 public:
  explicit BetweenFrames(const ros::NodeHandle& node) : node_(node) {}

  ~BetweenFrames() { stop(); }

  /// Drops waiting tasks; their callers get an exception. Afterwards no call runs.
  void stop() {
    {
      const std::lock_guard<std::mutex> lock(ending_mutex_);
      ends_ = true;
    }
    node_.getCallbackQueue()->removeByID(id());
    beside_.stop();
  }

  /// A node handle whose services run in the separate thread, after start().
  ros::NodeHandle node_beside(const ros::NodeHandle& node) {
    ros::NodeHandle beside(node);
    beside.setCallbackQueue(&beside_);
    return beside;
  }

  void start() { beside_.start(); }
  /// Calls `task` in the separate thread, later.
  void run_beside(const std::function<void()>& task) { beside_.run(task); }
  /// Blocks until `task` is done. Rethrows its exception; throws std::runtime_error if the node ends before.
  void run(const std::function<void()>& task) {
    std::future<void> done;
    {
      const auto job =
          std::make_shared<std::packaged_task<void()>>(task);  // a dropped one breaks its promise
      done = job->get_future();
      const std::lock_guard<std::mutex> lock(ending_mutex_);
      if (!ends_)
        node_.getCallbackQueue()->addCallback(boost::make_shared<QueuedTask>([job] { (*job)(); }), id());
    }
    try {
      done.get();
    } catch (const std::future_error&) {
      throw std::runtime_error("the node ends");
    }
  }

 private:
  std::uint64_t id() const { return reinterpret_cast<std::uintptr_t>(this); }

  ros::NodeHandle node_;
  std::mutex ending_mutex_;
  bool ends_ = false;
  BackgroundQueue beside_;
};

/// Interactive markers at ~place that move free objects. Feedback arrives in a thread; dragged() polls it.
class Placing {
 public:
  Placing(const ros::NodeHandle& private_node, const std::string& fixed_frame)
      : topic_(private_node.resolveName("place")), fixed_frame_(fixed_frame) {}

  void enable(bool on, const Simulation& simulation) {
    if (on == (server_ != nullptr)) return;
    // With a thread of its own it ends that before its publishers, to which a timer of it publishes.
    constexpr bool kOwnThread = true;
    server_ =
        on ? std::make_unique<interactive_markers::InteractiveMarkerServer>(topic_, "", kOwnThread) : nullptr;
    if (on) renew(simulation);
    const std::lock_guard<std::mutex> lock(drags_mutex_);
    drags_.clear();
  }

  bool is_on() const { return server_ != nullptr; }

  /// Call when the set of bodies has changed.
  void renew(const Simulation& simulation) {
    if (!server_) return;
    server_->clear();
    each_movable(simulation, [this](const Body& body, const Pose& pose) {
      server_->insert(marker_of(body, pose, fixed_frame_),
                      [this](const Feedback::ConstPtr& feedback) { take(*feedback); });
    });
  }

  /// Moves the markers to their bodies.
  void follow(const Simulation& simulation) {
    if (!server_) return;
    each_movable(simulation, [this](const Body& body, const Pose& pose) {
      server_->setPose(body.name, to_message(pose));
    });
  }

  /// Poses at which the mouse holds objects, as of the last kMaxSilence.
  std::map<std::string, Pose> dragged() {
    std::map<std::string, Pose> poses;
    if (!server_) return poses;
    const std::lock_guard<std::mutex> lock(drags_mutex_);
    const ros::SteadyTime silent_since = ros::SteadyTime::now() - ros::WallDuration(kMaxSilence);
    for (auto drag = drags_.begin(); drag != drags_.end();) {
      if (drag->second.last_feedback < silent_since) {
        drag = drags_.erase(drag);
        continue;
      }
      poses[drag->first] = drag->second.pose;
      ++drag;
    }
    return poses;
  }

 private:
  using InteractiveMarker = visualization_msgs::InteractiveMarker;
  using InteractiveMarkerControl = visualization_msgs::InteractiveMarkerControl;
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;

  /// rviz repeats feedback four times a second while the mouse button is down.
  static constexpr double kMaxSilence = 1.0;   // [s]
  static constexpr double kHandleScale = 2.6;  // size of the handles, over the body's radius

  template <class Use>
  void each_movable(const Simulation& simulation, const Use& use) {
    for (std::size_t b = 0; b < simulation.scene().bodies.size(); ++b) {
      const Body& body = simulation.scene().bodies[b];
      if (!body.fixed && !body.is_operator) use(body, simulation.state().bodies[b].pose);
    }
    server_->applyChanges();
  }

  /// Arrows and rings along and about the body's axes.
  static InteractiveMarker marker_of(const Body& body, const Pose& pose, const std::string& frame) {
    InteractiveMarker marker;
    marker.header.frame_id = frame;
    marker.name = body.name;
    marker.scale = static_cast<float>(kHandleScale * body.bounding_radius);
    marker.pose = to_message(pose);
    for (int axis = 0; axis < 3; ++axis) {
      InteractiveMarkerControl control;
      const Quaternion along_axis = rotation_between(Vector3::UnitX(), Vector3::Unit(axis));
      control.orientation = to_message(Pose{Vector3::Zero(), along_axis}).orientation;
      for (const bool rotates : {false, true}) {
        control.name = std::string(rotates ? "turn " : "move ") + "xyz"[axis];
        control.interaction_mode = rotates ? control.ROTATE_AXIS : control.MOVE_AXIS;
        marker.controls.push_back(control);
      }
    }
    return marker;
  }

  struct Drag {
    Pose pose;
    ros::SteadyTime last_feedback;
  };
  void take(const Feedback& feedback) {
    const std::lock_guard<std::mutex> lock(drags_mutex_);
    const auto drag = drags_.find(feedback.marker_name);
    if (feedback.event_type == Feedback::MOUSE_UP && drag != drags_.end()) drags_.erase(drag);
    if (feedback.event_type == Feedback::KEEP_ALIVE && drag != drags_.end())
      drag->second.last_feedback = ros::SteadyTime::now();
    Pose pose = from_message(feedback.pose);
    pose.orientation.normalize();
    const bool usable = pose.position.allFinite() && pose.orientation.coeffs().allFinite();
    if (feedback.event_type == Feedback::POSE_UPDATE && usable)
      drags_[feedback.marker_name] = {pose, ros::SteadyTime::now()};
  }

  std::string topic_, fixed_frame_;
  std::unique_ptr<interactive_markers::InteractiveMarkerServer> server_;
  std::mutex drags_mutex_;
  std::map<std::string, Drag> drags_;
};

/// dynamic_reconfigure at ~tune. The node checks values, so a bad one is rejected, not clamped.
class Tuning {
 public:
  using Config = mr_hand_interaction::TuneConfig;
  using Values = std::vector<std::pair<std::string, std::string>>;  ///< names and YAML, as in parameters.h
  struct Actions {
    std::function<void(const Values&)> set;         ///< sets all or none; throws std::exception
    std::function<void(bool)> place_by_mouse;       ///< turns interactive markers on or off
    std::function<const Simulation&()> simulation;  ///< the present simulation
    std::function<void(const std::function<void()>& task)> later;  ///< calls a task in another thread
  };

  Tuning(const ros::NodeHandle& private_node, bool place_by_mouse, Actions actions)
      : actions_(std::move(actions)),
        place_by_mouse_(place_by_mouse),
        server_(mutex_, ros::NodeHandle(private_node, "tune")) {
    Config min = current(), max = min;
    slider_ends(min, max);
    server_.setConfigMin(min);
    server_.setConfigMax(max);
    shown_ = current();
    server_.updateConfig(shown_);
    server_.setCallback([this](Config& requested, std::uint32_t) { take(requested); });
  }

  /// Ranges of the sliders. The limits of the parameters are wider.
  static void slider_ends(Config& min, Config& max) {
    dynamic_reconfigure::Config low = message_of(min), high = message_of(max);
    set_ends(low.ints, high.ints);
    set_ends(low.doubles, high.doubles);
    min.__fromMessage__(low);
    max.__fromMessage__(high);
  }

  /// Publishes the present values in another thread, as each number is a call to the master.
  void show() {
    shown_ = current();
    const std::lock_guard<std::mutex> lock(pending_mutex_);
    pending_ = shown_;
    actions_.later([this] { publish_update(); });
  }

 private:
  static dynamic_reconfigure::Config message_of(const Config& config) {
    dynamic_reconfigure::Config message;
    config.__toMessage__(message);
    return message;
  }

  static std::string field_of(std::string parameter) {
    std::replace(parameter.begin(), parameter.end(), '/', '_');
    return parameter;
  }

  /// Calls `use` with each field of these three types.
  template <class Message, class Use>
  static void each_field(Message&& message, const Use& use) {
    for (auto& field : message.ints) use(field);
    for (auto& field : message.doubles) use(field);
    for (auto& field : message.strs) use(field);
  }

  static std::string text_of(int value) { return std::to_string(value); }
  static std::string text_of(double value) { return text::exact(value); }
  static std::string text_of(const std::string& value) { return value; }
  static void set(const std::string& text, int& value) { value = std::atoi(text.c_str()); }
  static void set(const std::string& text, double& value) { value = std::strtod(text.c_str(), nullptr); }
  static void set(const std::string& text, std::string& value) { value = text; }

  static Vector3 gravity_of(const Config& config) {
    return {config.gravity_x, config.gravity_y, config.gravity_z};
  }

  /// YAML of the parameters in the dialog. A check box selects a word instead of a number.
  static std::map<std::string, std::string> texts_of(const Config& config) {
    std::map<std::string, std::string> texts;
    each_field(message_of(config),
               [&](const auto& field) { texts[parameter_of(field.name)] = text_of(field.value); });
    texts["gravity"] = config.gravity_of_scene ? "scene" : text::exact(gravity_of(config));
    if (config.stiffness_of_model) texts["material/stiffness"] = "model";
    if (config.filter_noise_estimated) texts["filter/noise"] = "estimated";
    return texts;
  }

  /// Parameter of a field of the dialog: gravity has one for each axis.
  static std::string parameter_of(const std::string& field) {
    for (const std::string& name : parameter_names()) {
      if (field_of(name) == field) return name;
    }
    return field.substr(0, field.rfind('_'));
  }

  template <class Field>
  static void set_ends(std::vector<Field>& low, std::vector<Field>& high) {
    for (std::size_t i = 0; i < low.size(); ++i) {
      const ParameterLimits limits = parameter_limits(parameter_of(low[i].name)).value();
      low[i].value = static_cast<decltype(low[i].value)>(limits.slider_min);
      high[i].value = static_cast<decltype(high[i].value)>(limits.slider_max);
    }
  }

  void take(Config& requested) {
    try {
      const Values values = changes(requested);
      if (!values.empty()) actions_.set(values);
      if (requested.place_by_mouse != place_by_mouse_) actions_.place_by_mouse(requested.place_by_mouse);
      place_by_mouse_ = requested.place_by_mouse;
    } catch (const std::exception& error) {
      ROS_WARN("not changed: %s", error.what());
    }
    requested = shown_ = current();
    const std::lock_guard<std::mutex> lock(pending_mutex_);
    pending_.reset();
  }

  Config current() const {
    const Simulation& simulation = actions_.simulation();
    const Configuration& configuration = simulation.configuration();
    dynamic_reconfigure::Config message = message_of(Config::__getDefault__());
    for (const std::string& name : parameter_names())
      each_field(message, [&](auto& field) {
        if (field.name == field_of(name)) set(parameter_text(configuration, name), field.value);
      });
    Config config;
    config.__fromMessage__(message);
    const Vector3 gravity = configuration.gravity.value_or(simulation.scene().gravity);
    config.gravity_of_scene = !configuration.gravity;
    config.gravity_x = gravity.x(), config.gravity_y = gravity.y(), config.gravity_z = gravity.z();
    config.filter_noise_estimated = !configuration.filter.noise;
    config.filter_noise = configuration.filter.noise.value_or(kUsualNoise);
    config.stiffness_of_model = !configuration.stiffness;
    config.material_stiffness = default_material(configuration).stiffness;
    config.place_by_mouse = place_by_mouse_;
    return config;
  }

  /// Moving a number selects it, even if its word was selected.
  Values changes(Config requested) const {
    const auto deselect = [](bool& word, bool before, bool moved) { word = word && !(before && moved); };
    deselect(requested.gravity_of_scene, shown_.gravity_of_scene,
             gravity_of(requested) != gravity_of(shown_));
    deselect(requested.stiffness_of_model, shown_.stiffness_of_model,
             requested.material_stiffness != shown_.material_stiffness);
    deselect(requested.filter_noise_estimated, shown_.filter_noise_estimated,
             requested.filter_noise != shown_.filter_noise);
    Values values;
    const auto before = texts_of(shown_);
    for (const auto& [name, text] : texts_of(requested))
      if (text != before.at(name)) values.emplace_back(name, text);
    return values;
  }

  /// Locks the mutex of the server first, as its callback may have set newer values.
  void publish_update() {
    const boost::recursive_mutex::scoped_lock server(mutex_);
    std::unique_lock<std::mutex> lock(pending_mutex_);
    const std::optional<Config> config = std::exchange(pending_, std::nullopt);
    lock.unlock();
    if (config) server_.updateConfig(*config);
  }

  Actions actions_;
  bool place_by_mouse_;
  Config shown_;
  boost::recursive_mutex mutex_;
  dynamic_reconfigure::Server<Config> server_;

  std::mutex pending_mutex_;
  std::optional<Config> pending_;  ///< to publish
};

}  // namespace mrhi
