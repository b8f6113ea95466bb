#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// A file that cannot be read or written. what() is one line that names it.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Whether it is there and regular.
bool is_file(const std::filesystem::path& path);

/// What keeps a file from being read; empty: nothing. What is no regular file is never opened: a pipe waits
/// for who writes to it, a device may have no end.
std::string why_unreadable(const std::string& file);

/// The first `most` bytes of a regular file, or nothing if it cannot be read.
std::optional<std::string> file_text(const std::string& file, std::size_t most);

/// The lines of a regular file, without a byte order mark.
class FileLines {
 public:
  /// Throws FileError.
  explicit FileLines(const std::string& file);
  /// The next one, without its end; false where there is none. Throws FileError for one that is longer than
  /// any table's.
  bool next(std::string& line);
  std::size_t number() const { return number_; }  ///< of the last one, from 1

 private:
  std::string file_;
  std::ifstream stream_;
  std::vector<char> room_;
  std::size_t number_ = 0;
};

/// Throws FileError for what is there and cannot be written to without waiting for another program: pipes and
/// sockets.
void check_may_be_written(const std::string& file);

/// After check_may_be_written(). Whether it could be opened is the stream's to say.
std::ofstream file_to_write(const std::string& file,
                            std::ios::openmode mode = std::ios::out | std::ios::binary);

/// The file that `name` means: a path to a file with this extension (".urdf"), or a name looked up as
/// DIRECTORY/NAME.urdf. Throws InputError that says what `kind` of file it is ("scene") and lists the names
/// known.
std::string find_named_file(const std::string& kind, const std::string& name, const std::string& extension,
                            const std::vector<std::string>& directories);

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
  CsvRows& operator<<(const Quaternion& q) { return *this << q.x() << q.y() << q.z() << q.w(); }
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
  /// A whole row, likewise.
  template <class... Values>
  void row(const Values&... values) {
    (rows_ << ... << values);
    end_row();
  }
  void flush();

 private:
  void check();

  std::string path_;
  std::ofstream file_;
  CsvRows rows_;
};

}  // namespace mrhi
