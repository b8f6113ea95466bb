#include "mr_hand_interaction/synthetic/synthetic_hand.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "../text/files.h"
#include "../text/text.h"

namespace mrhi {
namespace {

constexpr double kRestNoise = 0.0002, kFastNoise = 0.0012, kCommonNoise = 0.0002;  // [m] rms
constexpr double kFastSpeed = 1.0;                                                 // [m/s]

const HandJoints* find(const JointsFrame& frame, std::uint32_t id) {
  for (const HandJoints& hand : frame.hands) {
    if (hand.id == id) return &hand;
  }
  return nullptr;
}

Side side_of(const std::string& name) {
  if (name == "left") return Side::left;
  if (name == "right") return Side::right;
  throw std::invalid_argument("side '" + name + "' is not known: use left or right");
}

double in_range(const char* name, double value, double lowest, double highest) {
  if (value >= lowest && value <= highest) return value;
  throw std::invalid_argument(text::format("%s is %g: use %g to %g", name, value, lowest, highest));
}

constexpr const char* kFingerNames[] = {"thumb", "index", "middle", "ring", "pinky"};
constexpr const char* kAxes[] = {"_x", "_y", "_z"};

/// All columns of vectors and similar values appear, also those that stay empty.
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

void TrackingNoise::apply(JointsFrame& frame) {
  if (amplitude_ == 0.0) return;
  const JointsFrame clean = frame;
  const double elapsed = to_seconds(frame.stamp - previous_.stamp);
  for (HandJoints& hand : frame.hands) disturb(hand, find(previous_, hand.id), elapsed);
  previous_ = clean;
}

void TrackingNoise::disturb(HandJoints& hand, const HandJoints* before, double elapsed) {
  const Vector3 common = random_.gaussian_vector(amplitude_ * kCommonNoise);
  if (hand.palm_centre) *hand.palm_centre += common;
  if (hand.wrist) *hand.wrist += common;
  for (std::size_t finger = 0; finger < kFingers; ++finger) {
    for (std::size_t j = 0; j < hand.joints[finger].size(); ++j) {
      auto& joint = hand.joints[finger][j];
      if (!joint) continue;
      double speed = 0.0;
      if (before != nullptr && elapsed > 0.0 && before->joints[finger][j]) {
        speed = (*joint - *before->joints[finger][j]).norm() / elapsed;
      }
      const double deviation = kRestNoise + (kFastNoise - kRestNoise) * std::min(1.0, speed / kFastSpeed);
      *joint += common + random_.gaussian_vector(amplitude_ * deviation);
    }
  }
  // Leap's empty thumb metacarpal stays empty.
  if (hand.joints[0][0] && hand.joints[0][1]) hand.joints[0][0] = hand.joints[0][1];
}

SyntheticHand::SyntheticHand(const SyntheticHandOptions& options)
    : SyntheticHand(options, make_motion(options.motion)) {}

SyntheticHand::SyntheticHand(const SyntheticHandOptions& options, const ScriptedMotion& motion)
    : motion_(motion),
      side_(side_of(options.side)),
      rate_(in_range("rate", options.rate, 1.0, 1000.0)),
      noise_(in_range("noise", options.noise, 0.0, 10.0), options.seed) {}

Nanoseconds SyntheticHand::next_stamp() const {
  return static_cast<Nanoseconds>(std::llround(static_cast<double>(frame_) * 1e9 / rate_));
}

int SyntheticHand::next_run() const {
  return static_cast<int>(to_seconds(next_stamp()) / motion_.period());
}

JointsFrame SyntheticHand::next() {
  JointsFrame frame = sample(motion_, side_, next_stamp(), default_device_mount());
  noise_.apply(frame);
  ++frame_;
  return frame;
}

std::vector<JointsFrame> record_motion(const SyntheticHandOptions& options) {
  return record_motion(options, make_motion(options.motion));
}

std::vector<JointsFrame> record_motion(const SyntheticHandOptions& options, const ScriptedMotion& motion) {
  SyntheticHand hand(options, motion);
  std::vector<JointsFrame> frames;
  while (hand.next_run() == 0) frames.push_back(hand.next());
  return frames;
}

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
