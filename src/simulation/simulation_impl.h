#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "../collision/body_contact_finder.h"
#include "../collision/contact_finder.h"
#include "../collision/neighbours.h"
#include "../collision/scene_geometry.h"
#include "../rendering/renderer.h"
#include "../response/contact_step.h"
#include "grasp_assist.h"
#include "isolated_bodies.h"
#include "mr_hand_interaction/simulation.h"
#include "operators.h"
#include "sleeping.h"

namespace mrhi {

/// Momentum transferred by contacts and grasp assist since the frame before; `force` is the sum of force
/// times step [N s].
struct FrameTransfer {
  std::vector<Contact> contacts;      ///< sorted by key
  std::vector<GraspSupport> assists;  ///< sorted by hand and body
  double seconds = 0.0;               ///< time of the steps

  void clear() { contacts.clear(), assists.clear(), seconds = 0.0; }
  void add(const SimulationState& after, double step);

 private:
  void add(const Contact& contact, double step, double force);
};

/// Frames come in, are divided into steps, and each step runs through the stages (simulation_frames.cpp);
/// then the frame's results are made (frame_report.cpp).
struct Simulation::Impl {
  Impl(Scene scene_in, const Configuration& configuration_in);

  void reset();
  void clear_result();

  // Frames.
  Rejection check_stamp(Nanoseconds stamp, const std::optional<Nanoseconds>& expected);
  void plan(Nanoseconds from, Nanoseconds to);
  int steps_needed(Nanoseconds frame);
  void begin_hands(double seconds);
  void list_near_hands();
  /// Time for which a missing hand is kept [s]: tracking/hold_time, and at least 1.5 intervals of the stream.
  double hold_time() const;
  void pass_without_frames(Nanoseconds until, double hold_time);
  void lose_hands(Nanoseconds now, double hold_time);
  /// Contacts as they are at the frame's end, with the mean of their forces and the sum of their impulses
  /// since the frame before; contacts that have ended since then; then the events that follow from them, and
  /// the tracked hands.
  void report(Nanoseconds stamp);
  void find_final_contacts();
  void update_interactions();
  void end_interactions(std::size_t slot, Nanoseconds now);
  void render();
  const HandTrack& lagging_track(std::size_t slot, std::unique_ptr<HandTrack>& lagging);

  // Values that are not finite are removed, and their owners named in the result.
  void lose_hands_that_are_not_finite(Nanoseconds now);
  void leave_out_contacts_that_are_not_finite();
  void show_hands_that_are_finite();

  // A step.
  double driven(double step) const;
  void advance_step(double fraction, double step);
  void keep_in_bounds();
  bool may_isolate() const { return operators.none() && scene.tethers.empty(); }

  const Scene scene;
  const Configuration configuration;
  const Vector3 gravity;
  const Nanoseconds step_length;
  const std::unique_ptr<ContactModel> model;
  const Nanoseconds quiet_frame;  // the longest that may be a single step
  const SceneGeometry geometry;
  Neighbours neighbours;
  ContactFinder finder;
  BodyContactFinder body_finder;
  Operators operators;
  IsolatedBodies isolated;
  Sleeping sleeping;
  GraspAssist assist;
  HandRenderer renderer;

  SimulationState state;
  FrameResult result;
  bool reported = false;  // the result is complete except for the rendered hands

  // Time from the previous frame to this one.
  Nanoseconds frame_from = 0, frame_to = 0;
  int steps = 0, steps_done = 0;
  double frame_seconds() const { return to_seconds(frame_to - frame_from); }

  std::vector<HandMotion> hands;  // those that can touch
  FrameTransfer transfer;
  StepChanges changes;
  std::function<void(Stage)> ended;
  void end_stage(Stage stage) const {
    if (ended) ended(stage);
  }
};

bool is_finite(const BodyState& state);

/// Interaction level of a hand and a body from their present contacts, or from their distance without
/// contacts. A grasp needs two or more parts of the hand whose loads on the body largely balance; a floating
/// linkage counts as one body. With hysteresis: a level of `before` may last with a larger distance or less
/// balance.
InteractionLevel seen_level(const Hand& hand, int slot, int body, const ContactFinder& finder,
                            const Scene& scene, const Pose& body_pose, const std::vector<Contact>& contacts,
                            InteractionLevel before);

}  // namespace mrhi
