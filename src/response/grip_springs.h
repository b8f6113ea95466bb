#pragma once

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "spring.h"

namespace mrhi {

/// Makes the spring of one of a grip's points: it bears any direction alike, without a push.
void make_grip_spring(const ContactStep& step, const ContactConfiguration& configuration, const Grip& grip,
                      int point, SpringContact<double>& result);

/// Writes what the solution made of it back: where it has yielded its end on the body is dragged along.
void settle_grip(const ContactStep& step, const SpringContact<double>& solved, int point, Grip& grip);

}  // namespace mrhi
