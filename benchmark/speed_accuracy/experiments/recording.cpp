// A tracked hand closes on an object. The error of "recording" is against our own converged solution, that of
// "recording_self" against each engine's own solution at a small step. Without a recording a scripted hand
// with a tracker's noise and rate is used, and the scenes are "scripted_hand" and "scripted_hand_self".
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>

#include "../experiment.h"
#include "../run.h"
#include "configured.h"
#include "mr_hand_interaction/replay/recording_csv.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi::benchmark {
namespace {

constexpr const char* kRecording = "ljp_pinch_115.csv";
constexpr double kObject = 0.02;                                                 // edge [m]
constexpr double kReferenceStep = 0.0000625;                                     // [s]
constexpr double kOwnReferenceStep = 0.000125, kQuickOwnReferenceStep = 0.0005;  // [s]

std::string recording_file() {
  const char* folder = std::getenv("MR_HAND_RECORDINGS");
  return std::string(folder != nullptr && *folder != '\0' ? folder : SPEED_ACCURACY_RECORDINGS) + "/" +
         kRecording;
}

/// The capsules of a recorded hand over time, each a rigid body of its mean length.
class RecordedHand {
 public:
  /// `file` empty: the scripted hand.
  explicit RecordedHand(const std::string& file) {
    const Pose mount{Vector3::Zero(), Quaternion(Eigen::AngleAxisd(0.5 * M_PI, Vector3::UnitX()))};
    std::vector<std::string> defects;
    for (const JointsFrame& joints : file.empty() ? record_motion(scripted()) : read_recording_csv(file)) {
      const auto frame = complete_frame(joints, mount, defects);
      if (!frame || frame->hands.empty()) continue;
      times_.push_back(to_seconds(frame->stamp));
      hands_.push_back(frame->hands.front());
    }
    for (double& time : times_) time -= times_.front() * (&time != &times_.front());
    times_.front() = 0.0;
    for (int c = 0; c < kCapsules; ++c)
      if (hands_.front().has(c)) used_.push_back(static_cast<std::size_t>(c));
  }

  static SyntheticHandOptions scripted() {
    SyntheticHandOptions options;
    options.motion = "pinch_long";
    return options;
  }
  double seconds() const { return times_.back(); }
  std::size_t parts() const { return used_.size(); }

  KinematicSpec part(std::size_t i) const {
    double length = 0.0, radius = 0.0;
    for (const Hand& hand : hands_) {
      const Capsule& capsule = hand.capsules[used_[i]];
      length += (capsule.end - capsule.start).norm() / static_cast<double>(hands_.size());
      radius = capsule.radius;
    }
    return {{{Vector3(0, 0, -0.5 * length), Vector3(0, 0, 0.5 * length), radius}}, {}};
  }

  Pose pose(std::size_t i, double t) const {
    const auto after = std::upper_bound(times_.begin(), times_.end(), t);
    const auto b = std::min<std::size_t>(static_cast<std::size_t>(after - times_.begin()), times_.size() - 1);
    const std::size_t a = b - 1;
    const double part = std::clamp((t - times_[a]) / (times_[b] - times_[a]), 0.0, 1.0);
    const Capsule &from = hands_[a].capsules[used_[i]], &to = hands_[b].capsules[used_[i]];
    const Vector3 start = from.start + part * (to.start - from.start),
                  end = from.end + part * (to.end - from.end);
    return {0.5 * (start + end), Quaternion::FromTwoVectors(Vector3::UnitZ(), end - start)};
  }

  /// Between the tips of thumb and index at their closest, with one axis along the line between them.
  Pose grasp() const {
    double closest = 1e9;
    Pose pose;
    for (const Hand& hand : hands_) {
      const Vector3 thumb = hand.capsules[capsule_index(0, 3)].end,
                    index = hand.capsules[capsule_index(1, 3)].end;
      const Vector3 line = index - thumb;
      if (line.norm() >= closest) continue;
      closest = line.norm();
      pose = {0.5 * (thumb + index), Quaternion::FromTwoVectors(Vector3::UnitX(), line)};
    }
    return pose;
  }

 private:
  std::vector<double> times_;
  std::vector<Hand> hands_;
  std::vector<std::size_t> used_;
};

struct Track {
  std::vector<double> times;
  std::vector<Vector3> places;
  Vector3 at(double t) const {
    const auto after = std::lower_bound(times.begin(), times.end(), t);
    if (after == times.begin()) return places.front();
    if (after == times.end()) return places.back();
    const auto b = static_cast<std::size_t>(after - times.begin());
    return places[b - 1] + (t - times[b - 1]) / (times[b] - times[b - 1]) * (places[b] - places[b - 1]);
  }
};

struct Shared {
  std::unique_ptr<RecordedHand> hand;
  Track reference;
};

class Recording final : public Experiment {
 public:
  /// `reference` empty: from the engine's own run.
  Recording(const RecordedHand& hand, const Track& reference, double own_reference_step)
      : hand_(hand), reference_(reference), own_reference_step_(own_reference_step) {}

  double duration() const override { return hand_.seconds(); }
  World world(int) const override {
    World world;
    world.bodies.push_back(box(Vector3::Constant(kObject), 0.02, hand_.grasp()));
    for (std::size_t i = 0; i < hand_.parts(); ++i) world.kinematics.push_back(hand_.part(i));
    return world;
  }
  void hand(int, double t, std::vector<Pose>& poses) const override {
    for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = hand_.pose(i, t);
  }
  bool observe(int, double t, const Engine& engine) override {
    const Vector3 place = engine.motion(0).pose.position;
    track_.times.push_back(t);
    track_.places.push_back(place);
    return place.allFinite() && place.norm() < 100.0;
  }
  double reference_step() const override { return own_reference_step_; }
  void reference_done() override {
    reference_ = track_;
    track_ = Track();
  }
  std::vector<Measure> measures() const override {
    if (reference_.times.empty()) return {};
    double squares = 0.0;
    for (std::size_t i = 0; i < track_.times.size(); ++i)
      squares += (track_.places[i] - reference_.at(track_.times[i])).squaredNorm();
    const double error = std::sqrt(squares / static_cast<double>(track_.times.size()));
    return {{"", 1e3 * error, "mm", !(error < 1.0)}};
  }
  const Track& track() const { return track_; }

 private:
  const RecordedHand& hand_;
  Track reference_;
  double own_reference_step_;
  Track track_;
};

}  // namespace

void add_recording_scenes(std::vector<ScenePlan>& scenes) {
  const std::string file = recording_file();
  const bool there = std::ifstream(file).good();
  const auto shared = std::make_shared<Shared>();
  const auto prepare = [shared, file, there](const EngineMaker& ours) {
    if (shared->hand) return;
    shared->hand = std::make_unique<RecordedHand>(there ? file : "");
    Recording run(*shared->hand, {}, 0.0);
    run_experiment(ours, "implicit", run, kReferenceStep, 60.0, [] {});
    shared->reference = run.track();
  };
  for (const bool self : {false, true}) {
    const auto make = [shared, self](bool quick) {
      return std::make_unique<Recording>(*shared->hand, self ? Track() : shared->reference,
                                         self ? (quick ? kQuickOwnReferenceStep : kOwnReferenceStep) : 0.0);
    };
    const std::string name = there ? "recording" : "scripted_hand";
    scenes.push_back({self ? name + "_self" : name, "recording", {}, make, prepare});
  }
}

}  // namespace mrhi::benchmark
