#include "files.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <locale>

#include "mr_hand_interaction/input_error.h"
#include "text.h"

namespace mrhi {
namespace {

constexpr std::size_t kMaxLineBytes = 64 * 1024;

namespace fs = std::filesystem;

std::vector<std::string> known_names(const std::string& extension,
                                     const std::vector<std::string>& directories) {
  std::vector<std::string> names;
  for (const std::string& directory : directories) {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory, ignored)) {
      if (entry.path().extension() == extension && is_file(entry.path()))
        names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

}  // namespace

std::string why_unreadable(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return "there is no such file";
  if (!std::filesystem::is_regular_file(file, error)) return "is no file";
  if (!std::ifstream(file, std::ios::binary)) return "cannot be read";
  return "";
}

std::optional<std::string> file_text(const std::string& file, std::size_t max_bytes) {
  if (!why_unreadable(file).empty()) return {};
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  if (!stream || error) return {};
  std::string text(static_cast<std::size_t>(std::min<std::uintmax_t>(size, max_bytes)), '\0');
  stream.read(&text[0], static_cast<std::streamsize>(text.size()));
  if (stream.bad()) return {};
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

FileLines::FileLines(const std::string& file) : file_(text::one_line(file)), buffer_(kMaxLineBytes + 1) {
  const std::string why = why_unreadable(file);
  if (!why.empty()) throw FileError(file_ + ": " + why + "; allowed: a file that may be read");
  stream_.open(file, std::ios::binary);
}

bool FileLines::next(std::string& line) {
  ++number_;
  stream_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  const auto taken = static_cast<std::size_t>(stream_.gcount());
  if (stream_.fail() && taken + 1 >= buffer_.size())
    throw FileError(file_ + ":" + std::to_string(number_) + ": is longer than " +
                    std::to_string(kMaxLineBytes) + " bytes; allowed: at most that");
  if (stream_.fail()) return false;
  line.assign(buffer_.data(), stream_.eof() ? taken : taken - 1);
  constexpr const char* kByteOrderMark = "\xEF\xBB\xBF";  // spreadsheets write it
  if (number_ == 1 && line.compare(0, 3, kByteOrderMark) == 0) line.erase(0, 3);
  return true;
}

void check_may_be_written(const std::string& file) {
  std::error_code error;
  const std::filesystem::file_status there = std::filesystem::status(file, error);
  if (std::filesystem::is_fifo(there) || std::filesystem::is_socket(there) ||
      std::filesystem::is_block_file(there))
    throw FileError("cannot write " + text::one_line(file) + ": it is no file; allowed: a file, or none yet");
}

std::ofstream file_to_write(const std::string& file, std::ios::openmode mode) {
  check_may_be_written(file);
  return std::ofstream(file, mode | std::ios::out);
}

void write_file(const std::string& file, const std::string& text) {
  std::ofstream out = file_to_write(file);
  out << text << std::flush;
  if (!out) throw std::runtime_error("cannot write " + file + ": " + std::strerror(errno));
}

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

std::string find_named_file(const std::string& kind, const std::string& name, const std::string& extension,
                            const std::vector<std::string>& directories) {
  const bool is_path = name.find('/') != std::string::npos || fs::path(name).extension() == extension;
  if (is_path && is_file(name)) return name;
  for (const std::string& directory : directories) {
    const fs::path file = fs::path(directory) / (name + extension);
    if (!is_path && is_file(file)) return file.string();
  }
  if (is_file(name)) return name;  // with another extension, or none
  throw InputError(
      (is_path ? kind + " file '" + name + "' does not exist" : "unknown " + kind + " '" + name + "'") +
      "; allowed: " + (extension == ".urdf" ? "a URDF" : "a YAML") + " file, or one of " +
      text::joined(known_names(extension, directories)));
}

std::string csv_cell(const std::string& text) {
  const bool formula = text.find_first_of("=+-@\t\r") == 0 && !text::to_number(text);
  const std::string cell = formula ? '\'' + text : text;
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

CsvRows& CsvRows::operator<<(const std::string& text) {
  next() << csv_cell(text);
  return *this;
}

CsvRows& CsvRows::skip(std::size_t cells) {
  for (std::size_t i = 0; i < cells; ++i) next();
  return *this;
}

void CsvRows::end_row() {
  out_ << '\n';
  begun_ = false;
}

std::ostream& CsvRows::next() {
  if (begun_) out_ << ',';
  begun_ = true;
  return out_;
}

CsvFile::CsvFile(const std::string& path, const std::string& header)
    : path_(path), file_(file_to_write(path)), rows_(file_) {
  file_.imbue(std::locale::classic());
  file_.precision(12);
  file_ << header << '\n';
  check();
}

void CsvFile::end_row() {
  rows_.end_row();
  check();
}

void CsvFile::flush() {
  file_.flush();
  check();
}

void CsvFile::check() {
  if (!file_) throw std::runtime_error("cannot write " + path_ + ": " + std::strerror(errno));
}

}  // namespace mrhi
