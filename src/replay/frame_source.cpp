#include "frame_source.h"

#include "mr_hand_interaction/replay/recording_csv.h"

namespace mrhi {

SourceFrame placed(const JointsFrame& joints, const Pose& device_in_world) {
  SourceFrame result;
  result.frame = complete_frame(joints, device_in_world, result.left_out);
  if (!result.frame) {
    result.reason = "unusable hand";
    result.detail = result.left_out.front();
    result.left_out.clear();
  }
  return result;
}

CsvInput::CsvInput(const std::string& file, const Pose& device_in_world)
    : frames_(read_recording_csv(file)), device_in_world_(device_in_world) {}

std::optional<SourceFrame> CsvInput::next() {
  if (position_ == frames_.size()) return std::nullopt;
  return placed(frames_[position_++], device_in_world_);
}

}  // namespace mrhi
