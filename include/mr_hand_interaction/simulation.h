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

/// What a frame of input led to. `none` means that it was taken. See StampCheck.
enum class Rejection : std::uint8_t {
  none,
  stamp_not_increasing,  ///< repeats or goes back; a stream that has really restarted is taken from its third
                         ///< frame
  stamp_ahead,           ///< far ahead of its stream; after a real gap, frames are taken from the second
  no_stamp               ///< beyond what a stamp can be
};
const char* to_string(Rejection rejection);

/// What grasp assist adds to the contacts of a hand with a body.
struct GraspSupport {
  std::uint8_t hand = 0;            ///< index of the hand's track
  std::uint16_t body = 0;           ///< index in Scene::bodies
  Vector3 force = Vector3::Zero();  ///< on the body, mean over the time since the frame before, world [N]
};

/// What one frame led to. Valid until the next frame.
struct FrameResult {
  Nanoseconds stamp = 0;
  std::vector<Hand> tracked;           ///< filtered
  std::vector<RenderedHand> rendered;  ///< same order
  /// Touching at the frame's end, or since the frame before. Their forces are means over the time since then:
  /// the momentum transferred by it. Those that have ended have no depth.
  std::vector<Contact> contacts;
  std::vector<GraspSupport> assists;  ///< of all active grips, by hand and body
  std::vector<Event> events;
  /// What came out as no number, and was left out or put back at its start: "object 'cube'". Empty, if all is
  /// well.
  std::vector<std::string> not_finite;
  bool restarted = false;  ///< time went back (a looping bag): everything is at its start
};

/// The stages of a step, in their order.
enum class Stage : std::uint8_t { neighbours, hand_contacts, body_contacts, response, flight };
constexpr int kStages = 5;
const char* to_string(Stage stage);

/// Hands and objects through time. One call per frame:
///   if (simulation.begin(frame) == Rejection::none) { while (simulation.step()) {} use(simulation.end()); }
/// or advance(), which does just that. Who waits for forces rather than for the picture calls report() before
/// end(). Copyable by copying state().
class Simulation {
 public:
  /// Throws std::invalid_argument if the scene has no usable body state (see complete(Body&)), or for a step
  /// that is not from a microsecond to a second.
  Simulation(Scene scene, const Configuration& configuration);
  ~Simulation();

  /// Takes the hands at the frame's stamp and plans the way from the last stamp to this one. `expected`: the
  /// stamp that a frame of now should have, where a clock of the input tells; so a gap is known from a stray
  /// stamp.
  Rejection begin(const HandFrame& frame, const std::optional<Nanoseconds>& expected = {});
  /// Advances by one step of at most Configuration::step, or over the whole of a short frame in which nothing
  /// comes near anything; false, without a step, once the frame's stamp is reached.
  bool step();
  /// Contacts with their forces, events and tracked hands of the frame, whose rendered hands are still to
  /// come. Call after step() has returned false.
  const FrameResult& report();
  /// All that the frame led to: renders the hands, after report() if that was not called.
  const FrameResult& end();

  Rejection advance(const HandFrame& frame);
  const FrameResult& result() const;
  /// Deepest penetration of a rendered capsule in any body, fixtures too, as the frame ended [m], >= 0. Left
  /// out are bodies that have appeared in the hand, until it is clear of them.
  double deepest_rendered() const;

  /// With no frames coming: moves on to `time`, which the next frame then continues from with the same bits
  /// as if this had not been called. Does nothing until hold_time after the last frame. True if a new result
  /// is there.
  bool advance_without_hands(Nanoseconds time);

  /// Everything back to its start; the next frame may have any stamp.
  void reset();

  /// For those who measure: `ended` is called at the end of each stage of a step. The simulation itself reads
  /// no clock.
  void watch(std::function<void(Stage)> ended);

  const Scene& scene() const;
  const Configuration& configuration() const;
  /// Between the steps of a frame, bodies that nothing may reach within it are still where it began.
  const SimulationState& state() const;
  /// Stamp up to which bodies have been advanced, between the steps of a frame too.
  Nanoseconds time() const;
  void set_state(const SimulationState& state);
  /// Takes over where a simulation of another scene or configuration is, by the names of bodies; see
  /// scene_change.h. Call between frames.
  void go_on_from(const Simulation& other);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mrhi
