#pragma once

#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace mrhi {

/// A file that cannot be read or written. what() is one line that names it.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

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
/// DIRECTORY/NAME.urdf. Throws SceneError that says what `kind` of file it is ("scene") and lists the names
/// known.
std::string find_named_file(const std::string& kind, const std::string& name, const std::string& extension,
                            const std::vector<std::string>& directories);

}  // namespace mrhi
