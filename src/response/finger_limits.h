#pragma once

#include "contact_step.h"
#include "mr_hand_interaction/configuration.h"

namespace mrhi {

/// Sets `grip`, the friction gain of contacts at edges and corners of boxes and at rims of cylinders, for the
/// direction of their stretch. All others have 1. An edge indents the fingertip pad, which then rests on both
/// adjacent faces. The contact slips only when the force leaves the span of the friction cones of these
/// faces.
void grip_edges(ContactStep& step);

/// Largest ratio of friction to normal force where faces meet; at least `friction`. `normal` is the contact's
/// normal. `along` is the direction of the object's friction on the finger, perpendicular to it. Both are
/// unit vectors in the frame of the shape, a box or a cylinder.
double friction_at_edge(const Shape& shape, const Vector3& normal, const Vector3& along, double friction);

/// Sets the hand's limits in every contact. All loaded points of a finger share its strength in proportion to
/// their depths, on any bodies. Mass and restitution of an impact are those of the phalanx.
void share_strength(const HandStrength& hand, std::vector<Contact>& contacts);

}  // namespace mrhi
