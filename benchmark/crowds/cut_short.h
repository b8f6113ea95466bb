#pragma once

namespace mrhi::crowds {

/// Drops increasing numbers of cubes on a floor. Prints, as CSV, the cost of a large island's step and its
/// velocity error against the converged solution of the same problem.
void print_cut_short();

}  // namespace mrhi::crowds
