#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// What an engineer calls the same place. Both 0: the same to the last digit, velocities too.
struct Tolerance {
  double distance = 1e-9;  ///< between centres of mass [m]
  double angle = 1e-9;     ///< between orientations [rad]
};

/// How far the ways of an object in two runs are apart.
struct Parting {
  std::string object;
  double time = 0.0;                ///< of the first frame that counts [s]
  Vector3 place = Vector3::Zero();  ///< of the object there, in the first run [m]
  double distance = 0.0;            ///< between the two there [m]
  double angle = 0.0;               ///< [rad]
  double farthest = 0.0;            ///< from there on, in frames that both runs have [m]
  double most_turned = 0.0;         ///< likewise [rad]
  std::string why;                  ///< if not by where it is: a frame or an object that one run alone has
};

struct Comparison {
  Tolerance tolerance;
  std::size_t objects = 0;        ///< of both runs
  std::vector<Parting> partings;  ///< by time, then by name
  /// Within the tolerance all the way, though not the same to the last digit: from the first frame that
  /// differs.
  std::vector<Parting> near_misses;
  /// Of the states in which the runs end, contacts and filters too; nothing where a run does not tell its
  /// hash.
  std::optional<bool> same_end;
};

/// Of the objects.csv, and the state_hash in summary.json, in two folders that `replay` has written. Throws
/// RecordingError.
Comparison compare_runs(const std::string& first, const std::string& second, const Tolerance& tolerance = {});

/// A line for each object that parts, or differs at all, one for the others, and whether the bits are the
/// same.
std::string to_text(const Comparison& comparison);

}  // namespace mrhi
