#pragma once

#include <memory>
#include <string>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// Name of an event as in InteractionEvent.msg, e.g. GRASP_BEGIN.
const char* event_name(EventKind kind);

/// The tables that replay writes, a frame at a time: objects.csv, contacts.csv, hands.csv, events.csv and, of
/// a scene with joints, joints.csv.
class ResultWriter {
 public:
  /// Makes the folder if need be. Throws std::runtime_error naming what cannot be written.
  ResultWriter(const std::string& folder, const Scene& scene);
  ~ResultWriter();

  void write(const FrameResult& result, const SimulationState& state);
  /// The scene is another one from now on.
  void follow(const Scene& scene) { scene_ = &scene; }
  void flush();

 private:
  void write_objects(double time, const SimulationState& state);
  void write_joints(double time, const SimulationState& state);
  void write_contacts(double time, const FrameResult& result, const SimulationState& state);
  void write_hand(double time, const Hand& hand, const RenderedHand* rendered);
  void write_events(const FrameResult& result);

  const Scene* scene_;
  bool begun_ = false;
  Nanoseconds first_stamp_ = 0;
  struct Tables;
  std::unique_ptr<Tables> tables_;
};

}  // namespace mrhi
