#include "csv.h"

#include <cerrno>
#include <cstring>
#include <locale>
#include <stdexcept>

#include "file_text.h"
#include "text.h"

namespace mrhi {

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
