#include "csv_columns.h"

#include <utility>

#include "../text/text.h"
#include "mr_hand_interaction/replay/recording_csv.h"

namespace mrhi {
namespace {

std::vector<std::string> split(std::string line) {
  while (!line.empty() && (line.back() == '\r' || line.back() == '\n')) line.pop_back();
  return text::split(line);
}

}  // namespace

CsvColumns::CsvColumns(std::string file, const std::string& header)
    : file_(std::move(file)), names_(split(header)) {}

void CsvColumns::take(const std::string& line, std::size_t line_number) {
  line_number_ = line_number;
  cells_ = split(line);
  if (cells_.size() != names_.size())
    throw RecordingError(file_ + ":" + std::to_string(line_number_) + ": has " +
                         std::to_string(cells_.size()) + " cells; the header names " +
                         std::to_string(names_.size()) + " columns");
}

std::optional<double> CsvColumns::number(const std::string& column) const {
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (names_[i] != column) continue;
    if (cells_[i].empty()) return std::nullopt;
    const auto value = text::to_number(cells_[i]);
    if (!value) fail(column, "'" + cells_[i] + "' is not a number");
    return value;
  }
  return std::nullopt;
}

double CsvColumns::required(const std::string& column) const {
  const auto value = number(column);
  if (!value) fail(column, "a number is needed");
  return *value;
}

std::optional<Vector3> CsvColumns::point(const std::string& prefix) const {
  const auto x = number(prefix + "_x"), y = number(prefix + "_y"), z = number(prefix + "_z");
  if (!x && !y && !z) return std::nullopt;
  if (!x || !y || !z) fail(prefix, "x, y and z are needed, or none of them");
  return Vector3(*x, *y, *z);
}

void CsvColumns::fail(const std::string& column, const std::string& what) const {
  throw RecordingError(file_ + ":" + std::to_string(line_number_) + ": " + column + ": " + what);
}

}  // namespace mrhi
