#pragma once

#include <fstream>
#include <optional>
#include <string>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// Name of an event as in InteractionEvent.msg, e.g. GRASP_BEGIN.
const char* event_name(EventKind kind);

/// A CSV file that is written row by row; numbers with 12 digits. What was written stays whatever comes
/// after.
class CsvFile {
 public:
  /// Throws std::runtime_error naming the file if it cannot be made.
  CsvFile(const std::string& path, const std::string& header);

  CsvFile& operator<<(double value);
  CsvFile& operator<<(int value);
  CsvFile& operator<<(std::uint32_t value);
  CsvFile& operator<<(const std::string& value);
  CsvFile& operator<<(const Vector3& value);
  /// Throws std::runtime_error if the disk does not take it.
  void end_row();
  void flush();

 private:
  void comma();
  void check();

  std::string path_;
  std::ofstream file_;
  bool row_begun_ = false;
};

/// The tables that replay writes, a frame at a time: objects.csv, contacts.csv, hands.csv, events.csv and, of
/// a scene with joints, joints.csv.
class ResultWriter {
 public:
  /// Makes the folder if need be. Throws std::runtime_error naming what cannot be written.
  ResultWriter(const std::string& folder, const Scene& scene);

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
  CsvFile objects_, contacts_, hands_, events_;
  std::optional<CsvFile> joints_;  // of a scene that has any
};

}  // namespace mrhi
