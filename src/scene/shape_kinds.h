#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// A kind of shape that is defined by its sizes, in a URDF or in a spawn request.
struct ShapeKind {
  std::string name;                ///< of its element in a URDF
  std::vector<std::string> sizes;  ///< names of the sizes; attributes of the element, except for a box
  Shape (*make)(const std::vector<double>& size);
  /// Sizes of a shape of this kind, as `make` takes them; empty for another kind.
  std::optional<std::vector<double>> (*sizes_of)(const Shape& shape);

  std::string describe(const std::vector<double>& size) const;  ///< "cylinder radius 1 and length 2"
};

const std::vector<ShapeKind>& shape_kinds();

/// Null for an unknown name.
const ShapeKind* find_shape_kind(const std::string& name);

/// Names of all kinds, for messages.
std::string shape_kind_names();

/// The shape as the file name of a mesh: urdfdom does not know all kinds, but passes on file names.
std::string as_filename(const ShapeKind& kind, const std::vector<double>& size);

/// Prefix of the file name of a mesh that is used as its convex hull.
const char* const kHullPrefix = ":hull:";

}  // namespace mrhi
