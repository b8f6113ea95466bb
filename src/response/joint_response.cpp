#include "joint_response.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

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

// As ImplicitModel's, with islands that have joints in joint coordinates. Then linkages are advanced:
// free_flight() skips their bodies.
void JointedModel::respond(ContactStep& step) {
  begin_contacts(step);
  islands_.build(step, groups_);
  ImplicitModel::resolve_impacts(step);
  solve_islands(step);
  std::fill(awake_.begin(), awake_.end(), char(0));
  std::fill(solved_.begin(), solved_.end(), char(0));
  for (const Island& island : islands_.with_joints()) {
    if (!state_.asleep[island.bodies.first->body]) respond(step, island);
  }
  end_contacts(step);
  fly(step);
}

/// Places a linkage by its joint positions, and computes its mass matrix.
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

// If nothing acts, the island is left to the flight, which has gravity and no forces. This is exact to the
// flight's order, and free motion is not damped by a backward Euler step.
void JointedModel::respond(ContactStep& step, const Island& island) {
  for (std::size_t i = 0; i < linkages_.size(); ++i) {
    if (!has(island, groups_[i].front())) continue;
    awake_[i] = 1;
    place(step, i);
  }
  problem_.begin(step, island, configuration_, linkages_, motions_, state_.joints, usual_step_);
  impacts_.resolve(step, island, impact_friction(), problem_, state_.joints);
  if (!problem_.acts()) return;
  bool agree = problem_.solve();
  if (!agree && step.operators == nullptr) problem_.keep_to_energy(step, island);
  if (!agree && step.operators != nullptr) {
    problem_.evaluate(true);  // at the final velocity
    agree = true;
  }
  problem_.finish(agree, step, island, state_.joints);
  for (std::size_t i = 0; i < linkages_.size(); ++i) {
    if (has(island, groups_[i].front())) solved_[i] = 1;
  }
}

void JointedModel::fly(const ContactStep& step) {
  for (std::size_t i = 0; i < linkages_.size(); ++i) {
    if (!awake_[i]) continue;
    // If the island was solved, its momenta already include gravity.
    flights_[i].fly(solved_[i] ? Vector3(Vector3::Zero()) : step.gravity, step.step, state_.joints,
                    step.bodies);
    for (const LinkageBody& link : linkages_[i].bodies) {
      step.changes.forget(link.body);
      if (link.joint != LinkageBody::kNone) note(static_cast<std::size_t>(link.joint));
    }
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
