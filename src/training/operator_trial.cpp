#include "operator_trial.h"

#include <yaml-cpp/yaml.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <stdexcept>

#include "../scene/solid_mesh.h"
#include "../synthetic/floating_person.h"
#include "../text/files.h"
#include "../text/text.h"
#include "../text/yaml.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/simulation.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"

namespace mrhi {
namespace {

/// Values of these keys in the YAML beside a URDF, as YAML; empty if there are none. The scene has been
/// loaded.
std::string beside(const std::string& urdf_file, const std::vector<std::string>& keys) {
  const auto file = std::filesystem::path(urdf_file).replace_extension(".yaml");
  if (!std::filesystem::exists(file)) return "";
  YAML::Node node = load_yaml_file(file.string());
  for (const std::string& key : keys) {
    if (!node[key]) return "";
    node.reset(node[key]);
  }
  return YAML::Dump(node);
}

void check_goals(const TaskObject& object, const std::vector<Goal>& goals, const Scene& scene) {
  for (const Goal& goal : goals) {
    if (goal.kind != GoalKind::joint) continue;
    const std::optional<int> index = find_joint(scene, goal.joint);
    const std::string asks = object.file + ": a goal asks for joint '" + goal.joint + "'";
    if (!index)
      throw SceneError(
          asks + ", which is not there; allowed: " +
          (scene.joints.empty() ? "none, as it has no joints" : text::joined(text::names_of(scene.joints))));
    const Joint& joint = scene.joints[*index];
    if (goal.above > joint.upper || goal.below < joint.lower)
      throw SceneError(asks + " beyond its limits; allowed: " + text::number(joint.lower) + " to " +
                       text::number(joint.upper));
  }
}

/// All links of a URDF, which must be one linkage.
void make_device(const TaskObject& object, const std::string& urdf, const SceneOptions& options,
                 ObjectModel& model) {
  if (object.twist.linear != Vector3::Zero() || object.twist.angular != Vector3::Zero())
    throw SceneError(object.file + ": '" + object.name +
                     "' is of links on joints, and has a twist; allowed: a twist of a lone body");
  model.request.whole = true;
  model.request.joints = beside(urdf, {"joints"});
  model.request.pose = object.start;
  model.scene = requested_scene(model.request, options);
  const std::optional<int> body = find_body(model.scene, object.name);
  if (!body || hanging_on(*body, model.scene).size() != model.scene.bodies.size())
    throw SceneError(object.file + ": not all hangs on a link '" + object.name +
                     "'; allowed: the name of that on which all others hang");
  model.body = *body;
}

void make_body(const TaskObject& object, const std::string& urdf, const Scene& scene, ObjectModel& model) {
  if (scene.bodies.size() != 1 || scene.bodies.front().name != object.name)
    throw SceneError(object.file + ": is not of one link '" + object.name +
                     "' with a shape, nor of links on joints; allowed in a task: these");
  model.scene = scene;
  Body& body = model.scene.bodies.front();
  body.start = object.start;
  body.start_twist = object.twist;
  model.request.name = object.name;
  model.request.material = text::one_line(beside(urdf, {"materials", object.name}));
  model.request.pose = object.start * body.link_in_body;
  model.request.twist = object.twist;
}

constexpr double kArmReach = 0.35;      // of the arm, in each direction from the object's start [m]
constexpr double kFallDistance = 0.05;  // below the stand [m]
constexpr double kHalfStand = 0.02;     // [m]
constexpr double kMinSlapSpeed =
    1.0;  // a goal whose maximum speed is at least this is a slap, else a tap [m/s]
constexpr double kMaxClosedAngle = 0.1;  // [rad]
constexpr double kMaxFlightTime = 3.5;   // longest time for which a passing object is followed [s]

/// Height of the centre of mass above the body's lowest point at the start [m].
double half_height(const Body& body) {
  const auto* box = std::get_if<Box>(&body.shapes.at(0).shape);
  if (body.shapes.size() == 1 && box != nullptr) return box->half_extents.z();
  if (body.shapes.size() == 1 && std::holds_alternative<Sphere>(body.shapes[0].shape))
    return body.bounding_radius;
  double height = 0.0;
  for (const PlacedShape& shape : body.shapes)
    for (const Vector3& corner : surface_of(shape).vertices)
      height = std::max(height, -(body.start.orientation * corner).z());
  return height;
}

bool is_place(const Goal& goal) {
  return goal.kind == GoalKind::place || goal.kind == GoalKind::insert;
}

/// The practised motion for a goal. Empty for a release, which is part of the motion that grasped the object.
std::optional<PractisedGoal> practised(const Goal& goal) {
  switch (goal.kind) {
    case GoalKind::catch_it:
      return PractisedGoal{Skilled::catch_ball};
    case GoalKind::nudge_into:
      return PractisedGoal{Skilled::nudge, goal.position};
    case GoalKind::strike:
      return PractisedGoal{goal.max_speed < kMinSlapSpeed ? Skilled::tap : Skilled::slap};
    case GoalKind::release:
      return std::nullopt;
    default:
      break;
  }
  if (goal.joint == "button_3_slide") return PractisedGoal{Skilled::press_button};
  if (goal.joint == "hatch_hinge" && goal.below < kMaxClosedAngle) return PractisedGoal{Skilled::close_hatch};
  if (goal.joint == "hatch_hinge") return PractisedGoal{Skilled::pull_hatch};
  if (goal.joint == "latch_top_axle" || goal.joint == "latch_bottom_axle")
    return PractisedGoal{Skilled::open_hatch};
  throw std::invalid_argument("a simulated operator cannot work joint '" + goal.joint +
                              "'; allowed: those of the task hatch");
}

bool is_carried(const Goal& goal) {
  return is_place(goal) || goal.kind == GoalKind::pick || goal.kind == GoalKind::release;
}

bool is_rest(const Goal& goal) {
  return goal.kind == GoalKind::rest;
}

/// A floating person's action for a goal of the task. `pick` starts the transport of the object to the place
/// of the next goal `rest`.
FloatingGoal floating(const Task& task, std::size_t index) {
  const Goal& goal = task.goals[index];
  if (goal.kind == GoalKind::joint) {
    const Skilled all = practised(goal)->skill;
    const bool latch = all == Skilled::open_hatch, top = goal.joint == "latch_top_axle";
    return {FloatingGoal::Kind::work, {}, !latch ? all : top ? Skilled::top_latch : Skilled::bottom_latch};
  }
  if (goal.kind == GoalKind::rest && goal.of_operator)
    return {FloatingGoal::Kind::rest,
            std::isfinite(goal.tolerance) ? std::optional<Vector3>(goal.position) : std::nullopt};
  const auto from = task.goals.begin() + static_cast<std::ptrdiff_t>(index);
  const auto to = std::find_if(from, task.goals.end(), [](const Goal& next) {
    return is_rest(next) && !next.of_operator && std::isfinite(next.tolerance);
  });
  if (to == task.goals.end() || (goal.kind != GoalKind::pick && !is_rest(goal)))
    throw std::invalid_argument(
        "task '" + task.name + "': beside a goal 'rest' a simulated operator does no '" +
        to_string(goal.kind) + "' there; allowed: joint, and pick and rest at a position");
  return {FloatingGoal::Kind::bring, to->position};
}

}  // namespace

ObjectModel load_object(const TaskObject& object, const std::vector<Goal>& goals,
                        const std::vector<std::string>& scene_folders, const SceneOptions& options) {
  const std::string urdf = find_scene_file(object.file, scene_folders);
  const Scene scene = load_scene(urdf, options);
  ObjectModel model;
  model.request.urdf = std::filesystem::absolute(urdf).string();  // its folder is the base of mesh paths
  if (scene.joints.empty()) {
    make_body(object, urdf, scene, model);
  } else {
    make_device(object, urdf, options, model);
  }
  check_goals(object, goals, model.scene);
  return model;
}

ObjectModel load_fixture(const Fixture& fixture, const std::vector<std::string>& scene_folders,
                         const SceneOptions& options) {
  ObjectModel model = load_object(fixture, {}, scene_folders, options);
  if (model.is_device())
    throw SceneError(fixture.file + ": the fixture '" + fixture.name +
                     "' is of links on joints; allowed: one link with a shape");
  model.scene.bodies.front().fixed = true;
  return model;
}

Scene load_surroundings(const Task& task, const std::vector<std::string>& scene_folders,
                        const SceneOptions& options) {
  if (task.scene.empty()) return {};
  const std::string urdf = find_scene_file(task.scene, scene_folders);
  Scene scene = load_scene(urdf, options);
  for (std::size_t b = scene.bodies.size(); b-- > 0;) {
    if (b >= scene.bodies.size() || scene.bodies[b].fixed || scene.bodies[b].is_operator) continue;
    remove_body(b, scene);
  }
  const bool needs_operator =
      std::any_of(task.goals.begin(), task.goals.end(), [](const Goal& goal) { return goal.of_operator; });
  if (needs_operator && scene.operators.empty())
    throw SceneError(urdf + ": has no operator, whose rest a goal of task '" + task.name +
                     "' asks for; allowed: a scene with 'operator' in its YAML file");
  return scene;
}

std::unique_ptr<Person> make_person(const OperatorSkill& skill, const Task& task, const Body& object,
                                    std::uint64_t seed, const Scene& surroundings) {
  if (std::any_of(task.goals.begin(), task.goals.end(), is_rest)) {
    std::vector<FloatingGoal> floats;
    for (std::size_t goal = 0; goal < task.goals.size(); ++goal) floats.push_back(floating(task, goal));
    return std::make_unique<FloatingPerson>(skill, std::move(floats), surroundings, object, seed);
  }
  if (std::all_of(task.goals.begin(), task.goals.end(), is_carried))
    return std::make_unique<SimulatedOperator>(skill, object, seed);
  if (std::any_of(task.goals.begin(), task.goals.end(),
                  [](const Goal& goal) { return is_carried(goal) && goal.kind != GoalKind::release; }))
    throw std::invalid_argument("task '" + task.name +
                                "': a simulated operator either carries or strikes, catches, " +
                                "nudges and works joints; allowed: goals of one of the two");
  std::vector<std::optional<PractisedGoal>> goals;
  std::transform(task.goals.begin(), task.goals.end(), std::back_inserter(goals), practised);
  return std::make_unique<PractisedPerson>(skill, std::move(goals), object, seed);
}

Body stand_under(const Body& body) {
  constexpr double kHalfRail = 0.006, kMaxFlatHeight = 0.01;
  Body stand;
  stand.name = "stand";
  stand.fixed = true;
  stand.material = body.material;
  const auto* box = std::get_if<Box>(&body.shapes.at(0).shape);
  if (box != nullptr && box->half_extents.z() < kMaxFlatHeight) {
    const Vector3 rail(kHalfRail, box->half_extents.y(), kHalfStand),
        end(box->half_extents.x() - kHalfRail, 0.0, 0.0);
    stand.shapes.push_back({Box{rail}, {end, Quaternion::Identity()}});
    stand.shapes.push_back({Box{rail}, {-end, Quaternion::Identity()}});
  } else {
    stand.shapes.push_back({Box{Vector3(0.2, 0.2, kHalfStand)}, {}});
  }
  stand.start.position = body.start.position - Vector3(0.0, 0.0, half_height(body) + kHalfStand);
  return stand;
}

Scene operator_scene(const Task& task, const TaskObject& object, const OperatorStage& stage) {
  Scene scene;
  scene.name = task.name;
  scene.gravity = task.gravity;
  const ObjectModel model = load_object(object, task.goals, stage.scene_folders, stage.scene_options);
  append(model.scene, scene);
  for (const Fixture& fixture : task.fixtures)
    append(load_fixture(fixture, stage.scene_folders, stage.scene_options).scene, scene);
  const Scene surroundings = load_surroundings(task, stage.scene_folders, stage.scene_options);
  append(surroundings, scene);
  scene.bounds = {object.start.position.array() - kArmReach, object.start.position.array() + kArmReach};
  const Vector3 end = object.start.position + kMaxFlightTime * object.twist.linear;
  scene.bounds.min = scene.bounds.min.cwiseMin((end.array() - kArmReach).matrix());
  scene.bounds.max = scene.bounds.max.cwiseMax((end.array() + kArmReach).matrix());
  if (!task.scene.empty()) scene.bounds = surroundings.bounds;
  if (task.gravity != Vector3::Zero() && !model.is_device()) {
    scene.bodies.push_back(stand_under(scene.bodies.front()));
    const Body& stand = scene.bodies.back();
    scene.bounds.min.z() = stand.start.position.z() - kHalfStand - kFallDistance;
  }
  return scene;
}

Sight sight_of(const Task& task, std::size_t goal, const Pose& object, const Twist& twist, bool held) {
  constexpr double kRimDistance = 0.05;  // distance of the hole's rim from the goal's position [m]
  Sight sight;
  sight.object = object;
  sight.twist = twist;
  sight.held = held;
  sight.gravity = task.gravity;
  sight.goal = goal;
  const auto from = task.goals.begin() + static_cast<std::ptrdiff_t>(goal);
  const auto next = std::find_if(from, task.goals.end(), is_place);
  if (next == task.goals.end()) return sight;
  sight.place = next->position;
  if (next->kind != GoalKind::insert || !next->axis) return sight;
  sight.precision = next->tolerance / 6.0;
  const Vector3 axis = next->orientation * *next->axis, off = object.position - next->position;
  const double along = off.dot(axis);
  const bool beside = (off - along * axis).norm() > next->tolerance / 4.0;
  if (beside) *sight.place += std::copysign(kRimDistance, along) * axis;
  return sight;
}

std::vector<HandJoints> hands_of(Person& person, double time, const Sight& sight, const Pose& device) {
  const HandPlace right = person.move(time, sight);
  const Pose to_device = device.inverse();
  const auto joints = [&](Side side, const HandPlace& hand) {
    return hand_joints(human_hand(), side, to_device * hand.wrist, hand.posture);
  };
  std::vector<HandJoints> hands{joints(Side::right, right)};
  if (const std::optional<HandPlace> left = person.left_hand()) {
    hands.push_back(joints(Side::left, *left));
    ++hands.back().id;
  }
  return hands;
}

void check_operator(const Task& task, const OperatorStage& stage) {
  for (const TaskObject& object : task.objects) {
    const Scene scene = operator_scene(task, object, stage);
    make_person({}, task, scene.bodies.front(), 0, scene);
  }
}

Nanoseconds play_trial(Session& session, const OperatorSkill& skill, std::uint64_t seed,
                       const OperatorStage& stage, Nanoseconds begin) {
  const Task& task = session.task();
  const Scene scene = operator_scene(task, session.object(), stage);
  Configuration configuration = stage.configuration;
  configuration.gravity = task.gravity;
  Simulation simulation(scene, configuration);
  Random seeds(seed);
  const std::unique_ptr<Person> person = make_person(skill, task, scene.bodies.front(), seeds.bits(), scene);
  TrackingNoise noise(stage.noise, seeds.bits());
  Nanoseconds stamp = begin;
  session.begin(begin);
  Observation seen = observe(simulation, 0);
  for (std::int64_t n = 0; session.phase() == SessionPhase::running; ++n) {
    stamp = begin + static_cast<Nanoseconds>(std::llround(static_cast<double>(n) * 1e9 / stage.frame_rate));
    Sight sight =
        sight_of(task, session.trial().goal(), seen.pose, seen.twist, is_held(0, simulation.state()));
    sight.grip = seen.grip_force.value_or(0.0);
    if (seen.person) sight.body = seen.person->pose, sight.body_twist = seen.person->twist;
    JointsFrame joints{stamp, hands_of(*person, to_seconds(stamp - begin), sight, Pose{})};
    noise.apply(joints);
    HandFrame frame{stamp, {}};
    for (const HandJoints& hand : joints.hands) frame.hands.push_back(complete_hand(hand, Pose{}));
    simulation.advance(frame);
    seen = observe(simulation, 0);
    session.update(seen);
  }
  return stamp;
}

}  // namespace mrhi
