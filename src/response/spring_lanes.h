#pragma once

#include "spring.h"

namespace mrhi {

/// What springs do to a body together.
struct SpringSum {
  double force[3];   ///< [N]
  double torque[3];  ///< about the body's centre [N m]
  double push;       ///< sum of the pushes' sizes, and of the bonds' [N]
};

/// -d (force, torque) / d (velocity, angular velocity) of the body: the lower triangle, row by row.
struct SpringSlope {
  double entry[21];
};

/// The work on all springs of a body, for one kind of processor. All kinds give the same bits.
struct SpringLanes {
  /// Lets each respond at the body's velocity and angular velocity.
  void (*respond)(SpringContact<Lanes>* first, SpringContact<Lanes>* last, const double* velocity,
                  bool renew_limits, SpringSum& sum);
  /// By the last responses.
  void (*slope)(const SpringContact<Lanes>* first, const SpringContact<Lanes>* last, SpringSlope& slope);
};

extern const SpringLanes kPortableLanes;
extern const SpringLanes* const kAvx2Lanes;  ///< null where not compiled in

/// The widest that this processor has.
const SpringLanes& spring_lanes();

}  // namespace mrhi
