#include "mr_hand_interaction/synthetic/recording_writer.h"

#include <cstdio>
#include <string>

namespace mrhi {
namespace {

constexpr const char* kFingerNames[] = {"thumb", "index", "middle", "ring", "pinky"};
constexpr const char* kAxes[] = {"_x", "_y", "_z"};

/// Vectors and their like that a row has no value for are still columns.
std::string header() {
  std::string line = "time_s,frame_id,hand_id,is_left,confidence,grab_strength,pinch_strength";
  const auto add_vector = [&line](const std::string& name) {
    for (const char* axis : kAxes) line += "," + name + axis;
  };
  for (const char* name : {"palm", "palm_normal", "palm_dir", "palm_vel", "wrist", "elbow"}) add_vector(name);
  line += ",palm_width";
  for (const char* finger : kFingerNames) {
    line += std::string(",") + finger + "_width";
    for (int j = 0; j < 5; ++j) add_vector(std::string(finger) + "_j" + std::to_string(j));
  }
  return line;
}

std::string cell(double value) {
  char text[40];
  std::snprintf(text, sizeof text, ",%.6f", value);
  return text;
}

std::string cell(const std::optional<float>& value) {
  return value ? cell(static_cast<double>(*value)) : ",";
}

std::string cells(const std::optional<Vector3>& value) {
  if (!value) return ",,,";
  return cell(value->x()) + cell(value->y()) + cell(value->z());
}

std::string hand_cells(const HandJoints& hand) {
  std::string line = "," + std::to_string(hand.id) + (hand.side == Side::left ? ",1" : ",0");
  line += cell(static_cast<double>(hand.confidence)) + cell(static_cast<double>(hand.grab_strength)) +
          cell(static_cast<double>(hand.pinch_strength));
  line += cells(hand.palm_centre) + std::string(9, ',') + cells(hand.wrist) + ",,," + cell(hand.palm_width);
  for (std::size_t finger = 0; finger < kFingers; ++finger) {
    line += cell(hand.finger_width[finger]);
    for (const auto& joint : hand.joints[finger]) line += cells(joint);
  }
  return line;
}

}  // namespace

void write_recording_csv(std::ostream& out, const std::vector<JointsFrame>& frames) {
  const std::string columns = header();
  std::string no_hand = ",-1";
  for (std::size_t i = 0, column = 0; i < columns.size(); ++i) {
    if (columns[i] == ',' && ++column > 2) no_hand += ',';
  }
  out << columns << '\n';
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const JointsFrame& frame = frames[i];
    char start[64];
    std::snprintf(start, sizeof start, "%.6f,%zu", to_seconds(frame.stamp - frames.front().stamp), i);
    if (frame.hands.empty()) out << start << no_hand << '\n';
    for (const HandJoints& hand : frame.hands) out << start << hand_cells(hand) << '\n';
  }
}

}  // namespace mrhi
