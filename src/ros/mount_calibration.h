#pragma once

#include <ros/ros.h>
#include <topic_tools/shape_shifter.h>

#include <ostream>
#include <string>

#include "../calibration/touch_recorder.h"
#include "leap_reader.h"

namespace mrhi {

/// Asks for each of a list of points to be touched with the tip of the index finger, and records where a
/// Leap's driver sees it.
class MountCalibration {
 public:
  /// Prompts go to `out`; hands of the other side are ignored.
  MountCalibration(const ros::NodeHandle& node, const std::string& topic, Side side, TouchRecorder recorder,
                   std::ostream& out);

  /// Returns once all points are taken, or at shutdown.
  void run();
  const TouchRecorder& recorder() const { return recorder_; }
  /// Of the driver's messages; empty before the first.

 private:
  void take(const topic_tools::ShapeShifter& message);
  void ask() const;
  void warn_of_no_frames() const;

  ros::NodeHandle node_;
  std::string topic_;
  Side side_;
  TouchRecorder recorder_;
  std::ostream& out_;
  LeapReader reader_;
  std::string device_frame_;
  ros::Subscriber subscriber_;
};

}  // namespace mrhi
