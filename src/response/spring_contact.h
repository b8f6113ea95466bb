#pragma once

#include "contact_step.h"
#include "islands.h"
#include "mr_hand_interaction/configuration.h"
#include "spring.h"

namespace mrhi {

/// Makes the spring of a contact with a hand, or of one between bodies. A contact without share has no
/// stiffness.
void make_spring(const ContactStep& step, const ContactConfiguration& configuration, const Contact& contact,
                 SpringContact& result);
void make_spring(const ContactStep& step, const ContactConfiguration& configuration,
                 const BodyContact& contact, SpringContact& result);

/// Writes the solution of a contact back.
void settle(const ContactStep& step, const SpringContact& solved, Contact& contact);
void settle(const ContactStep& step, const SpringContact& solved, BodyContact& contact);

/// Look-ahead time of a touching spring: the step plus damping [s].
double look_ahead(double step, bool damping);

/// Convex function of the velocities whose gradient is the response under the present limits [W].
double potential(const Spring& spring, const Triple& u, double spin);

/// Makes the spring of one point of a grip, which acts alike in all directions and has no normal force.
void make_grip_spring(const ContactStep& step, const ContactConfiguration& configuration, const Grip& grip,
                      int point, SpringContact& result);

/// Makes the rows of the hands' contacts with an island, and of its grips.
void make_hand_rows(const ContactStep& step, const Island& island, const ContactConfiguration& configuration,
                    std::vector<SpringContact>& rows);
/// Makes the row of a contact between bodies of the island, or of one of them with a fixture.
void make_link_row(const ContactStep& step, const Island& island, const ContactConfiguration& configuration,
                   const BodyContact& contact, SpringContact& row);

/// Writes back the solution of the rows of make_hand_rows(). Returns the row after them.
const SpringContact* settle_hand_rows(ContactStep& step, const Island& island, const SpringContact* row);

}  // namespace mrhi
