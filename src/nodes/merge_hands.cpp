#include <mr_hand_interaction/HandFrame.h>
#include <ros/ros.h>

#include <boost/make_shared.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "../ros/input_statistics.h"
#include "../ros/node.h"
#include "../text/text.h"
#include "../text/yaml.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/tracking/hand_merger.h"

namespace mrhi {
namespace {

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction merge_hands _inputs:="[TOPIC, TOPIC, ...]" [_mode:=people|fused]

Merges the hand_frame topics of several hand_tracking_nodes into one topic, hand_frame. All stamps must come from one
clock, and all hands must be in one frame.

  ~inputs   topics of HandFrame, 2 to 8
  ~mode     people (default): each topic has different hands, such as those of two people
            fused: all topics have the hands of one person; the more confident tracker gives the hand of each side
)";

constexpr int kQueue = 10;
const char* const kWrongFrame = "wrong frame";
const char* const kUnusable = "unusable hand";

struct Parameters {
  explicit Parameters(const ros::NodeHandle& node) {
    const std::string allowed = "a list of 2 to 8 topics with hand frames";
    NodeParameters known;
    known.add("inputs", allowed, [this](const std::string& name, const std::string& text) {
      inputs = yaml_texts("parameter '" + name + "'", text);
      return inputs.size() >= 2 && inputs.size() <= 8;
    });
    known.choice<HandMerger::Mode>(
        "mode", {{"people", HandMerger::Mode::people}, {"fused", HandMerger::Mode::fused}}, mode);
    known.read(node);
    if (inputs.empty()) throw ParameterError("parameter 'inputs' is missing; allowed: " + allowed);
  }

  std::vector<std::string> inputs;
  HandMerger::Mode mode = HandMerger::Mode::people;
};

}  // namespace

class HandMerging {
 public:
  HandMerging(ros::NodeHandle node, const ros::NodeHandle& private_node, const Parameters& parameters)
      : inputs_(parameters.inputs),
        merger_(inputs_.size(), parameters.mode),
        diagnostics_(node, private_node, "merged hands", "hand input", {kWrongFrame, kUnusable}),
        publisher_(node.advertise<mr_hand_interaction::HandFrame>("hand_frame", kQueue)) {
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      const auto take_one = [this, i](const mr_hand_interaction::HandFrame::ConstPtr& message) {
        take(i, *message);
      };
      subscribers_.push_back(node.subscribe<mr_hand_interaction::HandFrame>(
          inputs_[i], kQueue, take_one, nullptr, ros::TransportHints().tcpNoDelay()));
    }
  }

 private:
  void take(std::size_t stream, const mr_hand_interaction::HandFrame& message) {
    if (frame_id_.empty()) frame_id_ = message.header.frame_id;
    if (message.header.frame_id != frame_id_) {
      diagnostics_.rejected(kWrongFrame, inputs_[stream] + ": '" +
                                             text::one_line(message.header.frame_id, 64) +
                                             "'; allowed: " + frame_id_ + ", as of the others");
      return;
    }
    try {
      for (const HandFrame& frame : merger_.take(stream, from_message(message))) {
        publisher_.publish(
            boost::make_shared<const mr_hand_interaction::HandFrame>(to_message(frame, frame_id_)));
        diagnostics_.taken(to_seconds(from_ros_time(ros::Time::now()) - frame.stamp));
      }
    } catch (const std::invalid_argument& error) {
      diagnostics_.rejected(kUnusable, inputs_[stream] + ": " + error.what());
    }
  }

  std::vector<std::string> inputs_;
  HandMerger merger_;
  std::string frame_id_;  // of the first frame; all must have it
  NodeDiagnostics diagnostics_;
  ros::Publisher publisher_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace mrhi

int main(int argc, char** argv) {
  return mrhi::run_node<mrhi::HandMerging, mrhi::Parameters>(argc, argv, "merge_hands", mrhi::kUsage);
}
