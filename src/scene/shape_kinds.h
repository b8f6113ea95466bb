#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// A shape that is given by its sizes, in a URDF or in a request to spawn.
struct ShapeKind {
  std::string name;                ///< of the URDF's element
  std::vector<std::string> sizes;  ///< what they are called; but for a box, the element's attributes
  Shape (*make)(const std::vector<double>& size);
  /// Of a shape of this kind, as `make` takes them; nothing of another.
  std::optional<std::vector<double>> (*sizes_of)(const Shape& shape);

  std::string describe(const std::vector<double>& size) const;  ///< "cylinder radius 1 and length 2"
};

const std::vector<ShapeKind>& shape_kinds();

/// Null if there is none.
const ShapeKind* find_shape_kind(const std::string& name);

/// Names of all kinds, for messages.
std::string shape_kind_names();

// urdfdom knows neither all kinds nor that there may be others: what it shall hand on stands in place of a
// mesh's filename.
std::string as_filename(const ShapeKind& kind, const std::vector<double>& size);

/// Stands before the filename of a mesh whose convex hull is meant.
const char* const kHullPrefix = ":hull:";

}  // namespace mrhi
