#include "mr_hand_interaction/ros/interaction_server.h"

#include <mr_hand_interaction/DeleteObject.h>
#include <mr_hand_interaction/SaveWorld.h>
#include <mr_hand_interaction/SetParameter.h>
#include <mr_hand_interaction/SpawnObject.h>
#include <mr_hand_interaction/SpawnUrdf.h>
#include <ros/ros.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <cinttypes>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../record/duration_histogram.h"
#include "../text/text.h"
#include "../text/yaml.h"
#include "input_log.h"
#include "input_statistics.h"
#include "live_controls.h"
#include "mr_hand_interaction/live_simulation.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "mr_hand_interaction/scene/save_scene.h"
#include "node.h"
#include "result_messages.h"
#include "result_publisher.h"

namespace mrhi {
namespace {

constexpr int kHandQueue = 10;
constexpr Nanoseconds kNoTime = std::numeric_limits<Nanoseconds>::min();  // before all others
constexpr Nanoseconds kSteppedClock = 10'000'000'000;                     // no scene is so slow in a frame
constexpr Nanoseconds kMaxDelay = 100'000'000;                            // of a frame's arrival
const ros::WallDuration kIdlePeriod(1.0 / 30);

/// Keeps the scene's own gravity, as the configuration's may be removed later.
SceneOptions options_of(const Configuration& configuration) {
  SceneOptions options = scene_options(configuration);
  options.gravity.reset();
  options.is_cancelled = [] { return ros::isShuttingDown(); };
  return options;
}

/// One parameter, or for a request without a name all of the map that is its value.
Tuning::Values values_of(const mr_hand_interaction::SetParameter::Request& request) {
  if (!request.name.empty()) return {{request.name, request.value}};
  return read_yaml<ParameterError>("value", [&] {
    const YAML::Node map = load_yaml("value", request.value);
    if (!map.IsMap() || map.size() == 0)
      throw ParameterError("value: " + text::one_line(yaml_text(map), 60) +
                           " is not allowed without a name; allowed: a map of names and values");
    Tuning::Values values;
    for (const auto& entry : map) values.emplace_back(yaml_text(entry.first), yaml_text(entry.second));
    return values;
  });
}

/// An object's pose is in tf by its name: a tracker in a frame of that name would move with the object.
void require_no_frames(const Scene& scene, const std::string& fixed_frame) {
  for (const std::string& frame : {without_slash(fixed_frame), std::string("leap_hands")}) {
    if (const auto body = find_body(scene, frame); body && !scene.bodies[*body].fixed)
      throw std::invalid_argument("object '" + frame + "': this name is not allowed; allowed: any but '" +
                                  frame + "', which is a frame in tf");
  }
}

Scene scene_of(const ServerParameters& parameters) {
  Scene scene =
      load_scene(find_scene_file(parameters.scene, scene_folders()), options_of(parameters.configuration));
  require_no_frames(scene, parameters.fixed_frame);
  for (const auto& [name, twist] : parameters.object_twists) free_body(scene, name).start_twist = twist;
  return scene;
}

World world_of(const ServerParameters& parameters, const Scene& scene) {
  for (const std::string& warning : scene.warnings) ROS_WARN("%s", warning.c_str());
  World world =
      world_of_file(find_scene_file(parameters.scene, scene_folders()), scene, parameters.configuration);
  world.twists = parameters.object_twists;
  return world;
}

}  // namespace

struct InteractionServer::Impl {
  Impl(ros::NodeHandle node, ros::NodeHandle private_node, const ServerParameters& parameters)
      : between_frames_(node),
        fixed_frame_(parameters.fixed_frame),
        live_(scene_of(parameters), parameters.configuration),
        log_(node, world_of(parameters, live_.simulation().scene()), live_, clock_),
        results_(node, fixed_frame_, parameters.haptics_rate, clock_),
        diagnostics_(node, private_node, "scene " + live_.simulation().scene().name, "interaction", {}, {},
                     [this](auto& status) { report(status); }),
        placing_(private_node, fixed_frame_),
        tuning_(private_node, parameters.place_by_mouse,
                {[this](const Tuning::Values& values) { change_parameters(values); },
                 [this](bool on) { placing_.enable(on, live_.simulation()); },
                 [this]() -> const Simulation& { return live_.simulation(); },
                 [this](const auto& task) { between_frames_.run_beside(task); }}) {
    // Separate: all values of the other status are numbers, and a hash is not.
    diagnostics_.add("state", [this](auto& status) { report_state(status); });
    if (parameters.standard_outputs) results_.add_standard_outputs(node);
    results_.show(live_.simulation());
    placing_.enable(parameters.place_by_mouse, live_.simulation());
    advertise_services(private_node);
    between_frames_.start();
    idle_timer_ = node.createSteadyTimer(kIdlePeriod, [this](const ros::SteadyTimerEvent&) { idle(); });
  }

  /// Stops calls before the members that they use are destroyed.
  ~Impl() { between_frames_.stop(); }

  void subscribe(ros::NodeHandle& node) {
    hands_ = node.subscribe("hand_frame", kHandQueue, &Impl::take_message, this,
                            ros::TransportHints().tcpNoDelay());
  }

  void take_message(const ros::MessageEvent<const mr_hand_interaction::HandFrame>& arrival) {
    const auto& message = *arrival.getConstMessage();
    note_lost(sequences_.missing(arrival.getPublisherName(), message.header.seq));
    try {
      take(from_message(message), message.header.frame_id, arrival.getReceiptTime());
    } catch (const std::invalid_argument& error) {
      diagnostics_.rejected("unusable hand", error.what());
    }
  }

  void take(HandFrame frame, const std::string& frame_id, const ros::Time& arrival) {
    const Nanoseconds stamp = frame.stamp;
    if (clock_.paused()) {
      const StampVerdict verdict = while_paused_.check(stamp);
      if (verdict == StampVerdict::follows || verdict == StampVerdict::restart)
        clock_.take(stamp, ros::Time::now());
      ++dropped_while_paused_;
      return;
    }
    if (without_slash(frame_id) != without_slash(fixed_frame_))
      return diagnostics_.rejected("wrong frame",
                                   "'" + text::one_line(frame_id, 64) + "'; allowed: " + fixed_frame_);
    if (stamp > StampCheck::kLatest) return reject(Rejection::no_stamp, stamp);
    const SimulationState& state = live_.simulation().state();
    clock_.limit_pauses(stamp, state.time);
    frame.stamp = clock_.to_simulation(stamp);
    Nanoseconds expected = clock_.to_simulation(clock_.stamp(ros::Time::now()));
    if (StampCheck(state.stamps).check(frame.stamp, state.time, expected) == StampVerdict::follows) {
      const Nanoseconds left_out = leave_out_before(frame.stamp, kNoTime);
      frame.stamp -= left_out;
      expected = std::max(expected - left_out, frame.stamp);  // confirmed above, as the whole gap
    }
    Rejection rejection = Rejection::none;
    measured([&] {
      rejection = live_.simulation().begin(frame, expected);
      if (rejection != Rejection::none) return;
      while (step_times_.measure([&] { return live_.simulation().step(); })) results_.note_step();
    });
    if (rejection != Rejection::none) {
      log_.frame(std::move(frame), frame_id, expected);
      return reject(rejection, stamp);
    }
    results_.publish_response(live_.simulation().report());
    const FrameResult& result = live_.simulation().end();
    log_.frame(std::move(frame), frame_id, expected);
    place_dragged();
    for (const std::string& what : result.not_finite) diagnostics_.rejected("not finite", what);
    results_.publish_picture(result);
    const ros::Time now = ros::Time::now();
    if (ros::Time::isSystemTime()) picture_latency_.add(from_ros_time(now) - from_ros_time(arrival));
    diagnostics_.waited(seconds_between(arrival, now));
    diagnostics_.taken(to_seconds(from_ros_time(now) - stamp));
    clock_.take(stamp, now);
    taken_ = ros::SteadyTime::now();
  }

  void reject(Rejection rejection, Nanoseconds stamp) {
    diagnostics_.rejected(to_string(rejection), std::to_string(to_seconds(stamp)) + " s");
  }

  /// Notes what the simulation of `work` costs.
  template <class Work>
  void measured(Work work) {
    const bool started = live_.simulation().state().started;
    const Nanoseconds from = live_.simulation().time();
    const ros::SteadyTime begin = ros::SteadyTime::now();
    work();
    if (started) cost_.note(live_.simulation().time() - from, ros::SteadyTime::now() - begin);
  }

  /// Leaves out time before `time` that is too long to simulate now, but nothing up to a step after
  /// `earliest`: a scene slower than real time would have ever more to simulate. Returns the time left out.
  Nanoseconds leave_out_before(Nanoseconds time, Nanoseconds earliest) {
    const Simulation& simulation = live_.simulation();
    if (!simulation.state().started) return 0;
    const Nanoseconds reached = std::max(simulation.time() + cost_.affordable(), earliest);
    const Nanoseconds left_out = time - reached - to_nanoseconds(simulation.configuration().step);
    if (left_out <= 0) return 0;
    clock_.leave_out(left_out);
    diagnostics_.rejected("slower than real time",
                          text::number(1e3 * to_seconds(left_out)) +
                              " ms are left out; allowed: fewer bodies, longer steps" +
                              (left_out > kSteppedClock ? ", a tracker whose clock does not step" : ""));
    return left_out;
  }

  /// Time up to which hands of the last frame stay where they are, once no frame has come for that long;
  /// kNoTime until then. In a slow scene the last frame's stamp is old while others wait.
  Nanoseconds end_of_hold() const {
    const Simulation& simulation = live_.simulation();
    const double hold = simulation.configuration().tracking.hold_time;
    if ((ros::SteadyTime::now() - taken_).toSec() < hold) return kNoTime;
    return simulation.state().last_frame + to_nanoseconds(hold);
  }

  void note_lost(std::uint64_t frames) {
    diagnostics_.lost(frames);
    log_.lost(diagnostics_.lost());
  }

  /// `work` returns a description of its change, or throws the reason for refusing it.
  template <class Service, class Work>
  void serve(ros::NodeHandle& node, const char* name, Work work) {
    services_.push_back(mrhi::serve<Service>(node, name, [work](const auto& request, auto& response) {
      try {
        response.message = work(request);
        response.success = true;
      } catch (const std::exception& error) {
        response.message = error.what();
        response.success = false;
        ROS_WARN("refused: %s", error.what());
      }
    }));
  }

  void advertise_services(ros::NodeHandle& node) {
    using namespace mr_hand_interaction;
    serve<std_srvs::Trigger>(node, "reset", [this](auto&) { return reset(); });
    serve<std_srvs::SetBool>(node, "pause", [this](auto& request) { return pause(request.data); });
    serve<std_srvs::SetBool>(node, "restrain", [this](auto& request) {
      apply(Restrain{request.data != 0});
      return std::string(request.data != 0 ? "restrained" : "free");
    });
    serve<SaveWorld>(node, "save", [this](auto& request) { return save(request.file); });
    serve<DeleteObject>(node, "delete", [this](auto& request) { return remove(request.name); });
    serve<SetParameter>(node, "set", [this](auto& request) { return set(request); });
    ros::NodeHandle beside = between_frames_.node_beside(node);
    serve<SpawnObject>(beside, "spawn", [this](auto& request) { return spawn(from_message(request)); });
    serve<SpawnUrdf>(beside, "spawn_urdf", [this](auto& request) { return spawn(from_message(request)); });
  }

  void report(diagnostic_updater::DiagnosticStatusWrapper& status) {
    status.add("frames dropped while paused", dropped_while_paused_);
    status.add("steps in this period", step_times_.count());
    status.add("step time p50 [us]", step_times_.quantile_us(0.5));
    status.add("step time p99 [us]", step_times_.quantile_us(0.99));
    status.add("step time max [us]", step_times_.max_us());
    status.add("hand to picture p50 [ms]", 1e-3 * picture_latency_.quantile_us(0.5));
    status.add("hand to picture p99 [ms]", 1e-3 * picture_latency_.quantile_us(0.99));
    step_times_.clear();
    picture_latency_.clear();
  }

  void report_state(diagnostic_updater::DiagnosticStatusWrapper& status) const {
    status.summary(diagnostic_msgs::DiagnosticStatus::OK, "as of the last input");
    status.add("state hash", text::format("%016" PRIx64, hash(live_.simulation().state())));
    status.add("state stamp [ns]", clock_.to_stamp(live_.simulation().state().time));
    status.add("simulation input", log_.sequence());
  }

  void idle() {
    const ros::Time now = ros::Time::now();
    if (clock_leaps_.detect(from_ros_time(now))) return;
    const Nanoseconds stamp = clock_.stamp(now);
    const bool running = !clock_.paused() && live_.simulation().state().started;
    Nanoseconds until = clock_.to_simulation(stamp) - kMaxDelay;
    const ros::WallDuration since = ros::SteadyTime::now() - results_.shown();
    ros::WallDuration next = kIdlePeriod;
    if (running) until -= leave_out_before(until, end_of_hold());
    bool advanced = false;
    if (running) measured([&] { advanced = live_.simulation().advance_without_hands(until); });
    if (advanced) {
      log_.without_hands(until);
      place_dragged();
      results_.publish(live_.simulation().result());
    } else if (since > kIdlePeriod * 0.5) {
      place_dragged();
      results_.publish_scene(live_.simulation().result(), to_ros_time(stamp));
    } else if (!placing_.is_on()) {  // frames come: check again when the next ones are overdue
      next = ros::WallDuration(to_seconds(kMaxDelay)) - since;
    }
    placing_.follow(live_.simulation());
    if (next != std::exchange(idle_period_, next)) idle_timer_.setPeriod(next);
  }

  std::string reset() {
    apply(Reset{});
    results_.show(live_.simulation());
    FrameResult start;
    start.stamp = clock_.to_simulation(clock_.stamp(ros::Time::now()));
    results_.publish(start);
    return "scene " + live_.simulation().scene().name + " is at its start";
  }

  std::string pause(bool paused) {
    if (!clock_.paused()) while_paused_ = clock_.check();
    paused ? clock_.pause(ros::Time::now()) : clock_.resume(ros::Time::now());
    apply(Pause{paused});
    return paused ? "paused" : "running";
  }

  /// Returns the added object and assumptions about it. Runs beside frames: reading files takes long.
  std::string spawn(const ObjectRequest& request) {
    SceneOptions options;
    between_frames_.run([&] { options = options_of(live_.simulation().configuration()); });
    Spawn spawn{with_file_read(request, options)};
    spawn.prepared = std::make_shared<const PreparedSpawn>(spawn.request, options);
    const Scene& part = spawn.prepared->part;
    require_no_frames(part, fixed_frame_);
    if (!spawn.request.whole) spawn.request.name = part.bodies.front().name;
    InputLog::SimulationInput input;
    const Change change = spawn;
    between_frames_.run([&] {
      apply_change(change, live_);
      input = log_.note_change(change);
      show_change();
    });
    log_.send(std::move(input), files_of(change));
    std::vector<std::string> names;
    for (const Body& body : part.bodies) names.push_back("'" + body.name + "'");
    std::string text = text::joined(names) + (names.size() > 1 ? " are there" : " is there");
    for (const std::string& warning : part.warnings) {
      ROS_WARN("%s", warning.c_str());
      text += "; " + warning;
    }
    return text;
  }

  /// Saving does not change the simulation, so it is not recorded.
  std::string save(const std::string& file) {
    if (file.empty() || file.front() != '/')
      throw std::invalid_argument("file '" + text::one_line(file, 200) +
                                  "' is not allowed; allowed: an absolute path");
    const SimulationState& state = live_.simulation().state();
    Scene now = scene_as_it_is(live_.simulation().scene(), state.bodies, state.joints);
    if (const auto& gravity = live_.simulation().configuration().gravity) now.gravity = *gravity;
    save_scene(now, file);
    return "'" + file + "' is written";
  }

  std::string remove(const std::string& name) {
    apply(Delete{name});
    show_change();
    return "'" + name + "' is gone";
  }

  std::string set(const mr_hand_interaction::SetParameter::Request& request) {
    const Tuning::Values values = values_of(request);
    change_parameters(values);
    tuning_.show();
    std::vector<std::string> now;
    for (const auto& [name, value] : values) now.push_back(name + " is " + live_.parameter(name));
    return text::joined(now);
  }

  /// Applies and logs a change of the simulation. All changes but spawn() use this function.
  void apply(const Change& change) {
    results_.publish_events(events_ended_by(change, live_));
    apply_change(change, live_);
    log_.send(log_.note_change(change), {});
  }

  void change_parameters(const Tuning::Values& values) {
    apply(SetParameters{values});
    show_change();
  }

  /// Call after the simulation was replaced, perhaps with other bodies. Rapid changes are shown together, by
  /// the next frame or idle(): a scene of many objects costs more to show than to change.
  void show_change() {
    results_.show(live_.simulation());
    if (ros::SteadyTime::now() - results_.shown() > kIdlePeriod)
      results_.publish_scene(live_.simulation().result(), to_ros_time(clock_.stamp(ros::Time::now())));
    placing_.renew(live_.simulation());
  }

  void place_dragged() {
    for (const auto& [name, pose] : placing_.dragged()) {
      try {
        apply(PlaceObject{name, pose});
      } catch (const std::invalid_argument&) {
        // The mouse is out of bounds, or its object is gone: the last valid state stays.
      }
    }
  }

  BetweenFrames between_frames_;  ///< first member: a service must not outlive its queue
  std::string fixed_frame_;
  LiveSimulation live_;
  StampClock clock_;
  SimulationCost cost_;
  ros::SteadyTime taken_;  ///< when the last frame's results were sent
  ClockLeaps clock_leaps_;
  InputLog log_;
  StampCheck while_paused_;  ///< of frames during a pause; the simulation checks all others
  ResultPublisher results_;
  NodeDiagnostics diagnostics_;
  DurationHistogram step_times_, picture_latency_;  ///< since the last report; from the hand's arrival
  std::uint64_t dropped_while_paused_ = 0;
  Placing placing_;
  Tuning tuning_;

  SequenceWatch sequences_;
  ros::Subscriber hands_;
  std::vector<ros::ServiceServer> services_;
  ros::WallDuration idle_period_ = kIdlePeriod;
  ros::SteadyTimer idle_timer_;
};

InteractionServer::InteractionServer(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                                     const ServerParameters& parameters)
    : impl_(std::make_unique<Impl>(node, private_node, parameters)) {}

InteractionServer::~InteractionServer() = default;

void InteractionServer::subscribe(ros::NodeHandle& node) {
  impl_->subscribe(node);
}

void InteractionServer::take(HandFrame frame, const std::string& frame_id, const ros::Time& arrival) {
  impl_->take(std::move(frame), frame_id, arrival);
}

void InteractionServer::note_lost(std::uint64_t frames) {
  impl_->note_lost(frames);
}

}  // namespace mrhi
