#include "implicit_model.h"

#include "newton.h"

namespace mrhi {

void ImplicitModel::respond(ContactStep& step) {
  impacts_.resolve(step, ImpactFriction::coulomb);
  // A phalanx or body that is inside has had its approach, impact or not.
  for (Contact& contact : step.contacts) {
    contact.force.setZero();
    contact.struck = contact.struck || contact.depth > 0.0;
  }
  for (BodyContact& contact : step.body_contacts) {
    contact.force.setZero();
    contact.struck = contact.struck || contact.depth > 0.0;
  }
  places_.resize(step.scene.bodies.size(), -1);
  islands_.build(step);
  for (std::size_t first = 0; first < islands_.size();) respond(step, islands_.next(first));
}

void ImplicitModel::respond(ContactStep& step, const Islands::Island& island) {
  gather(step, island);
  if (bodies_.size() == 1) {
    const auto body = static_cast<std::size_t>(bodies_[0]);
    BodyProblem problem(step, body, contacts_);
    Newton<BodyProblem>(problem).solve();
    if (problem.scale() <= 0.0) return;
    settle_all(step, problem);
    problem.finish(step.bodies[body]);
  } else {
    several_.begin(step, bodies_, contacts_);
    Newton<IslandProblem>(several_).solve();
    if (several_.scale() <= 0.0) return;
    settle_all(step, several_);
    several_.finish(bodies_, step.bodies);
  }
  for (const int body : bodies_) step.changes.mark_solved(body);
}

/// Lists the island's bodies and what acts on them.
void ImplicitModel::gather(const ContactStep& step, const Islands::Island& island) {
  for (const int body : bodies_) places_[static_cast<std::size_t>(body)] = -1;
  bodies_.clear();
  contacts_.clear();
  entries_.clear();
  for (const ContactIndex& entry : island) {
    const auto i = static_cast<std::size_t>(entry.index);
    if (entry.between_bodies) {
      const BodyContact& contact = step.body_contacts[i];
      contacts_.push_back(body_spring(step, contact, object_stiffness_));
      if (!step.scene.bodies[contact.key.a].fixed) contacts_.back().a = place_of(contact.key.a);
      contacts_.back().b = place_of(contact.key.b);
    } else {
      const Contact& contact = step.contacts[i];
      const int place = place_of(contact.key.body);
      if (contact.ignored) continue;
      contacts_.push_back(hand_spring(step, contact, torsion_));
      contacts_.back().b = place;
    }
    entries_.push_back(entry);
  }
}

int ImplicitModel::place_of(int body) {
  int& place = places_[static_cast<std::size_t>(body)];
  if (place < 0) {
    place = static_cast<int>(bodies_.size());
    bodies_.push_back(body);
  }
  return place;
}

template <typename Problem>
void ImplicitModel::settle_all(ContactStep& step, const Problem& problem) const {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Vector3 u = problem.relative_velocity(contacts_[i]);
    const double spin = problem.relative_spin(contacts_[i]);
    const auto index = static_cast<std::size_t>(entries_[i].index);
    if (entries_[i].between_bodies) {
      settle(step, contacts_[i], u, spin, step.body_contacts[index]);
    } else {
      settle(step, contacts_[i], u, spin, step.contacts[index]);
    }
  }
}

}  // namespace mrhi
