#pragma once

#include "contact_step.h"
#include "islands.h"
#include "mr_hand_interaction/configuration.h"
#include "spring.h"

namespace mrhi {

/// Makes the spring of a contact with a hand, or of one between bodies. One without share does nothing.
void make_spring(const ContactStep& step, const ContactConfiguration& configuration, const Contact& contact,
                 SpringContact& result);
void make_spring(const ContactStep& step, const ContactConfiguration& configuration,
                 const BodyContact& contact, SpringContact& result);

/// Writes what the solution made of it back.
void settle(const ContactStep& step, const SpringContact& solved, Contact& contact);
void settle(const ContactStep& step, const SpringContact& solved, BodyContact& contact);

/// How far ahead a spring that touches is evaluated: the step, and what damping adds [s].
double look_ahead(double step, bool damping);

/// Convex function of the velocities whose gradient gives the response at the limits that are set [W].
double potential(const Spring& spring, const Triple& u, double spin);

/// Makes the spring of one of a grip's points: it bears any direction alike, without a push.
void make_grip_spring(const ContactStep& step, const ContactConfiguration& configuration, const Grip& grip,
                      int point, SpringContact& result);

/// Writes what the solution made of it back: where it has yielded its end on the body is dragged along.
void settle_grip(const ContactStep& step, const SpringContact& solved, int point, Grip& grip);

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
      if (!grip.active || grip.body != body.body) continue;
      for (int point = 0; point < kGripPoints; ++point) settle_grip(step, *solved++, point, grip);
    }
  }
  return solved;
}

}  // namespace mrhi
