#include "joint_response.h"

#include <algorithm>
#include <cmath>

#include "newton.h"

namespace mrhi {
namespace {

/// A linkage none of whose points is faster than this is still [m/s]: a tenth of what a body that sleeps may
/// have (simulation/sleeping.cpp).
constexpr double kStill = 1e-6;
/// What has been still for so long sleeps [s].
constexpr double kTired = 0.5;

bool has(const Island& island, int body) {
  return std::any_of(island.bodies.begin(), island.bodies.end(),
                     [body](const IslandBody& one) { return static_cast<int>(one.body) == body; });
}

}  // namespace

JointedModel::JointedModel(const Configuration& configuration, const Scene& scene, SimulationState& state,
                           std::vector<Event>& events)
    : ImplicitModel(configuration.contact),
      scene_(scene),
      state_(state),
      events_(events),
      linkages_(linkages_of(scene)),
      at_work_(linkages_.size()),
      solved_(linkages_.size()) {
  for (const Linkage& linkage : linkages_) {
    groups_.emplace_back();
    for (const LinkageBody& link : linkage.bodies) groups_.back().push_back(link.body);
    motions_.emplace_back(scene, linkage);
    flights_.emplace_back(scene, linkage);
    problems_.push_back(std::make_unique<LinkageProblem>(configuration.step));
  }
}

// As ImplicitModel's, for what hangs on joints in their coordinates: blows of what flies, blows of linkages,
// springs of what flies, springs of linkages. Then the linkages' flight, which is theirs alone: free_flight()
// moves none of their bodies.
void JointedModel::respond(ContactStep& step) {
  begin_touches(step);
  islands_.build(step);
  islands_.join(step, groups_);
  ImplicitModel::strike(step);
  begin(step);
  press(step);
  solve(step);
  fly(step);
}

/// It has lain still for long, and nothing has pushed it since.
bool JointedModel::sleeps(const ContactStep& step, const Island& island) const {
  if (!configuration_.sleep || is_touched(step, island)) return false;
  const auto moves = [&](const IslandBody& body) {
    const BodyState& state = step.bodies[body.body];
    return !state.linear_momentum.isZero(0.0) || !state.angular_momentum.isZero(0.0);
  };
  if (std::any_of(island.bodies.begin(), island.bodies.end(), moves)) return false;
  for (std::size_t i = 0; i < linkages_.size(); ++i) {
    if (!has(island, groups_[i].front())) continue;
    return state_.joints[static_cast<std::size_t>(linkages_[i].bodies.back().joint)].still >= kTired;
  }
  return false;
}

/// Where its joints have it now.
/// Poses are made of the joints' places, M of the poses: in this order.
void JointedModel::place(const ContactStep& step, std::size_t index) {
  const Linkage& linkage = linkages_[index];
  positions_.resize(linkage.joints());
  int joint = 0;
  for (const LinkageBody& link : linkage.bodies) {
    if (link.joint != LinkageBody::kNone)
      positions_[joint++] = state_.joints[static_cast<std::size_t>(link.joint)].position;
  }
  motions_[index].place(step.bodies[static_cast<std::size_t>(groups_[index].front())].pose, positions_);
  motions_[index].weigh();
}

// One problem for each island that is awake, each with M of its linkages at the step's start.
void JointedModel::begin(ContactStep& step) {
  islands_apart_.clear();
  std::fill(at_work_.begin(), at_work_.end(), char(0));
  std::fill(solved_.begin(), solved_.end(), char(0));
  for (const Island& island : islands_.apart()) {
    if (sleeps(step, island)) continue;
    for (std::size_t i = 0; i < linkages_.size(); ++i) {
      if (!has(island, groups_[i].front())) continue;
      at_work_[i] = 1;
      place(step, i);
    }
    LinkageProblem& problem = *problems_[islands_apart_.size()];
    islands_apart_.push_back(&island);
    problem.begin(step, island, configuration_, linkages_, motions_, state_.joints);
    strike(step, island, problem);
  }
}

// A held island is solved once before the impact, as ImplicitModel does, to see what its springs carry away
// from the hand. The impulses of limits are reported last: start_with() begins the joints' laws anew.
void JointedModel::strike(ContactStep& step, const Island& island, LinkageProblem& problem) {
  linkage_impacts_.find(step, island, problem, state_.joints, configuration_.impact_friction);
  if (linkage_impacts_.points().empty()) return;
  if (is_held(step, island)) {
    Newton<LinkageProblem>(problem).solve();
    linkage_impacts_.drop_separating(step.step, problem.velocity());
  }
  // Fingers from opposite directions have no solution by Newton's law: they press.
  if (!impacts_.resolve(step, linkage_impacts_.points())) return;
  problem.start_with(linkage_impacts_.velocity(), step, state_.joints);
  linkage_impacts_.note_limits(problem);
}

// Where nothing acts the island is left to the flight, which has gravity and no forces: that is exact to
// its order, and keeps what moves freely from being damped by a backward Euler step.
void JointedModel::solve(ContactStep& step) {
  for (std::size_t i = 0; i < islands_apart_.size(); ++i) {
    const Island& island = *islands_apart_[i];
    LinkageProblem& problem = *problems_[i];
    if (!problem.acts()) continue;
    bool agree = Newton<LinkageProblem>(problem).solve();
    if (!agree && step.operators == nullptr) problem.keep_to_energy(step, island);
    if (!agree && step.operators != nullptr) {
      problem.evaluate(true);  // it has moved on since
      agree = true;
    }
    problem.finish(agree, step, island, state_.joints);
    for (std::size_t l = 0; l < linkages_.size(); ++l) {
      if (has(island, groups_[l].front())) solved_[l] = 1;
    }
  }
}

void JointedModel::fly(const ContactStep& step) {
  for (BodyContact& contact : step.body_contacts) {
    // What lies on something that hangs on joints does not go to sleep.
    if (!scene_.bodies[contact.key.b].flies ||
        (!scene_.bodies[contact.key.a].fixed && !scene_.bodies[contact.key.a].flies))
      contact.still = 0.0;
  }
  for (std::size_t i = 0; i < linkages_.size(); ++i) {
    if (!at_work_[i]) continue;
    // Where the island was solved gravity is in the momenta already; given again it would count twice.
    flights_[i].fly(solved_[i] ? Vector3(Vector3::Zero()) : step.gravity, step.step, state_.joints,
                    step.bodies);
    rest(step, i);
    for (const LinkageBody& link : linkages_[i].bodies) {
      step.changes.forget(link.body);
      if (link.joint != LinkageBody::kNone) note(static_cast<std::size_t>(link.joint));
    }
  }
}

/// Only what forces of its own hold in its place may lie still: what moves freely, moves, however slowly.
///
///     |v| + R |w| < 1 um/s of all its bodies, R the bounding radius, for half a second
void JointedModel::rest(const ContactStep& step, std::size_t linkage) {
  bool still = solved_[linkage] && !linkages_[linkage].floats();
  for (const LinkageBody& link : linkages_[linkage].bodies) {
    const auto b = static_cast<std::size_t>(link.body);
    const Twist twist = twist_of(scene_.bodies[b], step.bodies[b]);
    still = still && twist.linear.norm() + scene_.bodies[b].bounding_radius * twist.angular.norm() < kStill;
  }
  bool tired = still;
  for (const LinkageBody& link : linkages_[linkage].bodies) {
    if (link.joint == LinkageBody::kNone) continue;
    double& lasted = state_.joints[static_cast<std::size_t>(link.joint)].still;
    lasted = still ? lasted + step.step : 0.0;
    tired = tired && lasted >= kTired;
  }
  if (!tired) return;
  for (const int body : groups_[linkage]) {
    step.bodies[static_cast<std::size_t>(body)].linear_momentum.setZero();
    step.bodies[static_cast<std::size_t>(body)].angular_momentum.setZero();
  }
}

void JointedModel::note(std::size_t index) {
  const JointChange change = note_place(scene_.joints[index], state_.joints[index]);
  const auto tell = [&](bool happened, EventKind kind) {
    if (happened) events_.push_back({state_.time, kind, scene_.joints[index].child, 0});
  };
  tell(change.reached_limit, EventKind::joint_limit);
  tell(change.entered_detent, EventKind::detent);
  tell(change.opened_latch, EventKind::latch_open);
}

}  // namespace mrhi
