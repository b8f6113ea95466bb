#include "haptics_publisher.h"

#include <algorithm>
#include <boost/make_shared.hpp>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "result_conversion.h"

namespace mrhi {
namespace {

/// The contacts of one phalanx with one body.
class Feeling {
 public:
  void add(const Contact& contact) {
    force_ += contact.force;
    impulse_ += contact.impulse;
    normals_ += contact.normal;
    depth_ = std::max(depth_, contact.depth);
    slips_ = slips_ || (contact.touching() && contact.friction == Friction::slipping);
  }

  void fill(mr_hand_interaction::PhalanxHaptics& phalanx) const {
    const Vector3 normal = normals_.normalized();
    phalanx.slip = slips_ ? phalanx.SLIPPING : phalanx.STICKING;
    phalanx.force = vector_message(force_);
    phalanx.impulse = vector_message(impulse_);
    phalanx.normal = vector_message(normal);
    phalanx.pressure = std::max(0.0, -normal.dot(force_));
    phalanx.depth = depth_;
  }

 private:
  Vector3 force_ = Vector3::Zero(), impulse_ = Vector3::Zero(), normals_ = Vector3::Zero();
  double depth_ = 0.0;
  bool slips_ = false;
};

bool is_felt(const Contact& contact) {
  return contact.touching() || !contact.impulse.isZero(0.0) || !contact.force.isZero(0.0);
}

bool same_phalanx(const Contact& a, const Contact& b) {
  return a.key.body == b.key.body && a.key.hand == b.key.hand && a.key.capsule == b.key.capsule;
}

mr_hand_interaction::PhalanxHaptics named(const Contact& contact, const Scene& scene) {
  mr_hand_interaction::PhalanxHaptics phalanx;
  phalanx.finger = static_cast<std::uint8_t>(finger_of(contact.key.capsule));
  phalanx.bone = static_cast<std::uint8_t>(bone_of(contact.key.capsule));
  phalanx.object = scene.bodies[contact.key.body].name;
  return phalanx;
}

/// One after the other, as contacts come body by body, each in the order of hands and phalanges.
void add_phalanges(int slot, const Scene& scene, const std::vector<Contact>& contacts,
                   std::vector<mr_hand_interaction::PhalanxHaptics>& phalanges) {
  for (auto contact = contacts.begin(); contact != contacts.end();) {
    const auto first = contact;
    Feeling feeling;
    bool felt = false;
    for (; contact != contacts.end() && same_phalanx(*first, *contact); ++contact) {
      if (first->key.hand != slot || !is_felt(*contact)) continue;
      feeling.add(*contact);
      felt = true;
    }
    if (!felt) continue;
    phalanges.push_back(named(*first, scene));
    feeling.fill(phalanges.back());
  }
}

}  // namespace

mr_hand_interaction::HapticsArray haptics_message(const Scene& scene, const SimulationState& state,
                                                  const std::vector<Contact>& contacts,
                                                  const std_msgs::Header& header) {
  mr_hand_interaction::HapticsArray message;
  message.header = header;
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    const HandTrack& track = state.hands[slot];
    if (!track.active) continue;
    message.hands.emplace_back();
    message.hands.back().id = track.current.id;
    message.hands.back().side = static_cast<std::uint8_t>(track.current.side);
    add_phalanges(static_cast<int>(slot), scene, contacts, message.hands.back().phalanges);
  }
  return message;
}

namespace {

constexpr int kQueue = 100;  // the steps of a few frames come at once

template <typename Message>
void publish_all(std::vector<Message>& messages, const std_msgs::Header& header, ros::Publisher& publisher) {
  for (const Message& message : messages) {
    message->header.frame_id = header.frame_id;
    publisher.publish(message);
  }
  messages.clear();
}

}  // namespace

HapticsPublisher::HapticsPublisher(ros::NodeHandle& node, HapticsRate rate)
    : rate_(rate),
      publisher_(node.advertise<mr_hand_interaction::HapticsArray>("haptics", kQueue)),
      joint_publisher_(node.advertise<sensor_msgs::JointState>("haptics/joints", kQueue)) {}

void HapticsPublisher::add(const Simulation& simulation, const std::vector<Contact>& contacts,
                           const std_msgs::Header& header) {
  const Scene& scene = simulation.scene();
  const SimulationState& state = simulation.state();
  if (publisher_.getNumSubscribers() > 0)
    steps_.push_back(boost::make_shared<mr_hand_interaction::HapticsArray>(
        haptics_message(scene, state, contacts, header)));
  if (!scene.joints.empty() && joint_publisher_.getNumSubscribers() > 0)
    joint_steps_.push_back(
        boost::make_shared<sensor_msgs::JointState>(joint_states_message(scene, state, header)));
}

void HapticsPublisher::note_step(const Simulation& simulation, Nanoseconds stamp) {
  if (rate_ != HapticsRate::step) return;
  std_msgs::Header header;
  header.stamp = to_ros_time(stamp);
  add(simulation, simulation.state().contacts, header);
}

void HapticsPublisher::publish(const Simulation& simulation, const FrameResult& result,
                               const std_msgs::Header& header) {
  if (steps_.empty() && joint_steps_.empty()) add(simulation, result.contacts, header);
  publish_all(steps_, header, publisher_);
  publish_all(joint_steps_, header, joint_publisher_);
}

}  // namespace mrhi
