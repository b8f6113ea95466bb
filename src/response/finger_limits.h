#pragma once

#include "contact_step.h"
#include "mr_hand_interaction/configuration.h"

namespace mrhi {

/// An edge digs into the pad of a finger, which then bears on both faces beside it: such a touch slips only
/// when the force leaves what the cones of friction of these faces, and those between them, can bear.
/// Sets `grip` of the contacts at edges and corners of boxes and at rims of cylinders, for the direction in
/// which they are drawn; all others have 1.
void grip_edges(ContactStep& step);

/// The largest friction force over the push where faces meet; at least `friction`. `normal` is that of the
/// contact, `along`, perpendicular to it, the way in which the object holds the finger back:
/// unit, in the frame of the shape, which is a box or a cylinder.
double friction_at_edge(const Shape& shape, const Vector3& normal, const Vector3& along, double friction);

/// Sets the hand's limits in every contact. All loaded points of a finger share its strength by their depths,
/// on whatever bodies. Mass and restitution of an impact are those of the phalanx.
void share_strength(const HandStrength& hand, std::vector<Contact>& contacts);

}  // namespace mrhi
