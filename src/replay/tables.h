#pragma once

#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../text/files.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi::json {

/// Twelve digits; what is no number is null.
inline std::string number(double value) {
  if (!std::isfinite(value)) return "null";
  char text[32];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

inline std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    char escaped[8];
    if (c == '"' || c == '\\') {
      result += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20) {
      std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned char>(c));
      result += escaped;
    } else {
      result += c;
    }
  }
  return result + '"';
}

/// [a, b]; items are JSON.
inline std::string list(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : ", ") + item;
  return "[" + text + "]";
}

/// {"name": value}; values are JSON.
inline std::string object(const std::vector<std::pair<std::string, std::string>>& members) {
  std::string text;
  for (const auto& [name, value] : members) text += (text.empty() ? "" : ", ") + quoted(name) + ": " + value;
  return "{" + text + "}";
}

}  // namespace mrhi::json

namespace mrhi {
/// What a column of a table holds.
struct Column {
  std::string name, unit, meaning;
};

/// A table that replay writes.
struct Table {
  std::string file, rows;  ///< name, and what has a row
  std::vector<Column> columns;

  /// Names with commas between.
  std::string header() const;
};

/// All tables, in the order of schema.json.
const std::vector<Table>& tables();
/// Throws std::out_of_range for a name that is none of these.
const Table& table_of(const std::string& file);

/// schema.json: the tables' columns with unit and meaning.
std::string schema_json();

/// Name of an event as in InteractionEvent.msg, e.g. GRASP_BEGIN.
const char* event_name(EventKind kind);

/// The tables that replay writes, a frame at a time; dictionary.h has their columns. joints.csv is written
/// only if the scene has joints.
class ResultWriter {
 public:
  /// Makes the folder if need be. Throws std::runtime_error naming what cannot be written.
  ResultWriter(const std::string& folder, const Scene& scene);

  /// `gravity`: that acts in the frame [m/s^2].
  void write(const FrameResult& result, const SimulationState& state, const Vector3& gravity);
  /// Sets the scene of the frames to come.
  void follow(const Scene& scene);
  void flush();

 private:
  /// Made when it is first asked for.
  CsvFile& table(const std::string& file);
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
  std::map<std::string, std::unique_ptr<CsvFile>> tables_;  ///< by the file's name
};

}  // namespace mrhi
