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

/// Error of a file that cannot be read or written. what() is one line with its name.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// True if the path is a regular file.
bool is_file(const std::filesystem::path& path);

/// Reason why a file cannot be read; empty: it can. Only regular files are opened: a pipe would wait for a
/// writer, a device may have no end.
std::string why_unreadable(const std::string& file);

/// First `max_bytes` bytes of a regular file; empty if it cannot be read.
std::optional<std::string> file_text(const std::string& file, std::size_t max_bytes);

/// The lines of a regular file, without a byte order mark.
class FileLines {
 public:
  /// Throws FileError.
  explicit FileLines(const std::string& file);
  /// Reads the next line, without its end; false if there is none. Throws FileError for a line that is too
  /// long for a table.
  bool next(std::string& line);
  std::size_t number() const { return number_; }        ///< of the last one, from 1
  bool is_unfinished() const { return stream_.eof(); }  ///< it is the last one, and has no end

 private:
  std::string file_;
  std::ifstream stream_;
  std::vector<char> buffer_;
  std::size_t number_ = 0;
};

/// Throws FileError for an existing pipe or socket, as writing to it would wait for another program.
void check_may_be_written(const std::string& file);

/// Opens a file after check_may_be_written(). Check the stream for success.
std::ofstream file_to_write(const std::string& file,
                            std::ios::openmode mode = std::ios::out | std::ios::binary);

/// Writes a whole file, likewise. Throws std::runtime_error that names it.
void write_file(const std::string& file, const std::string& text);

/// Finds a file: `name` is a path to a file with this extension (".urdf"), or a name looked up as
/// DIRECTORY/NAME.urdf, else a path to any file. Throws InputError with the `kind` of file ("scene") and the
/// known names.
std::string find_named_file(const std::string& kind, const std::string& name, const std::string& extension,
                            const std::vector<std::string>& directories);

/// A text as a CSV cell (RFC 4180): quoted if it contains a comma, a quote or a line break; after an
/// apostrophe if a spreadsheet would read it as a formula.
std::string csv_cell(const std::string& text);

/// Writes a CSV table by cells and rows; numbers with the stream's digits.
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
  /// Empty cells, as many as the value would have, if it is absent.
  template <class Value>
  CsvRows& operator<<(const std::optional<Value>& value) {
    if (value) return *this << *value;
    return skip(std::is_same<Value, Vector3>::value ? 3 : 1);
  }
  CsvRows& skip(std::size_t cells);  ///< empty cells
  void end_row();

 private:
  /// Stream for the next cell.
  std::ostream& next();

  std::ostream& out_;
  bool begun_ = false;
};

/// The same to a file, numbers with 12 digits. Written rows persist after later errors.
class CsvFile {
 public:
  /// Throws std::runtime_error with the file if it cannot be created.
  CsvFile(const std::string& path, const std::string& header);

  template <class Value>
  CsvFile& operator<<(const Value& value) {
    rows_ << value;
    return *this;
  }
  void skip(std::size_t cells) { rows_.skip(cells); }
  /// Throws std::runtime_error if writing fails.
  void end_row();
  /// Writes a whole row, likewise.
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
