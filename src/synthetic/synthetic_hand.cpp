#include "mr_hand_interaction/synthetic/synthetic_hand.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace mrhi {
namespace {

Side side_of(const std::string& name) {
  if (name == "left") return Side::left;
  if (name == "right") return Side::right;
  throw std::invalid_argument("side '" + name + "' is not known: use left or right");
}

double in_range(const char* name, double value, double lowest, double highest) {
  if (value >= lowest && value <= highest) return value;
  std::ostringstream message;
  message << name << " is " << value << ": use " << lowest << " to " << highest;
  throw std::invalid_argument(message.str());
}

}  // namespace

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

}  // namespace mrhi
