#include "simulation/state_bytes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>

#include "mr_hand_interaction/live_simulation.h"
#include "support/pinch_scene.h"

namespace mrhi {
namespace {

using testing::at;

constexpr double kPinchRate = 120.0;

HandFrame frame_of(const testing::PinchScene& pinch, int i) {
  const double t = i / kPinchRate;
  const Vector3 sway = t < 0.5 ? Vector3::Zero() : testing::swing(t - 0.5, 0.05, 1.0);
  return {at(t), {pinch.hand(t, sway)}};
}

Scene scene_of(const testing::PinchScene& pinch) {
  Scene scene = pinch.scene();
  Body ball = testing::ball_body(0.02, 0.05);
  ball.name = "ball";
  ball.start.position = {0.2, 0.0, 0.0};
  scene.bodies.push_back(ball);
  Body person;
  person.name = "operator";
  person.is_operator = true;
  person.mass = 80.0;
  person.inertia = Vector3(11, 12, 1.5).asDiagonal();
  person.start.position = Vector3(0, -0.4, 0);
  person.link_in_body.position = -person.start.position;
  scene.operators.push_back({static_cast<int>(scene.bodies.size()), {}, 1.5});
  scene.bodies.push_back(person);
  return scene;
}

/// A cube held and swung by an operator who floats, with a filter that has a memory.
std::unique_ptr<Simulation> held(int frames) {
  const testing::PinchScene pinch;
  auto simulation = std::make_unique<Simulation>(scene_of(pinch), Configuration());
  for (int i = 0; i < frames; ++i) simulation->advance(frame_of(pinch, i));
  return simulation;
}

TEST(StateBytes, what_goes_on_from_them_has_the_same_bits) {
  const testing::PinchScene pinch;
  constexpr int kFrames = 90, kMore = 120;
  const std::unique_ptr<Simulation> held_cube = held(kFrames);
  Simulation& one = *held_cube;
  ASSERT_FALSE(one.state().contacts.empty());
  Simulation other(scene_of(pinch), Configuration());
  other.set_state(state_from_bytes(to_bytes(one.state()), other.scene()));
  for (int i = kFrames; i < kFrames + kMore; ++i) {
    ASSERT_EQ(hash(one.state()), hash(other.state())) << "frame " << i;
    one.advance(frame_of(pinch, i));
    other.advance(frame_of(pinch, i));
  }
}

TEST(StateBytes, are_the_same_again_after_they_have_been_read) {
  const std::string bytes = to_bytes(held(90)->state());
  EXPECT_EQ(to_bytes(state_from_bytes(bytes, scene_of({}))), bytes);
}

std::string refusal(const std::string& bytes, const Scene& scene) {
  try {
    state_from_bytes(bytes, scene);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(StateBytes, that_are_damaged_cut_or_of_another_scene_are_refused) {
  const std::string good = to_bytes(held(90)->state());
  const Scene scene = scene_of({});
  Scene other = scene;
  other.bodies.push_back(other.bodies.back());
  ASSERT_EQ(refusal(good, scene), "");
  EXPECT_NE(refusal(good, other).find("scene"), std::string::npos);
  EXPECT_NE(refusal("", scene), "");
  EXPECT_NE(refusal(good.substr(0, good.size() / 2), scene), "");
  for (std::size_t place = 0; place < good.size(); place += 997) {
    std::string bad = good;
    bad[place] = static_cast<char>(bad[place] ^ 0x10);
    EXPECT_NE(refusal(bad, scene), "") << "byte " << place;
  }
}

/// Whole and of the right sum, from a recording of a stranger.
TEST(StateBytes, that_name_what_is_not_there_are_refused) {
  const Scene scene = scene_of({});
  const SimulationState good = held(90)->state();
  const auto spoiled = [&](const std::function<void(SimulationState&)>& spoil) {
    SimulationState bad = good;
    spoil(bad);
    return refusal(to_bytes(bad), scene);
  };
  Grip grip;
  grip.fingers = 2;
  for (auto* places : {&grip.in_hand, &grip.in_body, &grip.point, &grip.velocity})
    places->fill(Vector3::Zero());
  for (Vector3& pad : grip.pads) pad.setZero();
  ASSERT_EQ(spoiled([&](auto& state) { state.grips.push_back(grip); }), "");
  const std::vector<std::function<void(SimulationState&)>> ways{
      [](auto& state) { state.contacts.front().key.body = 3; },
      [](auto& state) { state.contacts.front().key.shape = 1; },
      [](auto& state) { state.contacts.front().key.hand = kMaxHands; },
      [](auto& state) { state.contacts.front().key.capsule = kCapsules; },
      [](auto& state) { state.contacts.push_back(state.contacts.front()); },
      [](auto& state) { state.body_contacts.emplace_back().key.a = 3; },
      [](auto& state) { state.sleeping_contacts.emplace_back().key.shape_b = 1; },
      [](auto& state) { state.bodies.pop_back(); },
      [](auto& state) { state.joints.emplace_back(); },
      [](auto& state) { state.interactions.emplace_back(); },
      [](auto& state) { state.bodies[0].pose.orientation.coeffs().setZero(); },
      [](auto& state) { state.bodies[0].linear_momentum.x() = std::nan(""); },
      [](auto& state) { state.bodies[0].pose.position.x() = 1e300; },
      [](auto& state) { state.hands[0].current.palm.orientation.coeffs().setZero(); },
      [](auto& state) { state.offsets[0].lag.whole.coeffs().setZero(); },
      [](auto& state) { state.hands[0].last_seen = std::numeric_limits<Nanoseconds>::min(); },
      [](auto& state) { state.grips.emplace_back(); },
      [&](auto& state) { state.grips.push_back(grip), state.grips.back().body = 3; },
      [&](auto& state) { state.grips.push_back(grip), state.grips.back().hand = kMaxHands; }};
  for (std::size_t i = 0; i < ways.size(); ++i) EXPECT_NE(spoiled(ways[i]), "") << "way " << i;
}

// A filter that takes over from another hands its place over within some frames: what it remembers of that is
// state.
TEST(StateBytes, go_on_with_the_same_bits_while_one_filter_hands_over_to_another) {
  const testing::PinchScene pinch;
  constexpr int kFrames = 90;
  LiveSimulation live(scene_of(pinch), Configuration());
  for (int i = 0; i < kFrames; ++i) live.simulation().advance(frame_of(pinch, i));
  live.set_parameters({{"filter/type", "one_euro"}});
  live.simulation().advance(frame_of(pinch, kFrames));
  Simulation& one = live.simulation();
  ASSERT_TRUE(std::any_of(one.state().hands.begin(), one.state().hands.end(),
                          [](const HandTrack& track) { return track.filter_change.has_value(); }));
  Simulation other(scene_of(pinch), one.configuration());
  other.set_state(state_from_bytes(to_bytes(one.state()), other.scene()));
  for (int i = kFrames + 1; i < kFrames + 60; ++i) {
    ASSERT_EQ(hash(one.state()), hash(other.state())) << "frame " << i;
    one.advance(frame_of(pinch, i));
    other.advance(frame_of(pinch, i));
  }
}

}  // namespace
}  // namespace mrhi
