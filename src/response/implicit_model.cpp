#include "implicit_model.h"

#include "newton.h"

namespace mrhi {

void ImplicitModel::respond(ContactStep& step) {
  islands_.build(step);
  impacts_.resolve(step, islands_,
                   configuration_.impact_friction ? ImpactFriction::coulomb : ImpactFriction::none);
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
  for (std::size_t first = 0; first < islands_.size();) respond(step, islands_.next(first));
}

void ImplicitModel::respond(ContactStep& step, const Islands::Island& island) {
  gather(step, island);
  if (contacts_.empty()) return;
  if (bodies_.size() == 1) {
    const auto body = static_cast<std::size_t>(bodies_[0]);
    one_.begin(step, body, contacts_);
    const bool agree = Newton<BodyProblem>(one_).solve();
    if (one_.scale() <= 0.0) return;
    one_.finish(agree, contacts_, step.bodies[body]);
  } else {
    several_.begin(step, bodies_, contacts_);
    const bool agree = Newton<IslandProblem>(several_).solve();
    if (several_.scale() <= 0.0) return;
    several_.finish(agree, bodies_, step.bodies);
  }
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const auto index = static_cast<std::size_t>(entries_[i].index);
    if (entries_[i].between_bodies) {
      settle(step, contacts_[i], step.body_contacts[index]);
    } else {
      settle(step, contacts_[i], step.contacts[index]);
    }
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
      contacts_.emplace_back();
      make_spring(step, contact, configuration_, contacts_.back());
      if (!step.scene.bodies[contact.key.a].fixed) contacts_.back().a = place_of(contact.key.a);
      contacts_.back().b = place_of(contact.key.b);
    } else {
      const Contact& contact = step.contacts[i];
      const int place = place_of(contact.key.body);
      if (contact.ignored) continue;
      contacts_.emplace_back();
      make_spring(step, contact, configuration_, contacts_.back());
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

}  // namespace mrhi
