#pragma once

#include "islands.h"
#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "spring_contact.h"

namespace mrhi {

/// Makes the spring of one of a grip's points: it bears any direction alike, without a push.
void make_grip_spring(const ContactStep& step, const ContactConfiguration& configuration, const Grip& grip,
                      int point, SpringContact<double>& result);

/// Writes what the solution made of it back: where it has yielded its end on the body is dragged along.
void settle_grip(const ContactStep& step, const SpringContact<double>& solved, int point, Grip& grip);

/// Writes back to all that hands press an island with, contacts and then grips, what comes from `solved` on
/// in that order; returns what comes after.
template <typename Solved>
Solved settle_hands(ContactStep& step, const Island& island, Solved solved) {
  for (const IslandBody& body : island.bodies) {
    for (std::size_t i = body.first; i < body.last; ++i) {
      if (!step.contacts[i].ignored) settle(step, *solved++, step.contacts[i]);
    }
  }
  for (const IslandBody& body : island.bodies) {
    for (Grip& grip : step.grips) {
      if (!grip.bears || grip.body != body.body) continue;
      for (int point = 0; point < kGripPoints; ++point) settle_grip(step, *solved++, point, grip);
    }
  }
  return solved;
}

}  // namespace mrhi
