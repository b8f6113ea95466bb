#include "recording_writer.h"

#include <string>

#include "../text/csv.h"
#include "../text/text.h"

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

void write_hand(const HandJoints& hand, CsvRows& row) {
  constexpr std::size_t kVector = 3;
  row << hand.id << (hand.side == Side::left) << hand.confidence << hand.grab_strength << hand.pinch_strength
      << hand.palm_centre;
  row.skip(3 * kVector) << hand.wrist;
  row.skip(kVector) << hand.palm_width;
  for (std::size_t finger = 0; finger < kFingers; ++finger) {
    row << hand.finger_width[finger];
    for (const auto& joint : hand.joints[finger]) row << joint;
  }
}

}  // namespace

void write_recording_csv(std::ostream& out, const std::vector<JointsFrame>& frames) {
  const std::string columns = header();
  const std::size_t of_hand = text::split(columns).size() - 2;
  out << columns << '\n';
  const auto flags = out.setf(std::ios::fixed, std::ios::floatfield);
  const auto digits = out.precision(6);
  CsvRows row(out);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double time = to_seconds(frames[i].stamp - frames.front().stamp);
    if (frames[i].hands.empty()) {
      row << time << i << -1;
      row.skip(of_hand - 1).end_row();
    }
    for (const HandJoints& hand : frames[i].hands) {
      row << time << i;
      write_hand(hand, row);
      row.end_row();
    }
  }
  out.flags(flags);
  out.precision(digits);
}

}  // namespace mrhi
