#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "recording.h"

namespace mrhi::real_grasps {

/// Opposing parts of a closing hand.
enum class Kind {
  pinch,  ///< the tips of thumb and index
  grab,   ///< the thumb's tip and the centre of the other four
  pass    ///< the same, but they stay open around the body: nothing is to be grasped
};

/// A row of the result: a body placed where recorded hands close.
struct Row {
  std::string name;
  Kind kind;
  bool sphere;
  double size;         ///< edge or diameter [m]
  double mass;         ///< [kg]
  bool rests = false;  ///< at 1 g, upright on a column; false: free at 0 g
};

/// Rows of docs/real_grasps.md.
std::vector<Row> all_rows();

/// One closing that begins clear of the body and ends with opening.
struct Closing {
  std::size_t track = 0;
  std::uint32_t hand = 0;   ///< id
  Pose place;               ///< of the body: where the hand closes
  std::size_t begin = 0;    ///< first frame: nothing is within 2 mm of the body
  std::size_t last = 0;     ///< last frame: 0.4 s after the hand has opened
  double closed = 0.0;      ///< time at which the aperture equals the body's width [s]
  double opens = 0.0;       ///< time of the last frame before opening [s]
  Vector3 grip_at_end;      ///< centre of the opposing parts, in that frame
  double hand_speed = 0.0;  ///< of the fastest joint during the closing [m/s]
};

/// Closings of all hands, at most ten per recording.
std::vector<Closing> closings(const Recording& recording, const Row& row);

/// Distance of the hand's surface from the body [m]; negative inside.
double clearance(const std::vector<Sighting>& hands, const Row& row, const Pose& place);

}  // namespace mrhi::real_grasps
