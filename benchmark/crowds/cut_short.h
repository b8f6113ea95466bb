#pragma once

namespace mrhi::crowds {

/// Drops ever more cubes on a floor and prints, as CSV, what a crowd's step costs and by how much its budget
/// leaves velocities off the same problem's own solution.
void print_cut_short();

}  // namespace mrhi::crowds
