#pragma once

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "side_by_side.h"
#include "spring.h"

namespace mrhi {

/// Contacts of one body that are worked on side by side. A lane too many is a contact without share.
template <typename Touch>
using FourTouches = std::array<Touch*, kLanes>;

/// Makes the springs that touches stand for; Touch is Contact or BodyContact.
template <typename Touch>
void make_spring(const ContactStep& step, const ContactConfiguration& configuration, const Touch& touch,
                 SpringContact<double>& result);
template <typename Touch>
void make_springs(const ContactStep& step, const ContactConfiguration& configuration,
                  const FourTouches<Touch>& touches, SpringContact<Lanes>& result);

/// Writes what the solution made of them back.
template <typename Touch>
void settle(const ContactStep& step, const SpringContact<double>& solved, Touch& touch);
template <typename Touch>
void settle(const ContactStep& step, const SpringContact<Lanes>& solved, const FourTouches<Touch>& touches);

/// One of four.
SpringContact<double> contact_in(int lane, const SpringContact<Lanes>& four);

}  // namespace mrhi
