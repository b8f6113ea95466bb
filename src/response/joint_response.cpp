#include "joint_response.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

/// A linkage none of whose points is faster than this is still [m/s]: a tenth of what a body that sleeps may
/// have (simulation/sleeping.cpp).
constexpr double kStill = 1e-6;
/// What has been still for so long sleeps [s].
constexpr double kTired = 0.5;

bool has(const Island& island, int body) {
  return island.place_of(static_cast<std::size_t>(body)) >= 0;
}

}  // namespace

JointedModel::JointedModel(const Configuration& configuration, const Scene& scene, SimulationState& state,
                           std::vector<Event>& events)
    : ImplicitModel(configuration.contact),
      scene_(scene),
      state_(state),
      events_(events),
      linkages_(linkages_of(scene)),
      awake_(linkages_.size()),
      solved_(linkages_.size()),
      usual_step_(configuration.step) {
  for (const Linkage& linkage : linkages_) {
    groups_.emplace_back();
    for (const LinkageBody& link : linkage.bodies) groups_.back().push_back(link.body);
    motions_.emplace_back(scene, linkage);
    flights_.emplace_back(scene, linkage);
  }
}

// As ImplicitModel's, with islands that have joints in their coordinates. Then the linkages' flight, which is
// theirs alone: free_flight() moves none of their bodies.
void JointedModel::respond(ContactStep& step) {
  begin_contacts(step);
  islands_.build(step);
  islands_.join(step, groups_);
  ImplicitModel::resolve_impacts(step);
  solve_islands(step);
  std::fill(awake_.begin(), awake_.end(), char(0));
  std::fill(solved_.begin(), solved_.end(), char(0));
  for (const Island& island : islands_.apart()) {
    if (!sleeps(step, island)) respond(step, island);
  }
  end_contacts(step);
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

// Where nothing acts the island is left to the flight, which has gravity and no forces: that is exact to
// its order, and keeps what moves freely from being damped by a backward Euler step.
void JointedModel::respond(ContactStep& step, const Island& island) {
  for (std::size_t i = 0; i < linkages_.size(); ++i) {
    if (!has(island, groups_[i].front())) continue;
    awake_[i] = 1;
    place(step, i);
  }
  problem_.begin(step, island, configuration_, linkages_, motions_, state_.joints, usual_step_);
  resolve_impacts(step, island);
  if (!problem_.acts()) return;
  bool agree = problem_.solve();
  if (!agree && step.operators == nullptr) problem_.keep_to_energy(step, island);
  if (!agree && step.operators != nullptr) {
    problem_.evaluate(true);  // the velocity has moved on since
    agree = true;
  }
  problem_.finish(agree, step, island, state_.joints);
  for (std::size_t i = 0; i < linkages_.size(); ++i) {
    if (has(island, groups_[i].front())) solved_[i] = 1;
  }
}

// A held island is solved once before the impact, as ImplicitModel does, to see what its springs carry away
// from the hand. The impulses of limits are reported last: start_with() begins the joints' laws anew.
void JointedModel::resolve_impacts(ContactStep& step, const Island& island) {
  linkage_impacts_.find(step, island, problem_, state_.joints, configuration_.impact_friction);
  if (linkage_impacts_.points().empty()) return;
  if (is_held(step, island)) {
    problem_.solve();
    linkage_impacts_.drop_separating(step.step, problem_.joint_velocity());
  }
  // Fingers from opposite directions have no solution by Newton's law: their springs act.
  if (!impacts_.resolve(step, linkage_impacts_.points())) return;
  problem_.start_with(linkage_impacts_.velocity(), step, state_.joints);
  linkage_impacts_.note_limits(problem_);
}

void JointedModel::fly(const ContactStep& step) {
  for (BodyContact& contact : step.body_contacts) {
    // What lies on something that hangs on joints does not go to sleep.
    if (!scene_.bodies[contact.key.b].flies ||
        (!scene_.bodies[contact.key.a].fixed && !scene_.bodies[contact.key.a].flies))
      contact.still = 0.0;
  }
  for (std::size_t i = 0; i < linkages_.size(); ++i) {
    if (!awake_[i]) continue;
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
