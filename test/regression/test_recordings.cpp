#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/replay/recording_csv.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/simulation.h"
#include "mr_hand_interaction/tracking/joints.h"
#include "support/recordings.h"

namespace mrhi {
namespace {

constexpr double kDeepestRendered = 0.0005;  // [m]

const Pose kDeskMount{Vector3::Zero(), Quaternion(Eigen::AngleAxisd(0.5 * M_PI, Vector3::UnitX()))};

struct Outcome {
  int frames = 0;
  int contacts = 0;
  bool finite = true;
  double deepest_rendered = 0.0;  // [m]
  double fastest_phalanx = 0.0;   // [m/s]
  double fastest_object = 0.0;    // [m/s]
  double restitution = 0.0;       // largest in the scene
};

double fastest_joint(const Hand& from, const Hand& to, double seconds) {
  double fastest = 0.0;
  for (std::size_t c = 0; c < kCapsules; ++c) {
    const Capsule &a = from.capsules[c], &b = to.capsules[c];
    if (a.radius <= 0.0 || b.radius <= 0.0) continue;
    fastest = std::max({fastest, (a.start - b.start).norm(), (a.end - b.end).norm()});
  }
  return fastest / seconds;
}

void note(const Simulation& simulation, Outcome& outcome) {
  const FrameResult& result = simulation.result();
  ++outcome.frames;
  outcome.contacts += static_cast<int>(result.contacts.size());
  outcome.deepest_rendered = std::max(outcome.deepest_rendered, simulation.deepest_rendered());
  for (const RenderedHand& rendered : result.rendered) {
    for (const Capsule& capsule : rendered.hand.capsules) {
      outcome.finite = outcome.finite && capsule.start.allFinite() && capsule.end.allFinite();
    }
  }
  for (std::size_t b = 0; b < simulation.scene().bodies.size(); ++b) {
    const BodyState& state = simulation.state().bodies[b];
    outcome.finite = outcome.finite && state.pose.position.allFinite() &&
                     state.pose.orientation.coeffs().allFinite() && state.angular_momentum.allFinite();
    const double speed = twist_of(simulation.scene().bodies[b], state).linear.norm();
    outcome.fastest_object = std::max(outcome.fastest_object, speed);
  }
}

Outcome run(const std::string& file, const std::string& scene_name) {
  const Configuration configuration;
  SceneOptions options;
  options.default_material = default_material(configuration);
  Simulation simulation(load_scene("config/scenes/" + scene_name + ".urdf", options), configuration);
  Outcome outcome;
  for (const Body& body : simulation.scene().bodies) {
    outcome.restitution = std::max(outcome.restitution, body.material.restitution);
  }
  std::vector<std::string> defects;
  HandFrame before;
  for (const JointsFrame& joints : read_recording_csv(file)) {
    const std::optional<HandFrame> frame = complete_frame(joints, kDeskMount, defects);
    if (!frame || simulation.advance(*frame) != Rejection::none) continue;
    for (const Hand& hand : frame->hands) {
      for (const Hand& earlier : before.hands) {
        if (hand.id != earlier.id || hand.side != earlier.side) continue;
        const double speed = fastest_joint(earlier, hand, to_seconds(frame->stamp - before.stamp));
        outcome.fastest_phalanx = std::max(outcome.fastest_phalanx, speed);
      }
    }
    before = *frame;
    note(simulation, outcome);
  }
  return outcome;
}

class Recordings : public ::testing::TestWithParam<const char*> {};

// Objects cannot leave the hand faster than Newton's law lets them: a squeezed object is not shot away
// either.
TEST_P(Recordings,
       stay_finite_with_the_rendered_hand_outside_and_objects_no_faster_than_the_hand_makes_them) {
  const std::vector<std::string> files = testing::recordings();
  MRHI_NEED_RECORDINGS(files);
  int touched = 0;
  for (const std::string& file : files) {
    const Outcome outcome = run(file, GetParam());
    EXPECT_GT(outcome.frames, 10) << file;
    EXPECT_TRUE(outcome.finite) << file;
    EXPECT_LE(outcome.deepest_rendered, kDeepestRendered) << file;
    EXPECT_LE(outcome.fastest_object, outcome.fastest_phalanx * (1.0 + outcome.restitution)) << file;
    touched += outcome.contacts > 0;
  }
  // Half of them at least must have met something, or the test would say nothing.
  EXPECT_GE(2 * touched, static_cast<int>(files.size()));
}

INSTANTIATE_TEST_SUITE_P(Scene, Recordings, ::testing::Values("mixed", "cube", "rack"));

}  // namespace
}  // namespace mrhi
