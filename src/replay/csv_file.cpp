#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "mr_hand_interaction/replay/result_writer.h"

namespace mrhi {

CsvFile::CsvFile(const std::string& path, const std::string& header) : path_(path), file_(path) {
  file_ << header << '\n';
  check();
}

CsvFile& CsvFile::operator<<(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.12g", value);
  comma();
  file_ << text;
  return *this;
}

CsvFile& CsvFile::operator<<(int value) {
  return *this << std::to_string(value);
}

CsvFile& CsvFile::operator<<(std::uint32_t value) {
  return *this << std::to_string(value);
}

CsvFile& CsvFile::operator<<(const std::string& value) {
  comma();
  file_ << value;
  return *this;
}

CsvFile& CsvFile::operator<<(const Vector3& value) {
  return *this << value.x() << value.y() << value.z();
}

void CsvFile::end_row() {
  file_ << '\n';
  row_begun_ = false;
  check();
}

void CsvFile::flush() {
  file_.flush();
  check();
}

void CsvFile::comma() {
  if (row_begun_) file_ << ',';
  row_begun_ = true;
}

void CsvFile::check() {
  if (!file_) throw std::runtime_error("cannot write " + path_ + ": " + std::strerror(errno));
}

}  // namespace mrhi
