#pragma once

#include <ctime>
#include <optional>

#include "fuzz/ledger.h"
#include "fuzz/step_case.h"
#include "support/joints.h"

namespace mrhi::fuzzing {

/// Beyond the CPU time of any step of these scenes [s]; sanitizers take ten times that of the core.
#if defined(MRHI_CORPUS_TEST) || defined(MRHI_SHIPPED_CORE)
constexpr double kLongestStep = 0.25;
#else
constexpr double kLongestStep = 2.0;
#endif
/// Of joints, whose bodies are where they have them to rounding [m], [rad].
constexpr double kApart = 1e-6;

inline bool finite(const Hand& hand) {
  return std::all_of(hand.capsules.begin(), hand.capsules.end(), [](const Capsule& capsule) {
    return capsule.start.allFinite() && capsule.end.allFinite() && std::isfinite(capsule.radius);
  });
}

inline void check_bodies(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyState& state = simulation.state().bodies[b];
    require(state.linear_momentum.allFinite() && state.angular_momentum.allFinite() &&
                state.pose.position.allFinite() && state.pose.orientation.coeffs().allFinite(),
            "bodies are finite");
    require(scene.bodies[b].fixed || ((state.pose.position.array() >= scene.bounds.min.array()).all() &&
                                      (state.pose.position.array() <= scene.bounds.max.array()).all()),
            "bodies are inside the bounds");
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const testing::Apart apart = testing::apart(simulation, j);
    require(apart.place <= kApart && apart.turn <= kApart,
            "joints hold together, but for " + text::number(apart.place) + " m");
  }
}

inline void check_result(const Simulation& simulation) {
  const FrameResult& result = simulation.result();
  require(result.not_finite.empty(),
          "nothing is put right: " + (result.not_finite.empty() ? "" : result.not_finite[0]));
  for (const Hand& hand : result.tracked) require(finite(hand), "tracked hands are finite");
  for (const RenderedHand& hand : result.rendered) require(finite(hand.hand), "drawn hands are finite");
  for (const Contact& contact : result.contacts)
    require(contact.force.allFinite() && contact.impulse.allFinite(), "forces are finite");
  check_bodies(simulation);
}

/// Not where something is put back.
inline bool keeps_books(const Simulation& simulation) {
  const FrameResult& result = simulation.result();
  return !result.restarted &&
         std::none_of(result.events.begin(), result.events.end(),
                      [](const Event& event) { return event.kind == EventKind::out_of_bounds; });
}

/// Springs whose force is that of the step's start can give more than they took: see docs/reliability.md.
inline bool has_explicit_springs(const Simulation& simulation) {
  const ContactModelKind model = simulation.configuration().contact_model;
  return model != ContactModelKind::implicit && model != ContactModelKind::impulse;
}

inline bool is_borne(const Scene& scene) {
  return !scene.joints.empty() ||
         std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) { return body.fixed; });
}

/// Springs that are no deeper than rounding store nothing.
inline bool touches(const Simulation& simulation) {
  constexpr double kNoDepth = 1e-9;  // [m]
  const SimulationState& state = simulation.state();
  return !state.grips.empty() ||
         std::any_of(state.body_contacts.begin(), state.body_contacts.end(),
                     [](const BodyContact& contact) { return contact.depth > kNoDepth; }) ||
         std::any_of(state.contacts.begin(), state.contacts.end(),
                     [](const Contact& contact) { return contact.touching(); });
}

/// What came of a case.
struct Played {
  std::uint64_t hash = 0;
  int booked = 0, borne = 0;  ///< frames of which books were kept, and those with a grip that bears
  double surplus = 0.0;       ///< the greatest Ledger::surplus()
};

class Playing {
 public:
  explicit Playing(const StepCase& played)
      : played_(played), simulation_(played.scene, played.configuration) {
    simulation_.watch([this](Stage ended) {
      if (ended == Stage::response && ledger_) ledger_->see();
    });
  }

  Played all() {
    Nanoseconds last = testing::kStart;
    for (const JointsFrame& joints : played_.frames) {
      std::vector<std::string> defects;
      const auto frame = complete_frame(joints, Pose(), defects);
      if (!frame) continue;
      advance(*frame);
      last = std::max(last, simulation_.time());
    }
    go_on_after(last);
    made_.hash = hash(simulation_.state());
    return made_;
  }

 private:
  void advance(const HandFrame& frame) {
    // What is simulated of a silence before a frame is not seen step by step.
    if (simulation_.state().started && frame.stamp - simulation_.time() > 100'000'000) ledger_.reset();
    if (simulation_.begin(frame) != Rejection::none) return;
    const std::clock_t began = std::clock();  // not a clock on the wall: the machine may be busy
    int steps = 0;
    for (Nanoseconds before = simulation_.time(); simulation_.step(); before = simulation_.time(), ++steps)
      if (ledger_) ledger_->note(to_seconds(simulation_.time() - before));
    simulation_.end();
    require(static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC < kLongestStep * (1 + steps),
            "a step takes a bounded time");
    check_result(simulation_);
    check_books();
  }

  void check_books() {
    if (!keeps_books(simulation_)) ledger_.reset();
    if (ledger_) {
      if (!is_borne(simulation_.scene())) ledger_->check_momentum();
      if (!has_explicit_springs(simulation_)) ledger_->check_energy();
      made_.surplus = std::max(made_.surplus, ledger_->surplus());
      ++made_.booked;
      const auto& grips = simulation_.state().grips;
      made_.borne += std::any_of(grips.begin(), grips.end(), [](const Grip& grip) { return grip.active; });
    }
    // Bodies that start inside each other gain energy as they are pushed apart.
    if (!played_.overlaps && !touches(simulation_)) ledger_.emplace(simulation_);
  }

  /// The next good frames work.
  void go_on_after(Nanoseconds last) {
    int taken = 0;
    for (int i = 1; i <= 4; ++i) {
      const Hand hand = testing::posed_hand(relaxed_posture(), {});
      taken += simulation_.advance({last + i * 10'000'000, {hand}}) == Rejection::none;
    }
    require(taken >= 2, "good frames are taken");
    require(simulation_.result().tracked.size() >= 1, "a good hand is followed");
    check_result(simulation_);
  }

  const StepCase& played_;
  Simulation simulation_;
  std::optional<Ledger> ledger_;  // there while books are kept
  Played made_;
};

inline Played play(const StepCase& played) {
  return Playing(played).all();
}

}  // namespace mrhi::fuzzing
