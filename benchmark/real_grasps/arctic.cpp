#include "arctic.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "contact_history.h"
#include "joints/joint_law.h"
#include "math/registration.h"
#include "mr_hand_interaction/replay/recording_csv.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/simulation.h"
#include "recording.h"
#include "statistics.h"

namespace mrhi::real_grasps {
namespace {

constexpr double kDrivenMass = 1e5;  // mass factor of a driven object: no hand moves it
constexpr double kFurthest = 1e3;    // no bounds: a falling object counts as away [m]

/// Calls `take` with each row of a table.
template <typename Take>
void read_rows(const std::string& file, Take take) {
  std::ifstream input(file);
  std::string line;
  if (!std::getline(input, line)) throw RecordingError(file + ": cannot be read, or is empty");
  CsvColumns row(file, line);
  for (std::size_t number = 2; std::getline(input, line); ++number) {
    row.take(line, number);
    take(row, line);
  }
}

Pose pose_in(const CsvColumns& row) {
  Pose pose{{row.required("px"), row.required("py"), row.required("pz")},
            {row.required("qw"), row.required("qx"), row.required("qy"), row.required("qz")}};
  if (!(pose.orientation.norm() > 0.5)) row.fail("qw", "a unit quaternion is needed");
  pose.orientation.normalize();
  return pose;
}

/// Index of the body whose pose is captured.
std::size_t root_of(const Scene& scene) {
  return scene.joints.empty() ? 0 : static_cast<std::size_t>(scene.joints.front().parent);
}

Window load_window(const std::string& path, const Configuration& configuration) {
  Window window;
  SceneOptions options;
  options.default_material = default_material(configuration);
  window.scene = load_scene(path + ".urdf", options);
  if (window.scene.joints.size() > 1 || window.scene.bodies.size() != window.scene.joints.size() + 1)
    throw RecordingError(path + ".urdf: a body, or two on a joint, are needed");
  window.scene.bounds = {Vector3::Constant(-kFurthest), Vector3::Constant(kFurthest)};
  window.frames = read_recording_csv(path + ".csv");
  const Pose body_in_link = window.scene.bodies.at(root_of(window.scene)).link_in_body.inverse();
  read_rows(path + "_object.csv", [&](const CsvColumns& row, const std::string&) {
    if (row.required("free") == 0.0) window.free_from = window.places.size() + 1;
    window.places.push_back(pose_in(row) * body_in_link);
    if (!window.scene.joints.empty()) window.angles.push_back(row.required("angle"));
  });
  if (window.places.size() != window.frames.size() || window.free_from + 2 > window.frames.size())
    throw RecordingError(path +
                         "_object.csv: as many frames as in the hands' file are needed, two of them free");
  return window;
}

Pose captured_pose(const Window& window, std::size_t frame, std::size_t body) {
  const Pose& root = window.places[frame];
  if (body == root_of(window.scene)) return root;
  const Joint& joint = window.scene.joints.front();
  return root * joint.in_parent * joint_motion(joint, window.angles[frame]) * joint.in_child.inverse();
}

/// At a frame.
Twist captured_twist(const Window& window, std::size_t frame, std::size_t body) {
  const std::size_t a = frame > 0 ? frame - 1 : 0, b = std::min(frame + 1, window.places.size() - 1);
  const double seconds = to_seconds(window.frames[b].stamp - window.frames[a].stamp);
  const Pose from = captured_pose(window, a, body), to = captured_pose(window, b, body);
  const Eigen::AngleAxisd turn(to.orientation * from.orientation.conjugate());
  return {(to.position - from.position) / seconds, turn.angle() / seconds * turn.axis()};
}

/// Sets the object to its captured pose, and keeps all other state.
void put(const Window& window, std::size_t frame, SimulationState state, Simulation& simulation) {
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    Body body = simulation.scene().bodies[i];
    body.start = captured_pose(window, frame, i);
    body.start_twist = captured_twist(window, frame, i);
    state.bodies[i] = start_state(body);
  }
  for (std::size_t i = 0; i < state.joints.size(); ++i) {
    Joint joint = simulation.scene().joints[i];
    joint.start = window.angles[frame];
    state.joints[i] = start_state(joint);
  }
  simulation.set_state(state);
}

bool advance(const Window& window, std::size_t frame, Simulation& simulation) {
  std::vector<std::string> left_out;
  const auto hands = complete_frame(window.frames[frame], device_mount(), left_out);
  return hands && simulation.advance(*hands) == Rejection::none;
}

/// The hands and their contacts when the object is released. Calls `look` after each frame.
template <typename Look>
SimulationState led(const Window& window, Configuration configuration, std::size_t from, Look look) {
  configuration.gravity = Vector3::Zero();
  Scene scene = window.scene;
  for (Body& body : scene.bodies) body.mass *= kDrivenMass, body.inertia *= kDrivenMass;
  Simulation simulation(scene, configuration);
  put(window, from, simulation.state(), simulation);
  for (std::size_t i = from; i <= window.free_from; ++i) {
    if (advance(window, i, simulation)) look(i, simulation.result());
    put(window, i, simulation.state(), simulation);
  }
  return simulation.state();
}

/// Positions of a hand's distal phalanges.
std::vector<Vector3> last_phalanges(const Hand& hand) {
  std::vector<Vector3> points;
  for (int finger = 0; finger < kFingers; ++finger) {
    const Capsule& bone = hand.capsules[static_cast<std::size_t>(capsule_index(finger, kBonesPerFinger - 1))];
    points.insert(points.end(), {bone.start, bone.end});
  }
  return points;
}

std::optional<Hand> hand_in(const Window& window, std::size_t frame, Side side) {
  std::vector<std::string> left_out;
  const auto hands = complete_frame(window.frames[frame], device_mount(), left_out);
  if (!hands) return std::nullopt;
  const auto hand = std::find_if(hands->hands.begin(), hands->hands.end(),
                                 [side](const Hand& candidate) { return candidate.side == side; });
  return hand == hands->hands.end() ? std::nullopt : std::optional<Hand>(*hand);
}

/// Error of an object that moves rigidly with one hand's distal phalanges. A missing hand carries nothing.
std::vector<double> away_with(const Window& window, Side side) {
  std::vector<double> away(window.places.size() - window.free_from - 1, kFurthest);
  const auto first = hand_in(window, window.free_from, side);
  if (!first) return away;
  const std::vector<Vector3> from = last_phalanges(*first);
  for (std::size_t i = 0; i < away.size(); ++i) {
    const std::size_t frame = window.free_from + 1 + i;
    const auto hand = hand_in(window, frame, side);
    if (!hand) continue;
    const std::vector<Vector3> to = last_phalanges(*hand);
    const auto carried = registered(from.data(), to.data(), from.size());
    if (!carried) continue;
    const Vector3 arm = window.places[window.free_from].position - carried->from;
    away[i] = (carried->to + carried->rotation * arm - window.places[frame].position).norm();
  }
  return away;
}

void add_frames(const WindowOutcome& outcome, double limit, double angle, SuccessCount& sum) {
  sum.trials += outcome.away.size();
  for (std::size_t i = 0; i < outcome.away.size(); ++i)
    sum.successes += outcome.away[i] < limit && (outcome.turned.empty() || outcome.turned[i] < angle);
}

std::map<std::string, SuccessCount> by_capture(const std::vector<WindowOutcome>& outcomes, double limit) {
  std::map<std::string, SuccessCount> shares;
  for (const WindowOutcome& outcome : outcomes)
    add_frames(outcome, limit, std::numeric_limits<double>::infinity(), shares[outcome.labels.capture]);
  return shares;
}

/// The cells after the name of a row of windows.csv that are words: set, person and object, where they are
/// there.
WindowLabels labels_of(const std::string& name, const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    if (!cell.empty() && cell.back() == '\r') cell.pop_back();
    cells.push_back(cell);
  }
  cells.resize(6);
  return {name.substr(0, name.rfind('_')), cells[4], cells[5]};
}

}  // namespace

std::vector<Window> load_windows(const std::string& folder, const Configuration& configuration) {
  std::vector<Window> windows;
  read_rows(folder + "/windows.csv", [&](const CsvColumns&, const std::string& line) {
    const std::string name = line.substr(0, line.find(','));
    windows.push_back(load_window(folder + "/" + name, configuration));
    windows.back().name = name;
    windows.back().labels = labels_of(name, line);
  });
  return windows;
}

std::size_t last_clear(const Window& window, const Configuration& configuration) {
  std::size_t clear = 0;
  led(window, configuration, 0, [&](std::size_t frame, const FrameResult& result) {
    const bool touches = std::any_of(result.contacts.begin(), result.contacts.end(),
                                     [](const Contact& contact) { return contact.depth > 0.0; });
    if (!touches) clear = frame;
  });
  return clear;
}

WindowOutcome play(const Window& window, const Configuration& configuration, std::optional<double> lead) {
  std::size_t from = 0;
  if (lead) {
    const Nanoseconds begin = window.frames[window.free_from].stamp - std::llround(1e9 * *lead);
    while (window.frames[from].stamp < begin) ++from;
  } else {
    from = last_clear(window, configuration);
  }
  Simulation simulation(window.scene, configuration);
  const auto look = [](std::size_t, const FrameResult&) {};
  put(window, window.free_from, led(window, configuration, from, look), simulation);
  WindowOutcome outcome;
  outcome.labels = window.labels;
  for (std::size_t i = window.free_from + 1; i < window.frames.size(); ++i) {
    if (advance(window, i, simulation)) add_finger_forces(simulation.result(), outcome.forces);
    const SimulationState& state = simulation.state();
    const Vector3& place = state.bodies[root_of(window.scene)].pose.position;
    outcome.away.push_back((place - window.places[i].position).norm());
    if (!state.joints.empty())
      outcome.turned.push_back(std::abs(state.joints.front().position - window.angles[i]));
  }
  return outcome;
}

WindowOutcome play_rigidly(const Window& window) {
  WindowOutcome right{away_with(window, Side::right), {}, {}, window.labels},
      left{away_with(window, Side::left), {}, {}, window.labels};
  constexpr double kNear = 0.02;  // the tightest reported limit [m]
  return fraction_within({right}, kNear) < fraction_within({left}, kNear) ? left : right;
}

double fraction_within(const std::vector<WindowOutcome>& outcomes, double limit, double angle) {
  SuccessCount sum;
  for (const WindowOutcome& outcome : outcomes) add_frames(outcome, limit, angle, sum);
  return sum.trials > 0 ? static_cast<double>(sum.successes) / static_cast<double>(sum.trials) : 0.0;
}

Interval fraction_interval(const std::vector<WindowOutcome>& outcomes, double limit) {
  std::vector<SuccessCount> shares;
  for (const auto& [capture, share] : by_capture(outcomes, limit)) shares.push_back(share);
  return bootstrapped(shares);
}

Interval difference_interval(const std::vector<WindowOutcome>& outcomes,
                             const std::vector<WindowOutcome>& baseline, double limit) {
  std::vector<SuccessCount> shares, of_baseline;
  const auto others = by_capture(baseline, limit);
  for (const auto& [capture, share] : by_capture(outcomes, limit)) {
    shares.push_back(share);
    of_baseline.push_back(others.at(capture));
  }
  return bootstrapped(shares, of_baseline);
}

std::map<std::string, std::vector<WindowOutcome>> by_label(const std::vector<WindowOutcome>& outcomes,
                                                           std::string WindowLabels::*label) {
  std::map<std::string, std::vector<WindowOutcome>> groups;
  for (const WindowOutcome& outcome : outcomes) groups[outcome.labels.*label].push_back(outcome);
  return groups;
}

std::size_t stayed(const std::vector<WindowOutcome>& outcomes, double limit) {
  return static_cast<std::size_t>(
      std::count_if(outcomes.begin(), outcomes.end(), [limit](const auto& outcome) {
        return *std::max_element(outcome.away.begin(), outcome.away.end()) < limit;
      }));
}

double force_p90(const std::vector<WindowOutcome>& outcomes) {
  std::vector<double> forces;
  for (const WindowOutcome& outcome : outcomes)
    forces.insert(forces.end(), outcome.forces.begin(), outcome.forces.end());
  return quantile(forces, 0.9);
}

}  // namespace mrhi::real_grasps
