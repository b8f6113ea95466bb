#include "hand_merging.h"

#include <boost/make_shared.hpp>
#include <stdexcept>

#include "../text/text.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "node.h"
#include "update_diagnostics.h"

namespace mrhi {
namespace {

constexpr int kQueue = 10;
const char* const kWrongFrame = "wrong frame";
const char* const kUnusable = "unusable hand";

std::vector<std::string> inputs_from(const ros::NodeHandle& parameters) {
  refuse_unknown(parameters, {"inputs", "mode"});
  std::vector<std::string> inputs;
  read_parameter(parameters, "inputs", "a list of topics", inputs);
  if (inputs.size() > 1 && inputs.size() <= 8) return inputs;
  throw std::invalid_argument("parameter " + parameters.resolveName("inputs") + " has " +
                              std::to_string(inputs.size()) + " topics; allowed: 2 to 8 with hand frames");
}

HandMerger::Mode mode_from(const ros::NodeHandle& parameters) {
  std::string mode = "people";
  read_parameter(parameters, "mode", "a string", mode);
  if (mode == "people") return HandMerger::Mode::people;
  if (mode == "fused") return HandMerger::Mode::fused;
  throw std::invalid_argument("parameter " + parameters.resolveName("mode") + " is '" +
                              text::one_line(mode, 60) + "'; allowed: people, fused");
}

}  // namespace

HandMerging::HandMerging(ros::NodeHandle node, const ros::NodeHandle& parameters)
    : inputs_(inputs_from(parameters)),
      merger_(inputs_.size(), mode_from(parameters)),
      statistics_({kWrongFrame, kUnusable}),
      publisher_(node.advertise<mr_hand_interaction::HandFrame>("hand_frame", kQueue)),
      diagnostics_(node, parameters, ros::this_node::getName()) {
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const auto take_one = [this, i](const mr_hand_interaction::HandFrame::ConstPtr& message) {
      take(i, *message);
    };
    subscribers_.push_back(node.subscribe<mr_hand_interaction::HandFrame>(
        inputs_[i], kQueue, take_one, nullptr, ros::TransportHints().tcpNoDelay()));
  }
  diagnostics_.setHardwareID("merged hands");
  diagnostics_.add("hand input", [this](auto& status) { statistics_.report(status); });
  timer_ = node.createWallTimer(ros::WallDuration(1.0),
                                [this](const ros::WallTimerEvent&) { update(diagnostics_); });
}

void HandMerging::take(std::size_t stream, const mr_hand_interaction::HandFrame& message) {
  if (frame_id_.empty()) frame_id_ = message.header.frame_id;
  if (message.header.frame_id != frame_id_) {
    statistics_.rejected(kWrongFrame, inputs_[stream] + ": '" + text::one_line(message.header.frame_id, 64) +
                                          "'; allowed: " + frame_id_ + ", as of the others");
    return;
  }
  try {
    for (const HandFrame& frame : merger_.take(stream, from_message(message))) {
      publisher_.publish(
          boost::make_shared<const mr_hand_interaction::HandFrame>(to_message(frame, frame_id_)));
      statistics_.taken(to_seconds(from_ros_time(ros::Time::now()) - frame.stamp));
    }
  } catch (const std::invalid_argument& error) {
    statistics_.rejected(kUnusable, inputs_[stream] + ": " + error.what());
  }
}

}  // namespace mrhi
