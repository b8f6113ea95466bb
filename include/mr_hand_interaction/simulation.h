#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/interaction.h"
#include "mr_hand_interaction/rendering/rendered_hand.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/simulation_state.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// Reason why a frame of input was rejected; `none` if it was accepted. See StampCheck.
enum class Rejection : std::uint8_t {
  none,
  stamp_not_increasing,  ///< repeats or goes back; a restarted stream is accepted from its third frame
  stamp_ahead,           ///< far ahead of its stream; after a real gap, frames are accepted from the second
  no_stamp               ///< outside the range of a stamp
};
const char* to_string(Rejection rejection);

/// Wrench that grasp assist adds to a hand's contacts with a body: on the body, mean since the last frame,
/// world.
struct GraspSupport {
  std::uint8_t hand = 0;             ///< index of the hand's track
  std::uint16_t body = 0;            ///< index in Scene::bodies
  Vector3 force = Vector3::Zero();   ///< [N]
  Vector3 torque = Vector3::Zero();  ///< about the centre of mass [N m]
};

/// Results of one frame. Valid until the next frame.
struct FrameResult {
  Nanoseconds stamp = 0;
  std::vector<Hand> tracked;           ///< filtered
  std::vector<RenderedHand> rendered;  ///< in the same order
  /// Contacts at the end of the frame, and those that have ended since the last frame, with a depth of 0.
  /// Forces are means over the time since the last frame: the transferred momentum over that time.
  std::vector<Contact> contacts;
  std::vector<GraspSupport> assists;  ///< of all active grips, by hand and body
  std::vector<Event> events;
  /// Items with a value that was not finite, and that were left out or reset: "object 'cube'". Normally
  /// empty.
  std::vector<std::string> not_finite;
  bool restarted = false;  ///< time went back (a looping bag): everything was reset
};

/// Stages of a step, in order.
enum class Stage : std::uint8_t { neighbours, hand_contacts, body_contacts, response, flight };
constexpr int kStages = 5;
const char* to_string(Stage stage);

/// Simulates hands and objects. One call per frame:
///   if (simulation.begin(frame) == Rejection::none) { while (simulation.step()) {} use(simulation.end()); }
/// or advance(), which does the same. For forces before rendering, call report() before end(). Copy state()
/// to copy a simulation.
class Simulation {
 public:
  /// Throws std::invalid_argument if a body of the scene is invalid (see complete(Body&)), or if the step is
  /// not from a microsecond to a second.
  Simulation(Scene scene, const Configuration& configuration);
  ~Simulation();

  /// Takes the hands at the frame's stamp and plans their paths since the last one. `expected`: stamp of a
  /// frame sent now, by a clock of the input, if there is one; it distinguishes a gap from a stray stamp.
  Rejection begin(const HandFrame& frame, const std::optional<Nanoseconds>& expected = {});
  /// Advances by one step of at most Configuration::step, or by a whole short frame in which no two bodies
  /// come near each other. Returns false, without a step, once the frame's stamp is reached.
  bool step();
  /// Contacts with their forces, events and tracked hands of the frame; rendered hands are not available yet.
  /// Call after step() has returned false.
  const FrameResult& report();
  /// All results of the frame. Renders the hands, and calls report() if that was not done.
  const FrameResult& end();

  Rejection advance(const HandFrame& frame);
  const FrameResult& result() const;
  /// Deepest penetration of a rendered capsule in any body, fixtures included, at the end of the frame [m],
  /// >= 0. Bodies spawned in the hand are left out until it is clear of them.
  double deepest_rendered() const;

  /// Advances to `time` without frames. The next frame continues with the same bits as without this call.
  /// Does nothing until hold_time after the last frame. Returns true if there is a new result.
  bool advance_without_hands(Nanoseconds time);

  /// Resets everything to its start. The next frame may have any stamp.
  void reset();

  /// Calls `ended` at the end of each stage of a step, for measurements. The simulation reads no clock.
  void watch(std::function<void(Stage)> ended);

  const Scene& scene() const;
  const Configuration& configuration() const;
  /// Between the steps of a frame, bodies that nothing can reach within it are still at its start.
  const SimulationState& state() const;
  /// Stamp up to which bodies have been advanced, also between the steps of a frame.
  Nanoseconds time() const;
  void set_state(const SimulationState& state);
  /// Continues from a simulation of another scene or configuration, by the names of bodies. Call between
  /// frames.
  void go_on_from(const Simulation& other);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mrhi
