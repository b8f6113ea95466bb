#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "recording.h"

namespace mrhi::real_grasps {

/// What comes together as a hand closes.
enum class Kind {
  pinch,  ///< the tips of thumb and index
  grab,   ///< the thumb's tip and the middle of the other four
  pass    ///< those as well, but they stay open round the body: nothing is to be taken
};

/// A row of the result: what is put where recorded hands close.
struct Row {
  std::string name;
  Kind kind;
  bool sphere;
  double size;         ///< edge or diameter [m]
  double mass;         ///< [kg]
  bool rests = false;  ///< at 1 g, upright on a column, else free at 0 g
};

/// Those of docs/real_grasps.md.
std::vector<Row> all_rows();

/// One closing that begins clear of the body and is seen to open again.
struct Closing {
  std::size_t track = 0;
  std::uint32_t hand = 0;   ///< id
  Pose place;               ///< of the body: where the hand closes
  std::size_t begin = 0;    ///< frame from which it is played: nothing is within 2 mm of the body
  std::size_t last = 0;     ///< frame with which it ends: 0.4 s after the hand has opened
  double closed = 0.0;      ///< time at which the body is as wide as the hand is open [s]
  double opens = 0.0;       ///< time of the last frame before it opens [s]
  Vector3 grip_at_end;      ///< middle of what came together, in that frame
  double hand_speed = 0.0;  ///< of the fastest joint on the way [m/s]
};

/// The closings of all hands, at most ten of a recording.
std::vector<Closing> closings(const Recording& recording, const Row& row);

/// Of the hand's surface from the body [m]; below 0 inside.
double clearance(const std::vector<Sighting>& hands, const Row& row, const Pose& place);

}  // namespace mrhi::real_grasps
