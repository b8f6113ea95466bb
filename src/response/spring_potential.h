#pragma once

#include "side_by_side.h"
#include "spring.h"

namespace mrhi {

/// Convex function of the velocities whose gradient gives the response at the limits that are set [W].
double potential(const Spring<double>& spring, const Triple<double>& u, double spin);

}  // namespace mrhi
