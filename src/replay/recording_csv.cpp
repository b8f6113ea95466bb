#include "mr_hand_interaction/replay/recording_csv.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "../text/files.h"
#include "../text/text.h"
#include "inputs.h"

namespace mrhi {
namespace {

/// A cell without blanks around it, and without the quotes that R's write.csv puts around names and texts.
std::string plain(std::string cell) {
  cell.erase(cell.find_last_not_of(" \t") + 1);
  cell.erase(0, cell.find_first_not_of(" \t"));
  if (cell.size() > 1 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
  return cell;
}

/// If cells are separated by semicolons or tabs, as in some locales' spreadsheets, a comma is the decimal
/// point.
std::vector<std::string> split(std::string line, char separator) {
  while (!line.empty() && (line.back() == '\r' || line.back() == '\n')) line.pop_back();
  if (separator != ',') {
    std::replace(line.begin(), line.end(), ',', '.');
    std::replace(line.begin(), line.end(), separator, ',');
  }
  std::vector<std::string> cells = text::split(line);
  for (std::string& cell : cells) cell = plain(cell);
  return cells;
}

char separator_of(const std::string& header) {
  for (const char separator : {',', ';', '\t'})
    if (header.find(separator) != std::string::npos) return separator;
  return ',';
}

constexpr double kLongestRecording = 1e9;  // [s]

using FrameKey = std::pair<Nanoseconds, double>;  // stamp, and frame_id

FrameKey read_key(const CsvColumns& row) {
  const double time = row.required("time_s");
  if (!(time >= 0.0 && time <= kLongestRecording)) row.fail("time_s", "a time of 0 to 1e9 s is needed");
  return {std::llround(time * 1e9), row.number("frame_id").value_or(0.0)};
}

float number_or(const CsvColumns& row, const std::string& column, double absent) {
  return static_cast<float>(row.number(column).value_or(absent));
}

std::optional<float> width(const CsvColumns& row, const std::string& column) {
  const auto value = row.number(column);
  return value && *value != 0.0 ? std::make_optional(static_cast<float>(*value)) : std::nullopt;
}

Side read_side(const CsvColumns& row) {
  const double is_left = row.required("is_left");
  if (is_left != 0.0 && is_left != 1.0) row.fail("is_left", "0 or 1 is needed");
  return is_left == 1.0 ? Side::left : Side::right;
}

/// Empty for -1: the frame has no hand.
std::optional<std::uint32_t> read_id(const CsvColumns& row) {
  const double id = row.required("hand_id");
  if (id == -1.0) return std::nullopt;
  if (!(id >= 0.0 && id <= 4294967295.0 && id == std::floor(id)))
    row.fail("hand_id", "a whole number is needed, or -1 for a frame with no hand");
  return static_cast<std::uint32_t>(id);
}

HandJoints read_hand(const CsvColumns& row, std::uint32_t id) {
  static const char* const fingers[kFingers] = {"thumb", "index", "middle", "ring", "pinky"};
  HandJoints hand;
  hand.id = id;
  hand.side = read_side(row);
  hand.confidence = number_or(row, "confidence", 1.0);
  hand.grab_strength = number_or(row, "grab_strength", 0.0);
  hand.pinch_strength = number_or(row, "pinch_strength", 0.0);
  hand.palm_centre = row.point("palm");
  hand.palm_width = width(row, "palm_width");
  hand.wrist = row.point("wrist");
  for (std::size_t f = 0; f < kFingers; ++f) {
    const std::string name = fingers[f];
    hand.finger_width[f] = width(row, name + "_width");
    for (std::size_t j = 0; j < hand.joints[f].size(); ++j)
      hand.joints[f][j] = row.point(name + "_j" + std::to_string(j));
  }
  return hand;
}

/// Throws if the first line of a file is in UTF-16, as spreadsheets save "Unicode text".
void require_no_utf16(const std::string& file, const std::string& line) {
  const auto zero_at = [&line](std::size_t place) { return place < line.size() && line[place] == '\0'; };
  const bool little = line.compare(0, 2, "\xFF\xFE") == 0 || (zero_at(1) && zero_at(3));
  const bool big = line.compare(0, 2, "\xFE\xFF") == 0 || (zero_at(0) && zero_at(2));
  if (little || big)
    throw RecordingError(file + ": is in UTF-16; allowed: UTF-8, such as 'iconv -f UTF-16" +
                         (little ? "LE" : "BE") + " -t UTF-8' makes of it");
}

}  // namespace

CsvColumns::CsvColumns(std::string file, const std::string& header)
    : file_(std::move(file)), separator_(separator_of(header)), names_(split(header, separator_)) {
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (!names_[i].empty() && std::find(names_.begin(), names_.begin() + i, names_[i]) != names_.begin() + i)
      throw RecordingError(file_ + ":1: column " + text::quoted(names_[i], 40) +
                           " is given twice; allowed: once");
}

void CsvColumns::take(const std::string& line, std::size_t line_number) {
  line_number_ = line_number;
  cells_ = split(line, separator_);
  if (cells_.size() != names_.size())
    throw RecordingError(file_ + ":" + std::to_string(line_number_) + ": has " +
                         std::to_string(cells_.size()) + " cells; the header names " +
                         std::to_string(names_.size()) + " columns");
}

std::optional<double> CsvColumns::number(const std::string& column) const {
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (names_[i] != column) continue;
    if (cells_[i].empty() || cells_[i] == "NA") return std::nullopt;  // R's word for a missing value
    const auto value = text::to_number(cells_[i]);
    if (!value) fail(column, text::quoted(cells_[i], 40) + " is not a number");
    return value;
  }
  return std::nullopt;
}

double CsvColumns::required(const std::string& column) const {
  if (std::find(names_.begin(), names_.end(), column) == names_.end())
    throw RecordingError(file_ + ":1: has no column '" + column +
                         "'; allowed: a header with time_s, hand_id, is_left and joints; it begins with '" +
                         text::one_line(names_.front(), 40) + "'");
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

std::vector<JointsFrame> read_recording_csv(const std::string& file) try {
  FileLines lines(file);
  std::string line;
  if (!lines.next(line)) throw RecordingError(file + ": is empty; allowed: a header and frames");
  if (line.compare(0, 2, "\x1F\x8B") == 0)
    throw RecordingError(file + ": is compressed by gzip; allowed: the table that 'gunzip' makes of it");
  require_no_utf16(file, line);
  CsvColumns row(file, line);
  std::vector<JointsFrame> frames;
  FrameKey key;
  while (lines.next(line)) {
    if (line.empty() || line == "\r") continue;
    row.take(line, lines.number());
    const FrameKey next = read_key(row);
    if (frames.empty() || next != key) frames.push_back({next.first, {}});
    key = next;
    if (const auto id = read_id(row)) frames.back().hands.push_back(read_hand(row, *id));
  }
  if (frames.empty()) throw RecordingError(file + ": has a header and no frames");
  return frames;
} catch (const FileError& error) {
  throw RecordingError(error.what());
}

CsvInput::CsvInput(const std::string& file, const Pose& device_in_world, double scale)
    : frames_(read_recording_csv(file)), device_in_world_(device_in_world), input_(scale) {}

std::optional<SourceFrame> CsvInput::next() {
  if (position_ == frames_.size()) return std::nullopt;
  TrackerFrame frame{"", frames_[position_++], {}, {}, false};
  const Nanoseconds stamp = frame.joints.stamp;
  SourceFrame result = input_.take(std::move(frame), [this](Nanoseconds) { return device_in_world_; });
  // A recording has no receiver's clock. The next frame takes its place: it confirms a gap, and not a stray.
  if (position_ < frames_.size()) result.arrival = std::min(stamp, frames_[position_].stamp);
  return result;
}

}  // namespace mrhi
