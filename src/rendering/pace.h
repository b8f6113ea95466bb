#pragma once

#include <vector>

#include "offset_solver.h"

namespace mrhi {

/// How far the joints of a shown hand may go in a frame.
class Pace {
 public:
  /// From where they were in `before`, `way` at the most [m]. Keeps a reference.
  Pace(const Hand& before, double way) : before_(before), way_(way) {}

  /// By how much the joint goes too far that goes the farthest [m]; < 0: none does.
  double beyond(const Hand& placed) const;

  /// Each joint that goes too far, and each in `clearances` already, must keep off the plane that touches the
  /// ball it may be in. Returns the least gap [m], at most 0.
  double keep(const Hand& placed, std::vector<Clearance>& clearances) const;

  /// Takes the joints out of `clearances` again.
  static void forget(std::vector<Clearance>& clearances);

 private:
  const Hand& before_;
  double way_;
};

}  // namespace mrhi
