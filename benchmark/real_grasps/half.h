#pragma once

#include <string>

namespace mrhi::real_grasps {

/// Recordings are split in two, once and for all, so that a model that was tuned on one half can be told by
/// the other: those known by lists, others by their names. All windows of one ARCTIC capture are in one half.
enum class Half { tuned, held_out };

Half half_of(const std::string& name);

/// A window's name without the frame at its end: the capture's.
std::string capture_of(const std::string& window);

}  // namespace mrhi::real_grasps
