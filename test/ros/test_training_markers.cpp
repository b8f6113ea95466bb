#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>

#include "math/fnv1a.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "ros/marker_layers.h"
#include "support/fixtures.h"
#include "support/reviewed_bits.h"
#include "support/temporary_folder.h"
#include "training/trials.h"

namespace mrhi {
namespace {

using mr_hand_interaction::ObjectState;
using mr_hand_interaction::TrainingStatus;
using visualization_msgs::Marker;

/// The eye of an orbiting view of rviz, and the axes of its picture.
struct Eye {
  Vector3 place, ahead, up, right;
  double half_height;  ///< of what it sees, at 1 m

  explicit Eye(const std::string& file) {
    const YAML::Node view = YAML::LoadFile(file)["Visualization Manager"]["Views"]["Current"];
    const double yaw = view["Yaw"].as<double>(), pitch = view["Pitch"].as<double>();
    const Vector3 back(std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch), std::sin(pitch));
    const YAML::Node focus = view["Focal Point"];
    place = Vector3(focus["X"].as<double>(), focus["Y"].as<double>(), focus["Z"].as<double>()) +
            view["Distance"].as<double>() * back;
    ahead = -back;
    right = ahead.cross(Vector3::UnitZ()).normalized();
    up = right.cross(ahead);
    half_height = std::tan(0.5 * view["Field of View"].as<double>());
  }
  double depth(const Vector3& point) const { return ahead.dot(point - place); }
  /// From the middle of the picture, in halves of its height.
  double x(const Vector3& point) const { return right.dot(point - place) / depth(point) / half_height; }
  double y(const Vector3& point) const { return up.dot(point - place) / depth(point) / half_height; }
};

class TrainingMarkers : public ::testing::Test {
 protected:
  TrainingMarkers() {
    session_.emplace(test::shipped_task("pick_and_place"), header_, 0, folder_.path(), 0);
    status_.trial = status_.trials = 1;
    status_.object = "cube";
    status_.instruction = instruction_now(*session_, false, true);
    object_.pose.position.z = 0.22;
  }

  std::vector<Marker> shown(const std::string& layer) {
    std::vector<Marker> found;
    for (const Marker& marker : training_markers(*session_, body_, status_, object_).markers) {
      if (marker.ns == layer) found.push_back(marker);
    }
    return found;
  }

  const test::Folder folder_;
  const Body body_ = testing_body();
  const SessionHeader header_ = test::header();
  std::optional<Session> session_;
  TrainingStatus status_;
  ObjectState object_;

 private:
  static Body testing_body() { return mrhi::testing::box_body({0.05, 0.05, 0.05}, 0.1); }
};

/// Half the width of what is written, in halves of the picture's height; letters are narrower than high.
double half_width(const Marker& text, const Eye& eye) {
  const Vector3 place = from_message(text.pose.position);
  return 0.5 * 0.6 * text.scale.z * static_cast<double>(text.text.size()) / eye.depth(place) /
         eye.half_height;
}

TEST_F(TrainingMarkers, what_is_to_be_read_is_large_in_the_picture_and_before_what_hands_do) {
  const Eye eye("rviz/training.rviz");
  constexpr double kHand = 0.15;       // about what is held [m]
  constexpr double kNarrowest = 1.33;  // a picture of 4 to 3
  for (const std::string layer : {"instructions", "result"}) {
    status_.phase = TrainingStatus::RUNNING;
    for (const Marker& text : shown(layer)) {
      const Vector3 place = from_message(text.pose.position);
      EXPECT_LT(std::abs(eye.y(place)), 0.97) << text.text;
      EXPECT_LT(half_width(text, eye), kNarrowest) << text.text;
      EXPECT_GT(text.scale.z / eye.depth(place) / eye.half_height, 0.06) << text.text;  // 24 pixels of 800
      for (const Goal& goal : session_->task().goals) {
        EXPECT_TRUE(goal.stage != TrainingStage::maintenance ||
                    eye.depth(place) < eye.depth(goal.position) - kHand);
      }
    }
  }
}

TEST_F(TrainingMarkers, a_hand_at_a_place_and_its_sleeve_are_below_what_is_to_be_read) {
  const Eye eye("rviz/training.rviz");
  const Vector3 sleeve_end(0.0, 0.0, 0.15);  // from what is held by a hand above it [m]
  status_.phase = TrainingStatus::RUNNING;
  status_.instruction = instruction(session_->task(), 2, "flat_cuboid");
  for (const std::string layer : {"instructions", "result"}) {
    for (const Marker& text : shown(layer)) {
      const Vector3 place = from_message(text.pose.position);
      const double lower_edge = eye.y(place) - 0.5 * text.scale.z / eye.depth(place) / eye.half_height;
      for (const Goal& goal : session_->task().goals) {
        if (goal.stage != TrainingStage::maintenance) continue;
        EXPECT_LT(eye.y(goal.position + sleeve_end), lower_edge) << text.text;
      }
    }
  }
}

TEST_F(TrainingMarkers, the_timer_is_clear_of_places_and_of_other_text) {
  const Eye eye("rviz/training.rviz");
  test::Feeder hand(session_->task());
  session_->begin(0);
  status_.phase = TrainingStatus::RUNNING;
  Observation seen = hand.seen;
  const auto see = [&](const Vector3& position) {
    seen.stamp += 10'000'000;
    seen.pose.position = position;
    seen.held = true;
    session_->update(seen);
  };
  see({0, 0, 0.22});
  for (int i = 0; i < 60; ++i) see({0, 0, 0.30});
  const Vector3 first(-0.10, 0.02, 0.27);
  for (int i = 0; i < 100; ++i) see(first);
  status_.progress = 0.3;
  status_.remaining = 2.0;
  const auto timers = shown("timer");
  ASSERT_EQ(timers.size(), 1u);
  const Vector3 place = from_message(timers[0].pose.position);
  EXPECT_LT(std::abs(eye.x(place)) + half_width(timers[0], eye), 1.33);
  for (const char* const layer : {"instructions", "result", "places"}) {
    for (const Marker& text : shown(layer)) {
      if (text.type != Marker::TEXT_VIEW_FACING) continue;
      const Vector3 other = from_message(text.pose.position);
      const double beside =
          std::abs(eye.x(place) - eye.x(other)) - half_width(timers[0], eye) - half_width(text, eye);
      EXPECT_TRUE(beside > 0.0 || std::abs(eye.y(place) - eye.y(other)) > 0.1) << text.text;
    }
  }
}

TEST_F(TrainingMarkers, places_are_seen_before_their_turn_and_fainter) {
  status_.phase = TrainingStatus::READY;
  int forms = 0;
  for (const Marker& marker : shown("places")) {
    if (marker.type == Marker::TEXT_VIEW_FACING) continue;
    EXPECT_TRUE(!marker.colors.empty() || marker.color.a < 0.2f);
    for (const auto& colour : marker.colors) EXPECT_LT(colour.a, 0.3f);
    ++forms;
  }
  EXPECT_EQ(forms, 2 * 3);  // form and ring of three places
  EXPECT_TRUE(shown("target").empty());
}

TEST_F(TrainingMarkers, the_object_is_highlighted_until_it_is_held) {
  status_.phase = TrainingStatus::RUNNING;
  const auto highlight = shown("object");
  ASSERT_EQ(highlight.size(), 2u);
  EXPECT_NEAR(highlight[0].scale.x, 1.12 * 0.05, 1e-9);
  EXPECT_LT(highlight[0].color.a, 0.5f);
  for (const auto& point : highlight[1].points)
    EXPECT_GT(point.z, object_.pose.position.z + body_.bounding_radius);
  object_.held = true;
  EXPECT_TRUE(shown("object").empty());
}

TEST_F(TrainingMarkers, have_the_bits_that_were_reviewed) {
  test::ReviewedBits bits("test/ros/training_bits.csv", "task,waiting,running");
  if (!bits.made_elsewhere().empty()) GTEST_SKIP() << bits.made_elsewhere();
  for (const char* task : {"assemble", "nudge_into_box", "pick_and_place", "tap"}) {
    session_.emplace(test::shipped_task(task), header_, 0, folder_ / task, 0);
    const auto hash = [&](std::initializer_list<std::uint8_t> phases) {
      Fnv1a sum;
      for (const std::uint8_t phase : phases) {
        status_.phase = phase;
        for (int i = 0; i < 4; ++i) {
          object_.held = i % 2 == 1;
          status_.inside = i > 1;
          status_.progress = 0.3 * i;
          status_.remaining = 2.0 - 0.5 * i;
          const auto markers = training_markers(*session_, body_, status_, object_);
          std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(markers));
          ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
          ros::serialization::serialize(stream, markers);
          sum.add(bytes.data(), bytes.size());
        }
      }
      return test::hexadecimal(sum.value);
    };
    const std::string waiting =
        hash({TrainingStatus::READY, TrainingStatus::PAUSED, TrainingStatus::FINISHED});
    session_->begin(0);
    bits.compare(task, waiting + "," + hash({TrainingStatus::RUNNING, TrainingStatus::PAUSED}));
  }
  bits.check("ros");
}

// The object leaves the hand at 1 cm/s; drift is its way in two seconds.
TEST_F(TrainingMarkers, the_result_has_the_drift_in_millimetres) {
  session_.emplace(test::two_places(), header_, 0, folder_ / "drift", 0);
  session_->begin(0);
  Observation seen = test::Feeder(session_->task()).seen;
  const auto see = [&](const Vector3& from, bool held, double seconds, const Vector3& velocity) {
    seen.held = held;
    seen.twist.linear = velocity;
    for (int i = 0; i < std::lround(100 * seconds); ++i) {
      seen.stamp += 10'000'000;
      seen.pose.position = from + 0.01 * i * velocity;
      session_->update(seen);
    }
  };
  const Vector3 still = Vector3::Zero();
  see(still, false, 0.5, still);
  see({0.06, 0, 0}, true, 0.5, still);
  see(test::kFirst, true, 3.1, still);
  see(test::kSecond, true, 3.1, still);
  see(test::kSecond, false, 2.1, {0.006, 0.008, 0.0});
  ASSERT_TRUE(session_->last());
  const auto results = shown("result");
  ASSERT_EQ(results.size(), 1u);
  EXPECT_NE(results[0].text.find(", drifted 20 mm"), std::string::npos) << results[0].text;
}

}  // namespace
}  // namespace mrhi
