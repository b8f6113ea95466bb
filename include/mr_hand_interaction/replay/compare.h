#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Where the ways of an object in two runs part.
struct Parting {
  std::string object;
  double time;      ///< of the first frame in which they are not the same to the last digit [s]
  Vector3 place;    ///< of the object there, in the first run [m]
  double distance;  ///< between the two there [m]
  double farthest;  ///< from there on, in frames that both runs have [m]
  std::string why;  ///< if not by where it is: a frame or an object that one run alone has
};

struct Comparison {
  std::size_t objects = 0;        ///< of both runs
  std::vector<Parting> partings;  ///< by time, then by name
};

/// Of the objects.csv in two folders that `replay` has written. Throws RecordingError.
Comparison compare_runs(const std::string& first, const std::string& second);

/// A line for each object that parts, and one for the others.
std::string to_text(const Comparison& comparison);

}  // namespace mrhi
