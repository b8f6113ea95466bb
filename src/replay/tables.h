#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "../text/files.h"
#include "../text/text.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// A value as JSON. Numbers have twelve digits; numbers that are not finite are null.
struct Json {
  std::string text;

  Json(const std::string& value) : text("\"") {
    for (const char c : value) {
      const auto code = static_cast<unsigned char>(c);
      if (c == '"' || c == '\\') text += '\\';
      text += code < 0x20 ? text::format("\\u%04x", code) : std::string(1, c);
    }
    text += '"';
  }
  Json(const char* value) : Json(std::string(value)) {}
  template <class Number, std::enable_if_t<std::is_arithmetic<Number>::value, int> = 0>
  Json(Number value) {
    const std::string digits = text::format("%.12g", static_cast<double>(value));
    text = std::is_integral<Number>::value ? std::to_string(value) : std::isfinite(value) ? digits : "null";
  }
  Json(const Vector3& v) : Json(std::vector<double>{v.x(), v.y(), v.z()}) {}
  template <class Value>
  Json(const std::optional<Value>& value) : text(value ? Json(*value).text : "null") {}
  template <class Value>
  Json(const std::vector<Value>& values) {
    for (const Value& value : values) text += (text.empty() ? "" : ", ") + Json(value).text;
    text = "[" + text + "]";
  }
  template <class Value>
  Json(const std::map<std::string, Value>& members)
      : Json(std::vector<std::pair<std::string, Json>>(members.begin(), members.end())) {}
  /// An object with its members in order, separated by a comma and `between`.
  Json(const std::vector<std::pair<std::string, Json>>& members, const std::string& between = " ") {
    for (const auto& [name, value] : members)
      text += (text.empty() ? "" : "," + between) + Json(name).text + ": " + value.text;
    text = "{" + text + "}";
  }
};

/// A column of a table.
struct Column {
  std::string name, unit, meaning;
};

/// A table that replay writes.
struct Table {
  std::string file, rows;  ///< name, and the meaning of a row
  std::vector<Column> columns;

  /// Names of the columns, separated by commas.
  std::string header() const;
};

/// All tables, in the order of schema.json.
const std::vector<Table>& tables();
/// The table of that file. Throws std::out_of_range for an unknown name.
const Table& table_of(const std::string& file);

/// schema.json: the tables' columns with unit and meaning.
std::string schema_json();

/// Name of an event as in InteractionEvent.msg, e.g. GRASP_BEGIN.
const char* event_name(EventKind kind);

/// Writes the tables of tables.txt, a frame at a time; joints.csv only if the scene has joints.
class ResultWriter {
 public:
  /// Creates the folder if it is missing. Throws std::runtime_error that names a file that cannot be written.
  ResultWriter(const std::string& folder, const Scene& scene);

  /// `gravity`: acts in the frame [m/s^2].
  void write(const FrameResult& result, const SimulationState& state, const Vector3& gravity);
  /// `now`: the frame in which they happen, or after which.
  void write_events(const std::vector<Event>& events, const FrameResult& now);
  /// Sets the scene of the following frames.
  void follow(const Scene& scene);
  void flush();

 private:
  /// Created on first use.
  CsvFile& table(const std::string& file);
  void write_bodies(double time);
  void write_objects(double time, const FrameResult& result, const SimulationState& state);
  void write_joints(double time, const SimulationState& state);
  void write_contacts(double time, const FrameResult& result, const SimulationState& state);
  void write_palm(double time, const Hand& hand, const SimulationState& state);
  void write_hand(double time, const Hand& hand, const RenderedHand* rendered);

  std::string folder_;
  const Scene* scene_;
  bool scene_is_new_ = true;  ///< bodies.csv does not have it yet
  std::size_t frame_ = 0;     ///< number of the current frame
  bool begun_ = false;
  Nanoseconds first_stamp_ = 0;
  std::map<std::string, std::unique_ptr<CsvFile>> tables_;  ///< by the file's name
};

}  // namespace mrhi
