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

/// Cells in quotes are text. With a separator other than the comma, a comma is the decimal point.
std::vector<std::string> split(std::string line, char separator) {
  while (!line.empty() && (line.back() == '\r' || line.back() == '\n')) line.pop_back();
  std::vector<std::string> cells(1);
  bool is_quoted = false;
  for (const char c : line) {
    if (c == separator && !is_quoted) {
      cells.emplace_back();
      continue;
    }
    const std::size_t first = cells.back().find_first_not_of(" \t");
    if (c == '"' && (first == std::string::npos || cells.back()[first] == '"')) is_quoted = !is_quoted;
    cells.back() += c == ',' && separator != ',' ? '.' : c;
  }
  for (std::string& cell : cells) cell = plain(cell);
  return cells;
}

char separator_of(const std::string& header) {
  for (const char separator : {',', ';', '\t'})
    if (header.find(separator) != std::string::npos) return separator;
  return ',';
}

constexpr double kMaxDuration = 1e9;  // of a recording [s]

/// The times of a table: from its own start, or Unix time in a unit that its first time shows.
class TableTime {
 public:
  TableTime() = default;
  explicit TableTime(double first) {
    if (!(first > kMaxDuration && first < 1e20)) return;
    first_ = first;
    while (unit_ + 1 < std::size(kUnits) && first * kUnits[unit_].seconds > kMaxUnixTime) ++unit_;
  }

  bool is_unix() const { return first_ != 0.0; }
  const char* unit() const { return kUnits[unit_].name; }
  double seconds(double time) const { return (time - first_) * kUnits[unit_].seconds; }

 private:
  struct Unit {
    const char* name;
    double seconds;
  };
  static constexpr Unit kUnits[] = {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};

  static constexpr double kMaxUnixTime = 1e11;  // Unix time [s]: a larger one is of a smaller unit

  double first_ = 0.0;
  std::size_t unit_ = 0;
};

using FrameKey = std::pair<Nanoseconds, double>;  // stamp, and frame_id

FrameKey read_key(const CsvColumns& row, const TableTime& times) {
  const double time = times.seconds(row.required("time_s"));
  if (!(time >= 0.0 && time <= kMaxDuration))
    row.fail("time_s", std::string("a time of 0 to 1e9 s is needed") +
                           (times.is_unix() ? ", counted from the first" : ""));
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
  const double is_left = row.truth("is_left");
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

/// Reads the next row, or returns false. numpy writes its header as a comment.
bool next_row(FileLines& lines, std::string& line, bool is_header) {
  while (lines.next(line)) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos) continue;
    if (line[first] != '#') return true;
    line.erase(0, first + 1);
    if (is_header && line.find("time_s") != std::string::npos) return true;
  }
  return false;
}

}  // namespace

CsvColumns::CsvColumns(std::string file, const std::string& header, std::size_t line_number)
    : file_(std::move(file)),
      separator_(separator_of(header)),
      names_(split(header, separator_)),
      header_line_(line_number),
      line_number_(line_number) {
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (!names_[i].empty() && std::find(names_.begin(), names_.begin() + i, names_[i]) != names_.begin() + i)
      throw RecordingError(file_ + ":" + std::to_string(header_line_) + ": column " +
                           text::quoted(names_[i], 40) + " is given twice; allowed: once");
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
    if (std::isnan(*value)) return std::nullopt;  // numpy's
    return value;
  }
  return std::nullopt;
}

double CsvColumns::required(const std::string& column) const {
  if (std::find(names_.begin(), names_.end(), column) == names_.end())
    throw RecordingError(file_ + ":" + std::to_string(header_line_) + ": has no column '" + column +
                         "'; allowed: a header with time_s, hand_id, is_left and joints; it begins with '" +
                         text::one_line(names_.front(), 40) + "'");
  const auto value = number(column);
  if (!value) fail(column, "a number is needed");
  return *value;
}

double CsvColumns::truth(const std::string& column) const {
  const auto name = std::find(names_.begin(), names_.end(), column);
  const std::string cell = name == names_.end() ? "" : text::in_lower_case(cells_[name - names_.begin()]);
  return cell == "true" ? 1.0 : cell == "false" ? 0.0 : required(column);
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

std::vector<JointsFrame> read_recording_csv(const std::string& file, std::vector<std::string>* warnings) try {
  const auto warn = [warnings](const std::string& warning) {
    if (warnings != nullptr) warnings->push_back(warning);
  };
  FileLines lines(file);
  std::string line;
  if (!next_row(lines, line, true)) throw RecordingError(file + ": is empty; allowed: a header and frames");
  if (line.compare(0, 2, "\x1F\x8B") == 0)
    throw RecordingError(file + ": is compressed by gzip; allowed: the table that 'gunzip' makes of it");
  require_no_utf16(file, line);
  CsvColumns row(file, line, lines.number());
  std::vector<JointsFrame> frames;
  TableTime times;
  FrameKey key;
  while (next_row(lines, line, false)) {
    try {
      row.take(line, lines.number());
      if (frames.empty()) times = TableTime(row.required("time_s"));
      const FrameKey next = read_key(row, times);
      const auto id = read_id(row);
      const auto hand = id ? std::make_optional(read_hand(row, *id)) : std::nullopt;
      if (frames.empty() || next != key) frames.push_back({next.first, {}});
      key = next;
      if (hand) frames.back().hands.push_back(*hand);
    } catch (const RecordingError& error) {
      if (!lines.is_unfinished() || frames.empty()) throw;
      warn(std::string(error.what()) + "; this last line has no end, and is left out");
    }
  }
  if (times.is_unix())
    warn(file + ": time_s is taken as Unix time in " + times.unit() + ", and counted from the first frame");
  if (frames.empty()) throw RecordingError(file + ": has a header and no frames");
  return frames;
} catch (const FileError& error) {
  throw RecordingError(error.what());
}

CsvInput::CsvInput(const std::string& file, const Pose& device_in_world, double scale)
    : frames_(read_recording_csv(file, &warnings_)), device_in_world_(device_in_world), input_(scale) {
  size_ = frames_.size();
}

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
