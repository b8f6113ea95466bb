#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Error of an unreadable recording. what() is one line: file, line number, column, what is allowed.
class RecordingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Columns of a CSV file by name. Throws RecordingError.
class CsvColumns {
 public:
  CsvColumns(std::string file, const std::string& header, std::size_t line_number = 1);

  /// Selects the line to read from.
  void take(const std::string& line, std::size_t line_number);

  /// The cell's number; empty if the cell is empty or the column does not exist.
  std::optional<double> number(const std::string& column) const;
  double required(const std::string& column) const;
  /// The cell's number, or 1 for true and 0 for false in any case.
  double truth(const std::string& column) const;
  /// Columns PREFIX_x, PREFIX_y, PREFIX_z: all three or none.
  std::optional<Vector3> point(const std::string& prefix) const;

  [[noreturn]] void fail(const std::string& column, const std::string& what) const;

 private:
  std::string file_;
  char separator_;
  std::vector<std::string> names_, cells_;
  std::size_t header_line_, line_number_;
};

/// Reads a recording in the CSV schema: one line per hand and device frame; hand_id -1 for a frame without
/// hands; columns by name; empty cells for missing values; blank lines and lines that begin with # for
/// readers. Unix time, in s, ms, us or ns, becomes the time since the first frame. Drops a last line that is
/// cut off. Adds what it assumes to `warnings`. Throws RecordingError.
std::vector<JointsFrame> read_recording_csv(const std::string& file,
                                            std::vector<std::string>* warnings = nullptr);

}  // namespace mrhi
