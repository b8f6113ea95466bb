#pragma once

#include <memory>
#include <string>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// Name of an event as in InteractionEvent.msg, e.g. GRASP_BEGIN.
const char* event_name(EventKind kind);

/// The tables that replay writes, a frame at a time; dictionary.h has their columns. joints.csv is written
/// only if the scene has joints.
class ResultWriter {
 public:
  /// Makes the folder if need be. Throws std::runtime_error naming what cannot be written.
  ResultWriter(const std::string& folder, const Scene& scene);
  ~ResultWriter();

  /// `gravity`: that acts in the frame [m/s^2].
  void write(const FrameResult& result, const SimulationState& state, const Vector3& gravity);
  /// Sets the scene of the frames to come.
  void follow(const Scene& scene);
  void flush();

 private:
  void write_frame(double time, Nanoseconds stamp, const Vector3& gravity);
  void write_bodies(double time);
  void write_objects(double time, const FrameResult& result, const SimulationState& state);
  void write_joints(double time, const SimulationState& state);
  void write_contacts(double time, const FrameResult& result, const SimulationState& state);
  void write_palm(double time, const Hand& hand, const SimulationState& state);
  void write_hand(double time, const Hand& hand, const RenderedHand* rendered);
  void write_events(const FrameResult& result);

  std::string folder_;
  const Scene* scene_;
  bool scene_is_new_ = true;  ///< bodies.csv does not have it yet
  std::size_t frame_ = 0;     ///< number of the current frame
  bool begun_ = false;
  Nanoseconds first_stamp_ = 0;
  struct Tables;
  std::unique_ptr<Tables> tables_;
};

}  // namespace mrhi
