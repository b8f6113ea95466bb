#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rigid_fit.h"

namespace mrhi {

/// A file of points that cannot be read or written. what() is one line.
class PointsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A known place that a fingertip touches.
struct TouchedPoint {
  std::string name;
  Vector3 world = Vector3::Zero();   ///< [m]
  Vector3 normal = Vector3::Zero();  ///< of the touched surface, towards the finger, unit; zero: unknown
  std::optional<Vector3> device;     ///< where the tip's centre was, in the device's frame [m]
  double radius = 0.0;               ///< of the tip [m]

  /// Where in world the tip's centre is while its skin touches the point; the point itself without a normal.
  Vector3 tip_in_world() const { return world + radius * normal; }
};

/// From YAML: points: [{name: N, world: [x, y, z], normal: [x, y, z], device: [x, y, z], radius: r}, ...];
/// `world` must be there, and a point without a name gets its number. Throws PointsError with the place.
std::vector<TouchedPoint> read_points(const std::string& file);
/// As read_points() takes it. Throws PointsError.
void write_points(const std::string& file, const std::vector<TouchedPoint>& points);

/// Pose of the device in world. Every point must have `device`. Throws FitError.
RigidFit fit_mount(const std::vector<TouchedPoint>& points);

/// Throws FitError if the places, touched without any error, would not give a pose.
void check_places(const std::vector<TouchedPoint>& points);
/// Throws FitError that names the worst point if the rms is above `largest` [m].
void check_residual(const std::vector<TouchedPoint>& points, const RigidFit& fit, double largest);

/// A line for each point with its residual, and the rms, in mm.
std::string residual_table(const std::vector<TouchedPoint>& points, const RigidFit& fit);
/// "x y z qx qy qz qw", as the launch files take it, w not negative.
std::string mount_text(const Pose& device_in_world);

}  // namespace mrhi
