#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

struct DemonstratedObject {
  Pose pose;                         ///< of the centre of mass, in world
  Vector3 force = Vector3::Zero();   ///< of all hands [N]
  Vector3 torque = Vector3::Zero();  ///< about the centre of mass [N m]
  bool held = false;
};

/// Everything at one time.
struct DemonstrationFrame {
  Nanoseconds stamp = 0;
  std::map<std::string, DemonstratedObject> objects;
  std::array<std::optional<Hand>, 2> hands;  ///< left, right; filtered
  std::vector<std::string> events;           ///< "GRASP_BEGIN cube"
};

/// What a hand did to objects, on one clock, for those who go on with the data.
class Demonstration {
 public:
  /// After each frame.
  void watch(const Simulation& simulation);

  const std::vector<DemonstrationFrame>& frames() const { return frames_; }
  /// The same at even times, so many in a second: places on straight lines between frames, turns on the
  /// shortest way; what acts as in the frame before; events at the first time after them.
  Demonstration at_rate(double rate) const;

 private:
  std::vector<DemonstrationFrame> frames_;
};

/// The angle at each joint of a hand's fingers between the bones on both sides [rad], 0 where it is straight:
/// "index_1" between metacarpal and proximal phalanx to "index_3". Bones that there are.
std::vector<std::pair<std::string, double>> joint_angles(const Hand& hand);

/// A table with a row for each frame: time [s], and for each object and hand its columns; empty cells where
/// it is not there.
void write_demonstration_csv(const Demonstration& demonstration, const std::string& file);

/// A bag of standard messages alone. Where this was built without ROS nothing is written.
void write_demonstration_bag(const Demonstration& demonstration, const std::string& file);

}  // namespace mrhi
