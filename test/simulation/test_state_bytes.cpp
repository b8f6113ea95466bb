#include "simulation/state_bytes.h"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>

#include "support/pinch_scene.h"

namespace mrhi {
namespace {

using testing::at;

constexpr double kRate = 120.0;

HandFrame frame_of(const testing::PinchScene& pinch, int i) {
  const double t = i / kRate;
  const Vector3 sway = t < 0.5 ? Vector3::Zero() : testing::swing(t - 0.5, 0.05, 1.0);
  return {at(t), {pinch.hand(t, sway)}};
}

Scene scene_of(const testing::PinchScene& pinch) {
  Scene scene = pinch.scene();
  Body ball = testing::ball_body(0.02, 0.05);
  ball.name = "ball";
  ball.start.position = {0.2, 0.0, 0.0};
  scene.bodies.push_back(ball);
  return scene;
}

/// A cube held and swung, with a filter that has a memory.
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
  other.set_state(state_from_bytes(to_bytes(one.state()), other.scene().bodies.size()));
  for (int i = kFrames; i < kFrames + kMore; ++i) {
    ASSERT_EQ(hash(one.state()), hash(other.state())) << "frame " << i;
    one.advance(frame_of(pinch, i));
    other.advance(frame_of(pinch, i));
  }
}

TEST(StateBytes, are_the_same_again_after_they_have_been_read) {
  const std::string bytes = to_bytes(held(90)->state());
  EXPECT_EQ(to_bytes(state_from_bytes(bytes, 2)), bytes);
}

std::string refusal(const std::string& bytes, std::size_t bodies) {
  try {
    state_from_bytes(bytes, bodies);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(StateBytes, that_are_damaged_cut_or_of_another_scene_are_refused) {
  const std::string good = to_bytes(held(90)->state());
  ASSERT_EQ(refusal(good, 2), "");
  EXPECT_NE(refusal(good, 3).find("scene"), std::string::npos);
  EXPECT_NE(refusal("", 2), "");
  EXPECT_NE(refusal(good.substr(0, good.size() / 2), 2), "");
  for (std::size_t place = 0; place < good.size(); place += 997) {
    std::string bad = good;
    bad[place] = static_cast<char>(bad[place] ^ 0x10);
    EXPECT_NE(refusal(bad, 2), "") << "byte " << place;
  }
}

}  // namespace
}  // namespace mrhi
