#pragma once

#include <fstream>
#include <optional>
#include <ostream>
#include <string>
#include <type_traits>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// A text as a cell of CSV (RFC 4180): in quotes where it has a comma, a quote or a line break; after an
/// apostrophe where a spreadsheet would take it for a formula.
std::string csv_cell(const std::string& text);

/// A table in CSV, cell by cell and row by row; numbers with the stream's digits.
class CsvRows {
 public:
  explicit CsvRows(std::ostream& out) : out_(out) {}  ///< keeps a reference

  template <class Number, std::enable_if_t<std::is_arithmetic<Number>::value, int> = 0>
  CsvRows& operator<<(Number value) {
    next() << value;
    return *this;
  }
  CsvRows& operator<<(const std::string& text);
  CsvRows& operator<<(const char* text) { return *this << std::string(text); }
  CsvRows& operator<<(const Vector3& value) { return *this << value.x() << value.y() << value.z(); }
  /// As many empty cells as it would be, if it is not there.
  template <class Value>
  CsvRows& operator<<(const std::optional<Value>& value) {
    if (value) return *this << *value;
    return skip(std::is_same<Value, Vector3>::value ? 3 : 1);
  }
  CsvRows& skip(std::size_t cells);  ///< empty ones
  void end_row();

 private:
  /// Where the next cell goes.
  std::ostream& next();

  std::ostream& out_;
  bool begun_ = false;
};

/// The same on a file, numbers with 12 digits. What was written stays whatever comes after.
class CsvFile {
 public:
  /// Throws std::runtime_error naming the file if it cannot be made.
  CsvFile(const std::string& path, const std::string& header);

  template <class Value>
  CsvFile& operator<<(const Value& value) {
    rows_ << value;
    return *this;
  }
  void skip(std::size_t cells) { rows_.skip(cells); }
  /// Throws std::runtime_error if the disk does not take it.
  void end_row();
  void flush();

 private:
  void check();

  std::string path_;
  std::ofstream file_;
  CsvRows rows_;
};

}  // namespace mrhi
