#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "explain.h"

namespace mrhi {

/// Keeps what rviz would show at the moments of an explanation: how things stood in each frame of which a
/// picture may be wanted.
class MomentMarkers {
 public:
  MomentMarkers();
  ~MomentMarkers();
  /// After each frame.
  void watch(const Simulation& simulation);
  /// A visualization_msgs/MarkerArray on `markers` for each of the moments that has been kept, in their
  /// order, at the frame's stamp; and on `moment` its number. Nothing where there is no ROS. Throws
  /// std::runtime_error naming the file if it cannot be written.
  void write(const std::vector<PictureMoment>& moments, const std::string& file) const;

 private:
  struct Kept;
  /// How long since each object was touched, by name.
  struct Touched {
    bool touched = false;
    double last = 0.0;
    std::shared_ptr<const Kept> at_last, before;
  };

  void keep(const Touched& touched);

  std::optional<Nanoseconds> first_;  // of the frames
  std::deque<std::shared_ptr<const Kept>> recent_;
  std::map<std::string, Touched> objects_;
  std::map<double, std::shared_ptr<const Kept>> kept_;  // by time [s]
};

}  // namespace mrhi
