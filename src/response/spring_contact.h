#pragma once

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "side_by_side.h"
#include "spring.h"

namespace mrhi {

/// Makes the springs that touches stand for, one or four of the same body; Touch is Contact or BodyContact.
/// One without share does nothing.
template <typename Touch>
void make_spring(const ContactStep& step, const ContactConfiguration& configuration, const Touch& touch,
                 SpringContact<double>& result);
template <typename Touch>
void make_springs(const ContactStep& step, const ContactConfiguration& configuration, Touch* const* touches,
                  SpringContact<Lanes>& result);

/// Writes what the solution made of them back.
template <typename Touch>
void settle(const ContactStep& step, const SpringContact<double>& solved, Touch& touch);
template <typename Touch>
void settle(const ContactStep& step, const SpringContact<Lanes>& solved, Touch* const* touches);

/// How far ahead a spring that touches is evaluated: the step, and what damping adds [s].
double look_ahead(double step, bool damping);

/// One of four.
SpringContact<double> contact_in(int lane, const SpringContact<Lanes>& four);
/// The other way round.
void put_in(int lane, const SpringContact<double>& one, SpringContact<Lanes>& four);

/// Convex function of the velocities whose gradient gives the response at the limits that are set [W].
double potential(const Spring<double>& spring, const Triple<double>& u, double spin);

}  // namespace mrhi
