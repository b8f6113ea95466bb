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

/// Why a frame was rejected; `none`: it was taken. See StampCheck.
enum class Rejection : std::uint8_t {
  none,
  stamp_not_increasing,  ///< repeats or goes back; a restarted stream is taken from its third frame
  stamp_ahead,           ///< far ahead of its stream; after a real gap, frames are taken from the second
  no_stamp               ///< outside the range of stamps
};
const char* to_string(Rejection rejection);

/// Force that grasp assist adds to the contacts of a hand with a body.
struct GraspSupport {
  std::uint8_t hand = 0;            ///< index of the hand's track
  std::uint16_t body = 0;           ///< index in Scene::bodies
  Vector3 force = Vector3::Zero();  ///< on the body, mean over the time since the previous frame, world [N]
};

/// Result of one frame. Valid until the next frame.
struct FrameResult {
  Nanoseconds stamp = 0;
  std::vector<Hand> tracked;           ///< filtered
  std::vector<RenderedHand> rendered;  ///< same order
  /// Contacts at the frame's end or since the previous frame. Forces are means over that time: the
  /// transferred momentum divided by it. Contacts that have ended have no depth.
  std::vector<Contact> contacts;
  std::vector<GraspSupport> assists;  ///< of all active grips, by hand and body
  std::vector<Event> events;
  /// Items with values that are not finite, such as "object 'cube'", which were left out or put back at their
  /// start.
  std::vector<std::string> not_finite;
  bool restarted = false;  ///< time went back (a looping bag): everything is at its start
};

/// Stages of a step, in order.
enum class Stage : std::uint8_t { neighbours, hand_contacts, body_contacts, response, flight };
constexpr int kStages = 5;
const char* to_string(Stage stage);

/// Hands and objects through time. One call per frame:
///   if (simulation.begin(frame) == Rejection::none) { while (simulation.step()) {} use(simulation.end()); }
/// or advance(), which does the same. A program that needs forces before the rendered hands calls report()
/// before end(). Copyable by copying state().
class Simulation {
 public:
  /// Throws std::invalid_argument if the scene has no usable body state (see complete(Body&)), or for a step
  /// that is not from a microsecond to a second.
  Simulation(Scene scene, const Configuration& configuration);
  ~Simulation();

  /// Takes the hands at the frame's stamp and plans the steps from the last stamp to this one. `expected`:
  /// the stamp of a present frame by the input's clock, if known, which distinguishes a gap from a stray
  /// stamp.
  Rejection begin(const HandFrame& frame, const std::optional<Nanoseconds>& expected = {});
  /// Advances by one step of at most Configuration::step, or over the whole of a short frame in which nothing
  /// comes near anything. Returns false, without a step, once the frame's stamp is reached.
  bool step();
  /// Reports contacts with their forces, events and tracked hands of the frame, without rendered hands. Call
  /// after step() has returned false.
  const FrameResult& report();
  /// Returns the complete result: calls report() if that was not done, and renders the hands.
  const FrameResult& end();

  Rejection advance(const HandFrame& frame);
  const FrameResult& result() const;
  /// Deepest penetration of a rendered capsule in any body or fixture at the frame's end [m], >= 0. Omits
  /// bodies that were spawned in the hand, until it is clear of them.
  double deepest_rendered() const;

  /// Advances to `time` without frames. The next frame continues with the same bits as if this had not been
  /// called. Does nothing until hold_time after the last frame. True if there is a new result.
  bool advance_without_hands(Nanoseconds time);

  /// Puts everything back to its start. The next frame may have any stamp.
  void reset();

  /// For measurements: calls `ended` at the end of each stage of a step. The simulation itself reads no
  /// clock.
  void watch(std::function<void(Stage)> ended);

  const Scene& scene() const;
  const Configuration& configuration() const;
  /// Between the steps of a frame, isolated bodies are still where the frame began.
  const SimulationState& state() const;
  /// Stamp up to which bodies have been advanced, between the steps of a frame too.
  Nanoseconds time() const;
  void set_state(const SimulationState& state);
  /// Continues from the state of a simulation of another scene or configuration. Bodies are identified by
  /// name. Call between frames.
  void go_on_from(const Simulation& other);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mrhi
