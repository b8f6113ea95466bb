#pragma once

#include <array>
#include <vector>

#include "../collision/neighbours.h"
#include "../collision/step_motion.h"
#include "../response/island_problem.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// The operators: places their hands in world, and applies the reactions of all forces that their hands apply
/// to objects and fixtures. The state has a body for each operator; everything else here lasts one frame.
class Operators {
 public:
  /// Keeps a reference.
  explicit Operators(const Scene& scene);

  bool none() const { return scene_.operators.empty(); }

  /// Once a frame of `seconds`, when the hands' next poses are known.
  void begin_frame(double seconds, const SimulationState& state);
  /// Every step, `left` [s] before the frame's end: the operators' motion as it starts. False if hands may
  /// leave the places that carried() predicted; predict() is then due.
  bool begin_step(double left, const SimulationState& state);
  /// Predicts where carried hands may be in the next seconds of the frame, from the operators' present
  /// motion.
  void predict(double seconds);
  /// Predicted frame of a hand, for Neighbours; null for a hand that is tracked in world.
  const CarriedFrame* carried(std::size_t slot) const { return none() ? nullptr : &carried_[owners_[slot]]; }

  /// Motion of the operator of the hand in a slot; null for a hand that is tracked in world.
  const CarrierMotion* carrier(std::size_t slot) const {
    return none() ? nullptr : &carriers_[owners_[slot]];
  }
  /// The bodies of hands' operators, by slot; null without operators.
  const std::array<int, kMaxHands>* bodies_of_hands() const { return none() ? nullptr : &bodies_of_hands_; }
  /// A body's pose in the frame in which a hand is tracked.
  Pose in_hands_frame(std::size_t slot, std::size_t body, const SimulationState& state) const;
  /// At a frame's end, when bodies and hands are at its stamp.
  void end_frame(const SimulationState& state);
  /// The track of a hand with its poses in world, at the frame's start and end. Call after end_frame().
  const HandTrack& in_world(std::size_t slot, const SimulationState& state) const {
    return none() ? state.hands[slot] : in_world_[slot];
  }

  /// Computes the operators' compliance to impacts of their hands. Call before the response.
  void begin_contacts(SimulationState& state);
  /// Applies the reactions of objects to the operators, lets their hands hold and push fixtures, and enforces
  /// restraints and tethers. Call after the response.
  void respond(ContactStep& step, const std::vector<char>& restrained);

 private:
  Pose frame(const Operator& op, const SimulationState& state) const;
  Twist react(const ContactStep& step, int body) const;
  void note_momenta(std::size_t body, const SimulationState& state);
  void touch_fixtures(ContactStep& step, int body);
  void pull(ContactStep& step, const Tether& tether) const;

  const Scene& scene_;
  IslandProblem problem_;
  std::vector<Contact*> on_fixtures_;

  /// A body that hands touch or grasp, before the response.
  struct Touched {
    std::size_t body;
    Vector3 linear_momentum, angular_momentum;
  };
  std::vector<Touched> touched_;  // free bodies, each once
  bool touches_fixture_ = false;  // some contact is with a fixture

  /// Departure of an operator's motion in a frame from its prediction.
  struct Course {
    Twist predicted;
    double departed = 0.0, left = 0.0;  // [m], [s]
    double allowed = 0.0;               // departure at which neighbours are listed again [m]
  };
  std::vector<CarrierMotion> carriers_;  // by operator
  std::vector<Pose> start_;              // of their frames at the frame's start
  std::vector<Course> courses_;
  std::vector<CarriedFrame> carried_;
  std::array<int, kMaxHands> owners_{};  // of hands, indices in Scene::operators
  std::array<int, kMaxHands> bodies_of_hands_{};
  std::vector<HandTrack> in_world_;  // by slot; only poses and flags
};

}  // namespace mrhi
