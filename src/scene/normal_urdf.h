#pragma once

#include <map>
#include <string>
#include <vector>

#include "warnings.h"

namespace mrhi {

/// A URDF in the form that urdfdom reads.
struct NormalUrdf {
  std::string xml;
  std::vector<std::string> links;          ///< names, in the order of the file
  std::map<std::string, double> friction;  ///< Coulomb's coefficient, by link: <lateral_friction>, <mu1>
};

/// Rewrites a URDF as people write it: names that topics and frames can have, complete limits and inertias, a
/// world above a root that has a shape, no tags of other programs. What is changed in meaning is a warning.
/// Throws std::runtime_error, whose text goes on from the file's name.
NormalUrdf normal_urdf(const std::string& xml, Warnings& warnings);

}  // namespace mrhi
