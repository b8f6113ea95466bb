#include "mr_hand_interaction/training/session_folder.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <locale>
#include <sstream>

#include "../text/csv.h"
#include "../text/text.h"
#include "folder_lock.h"
#include "session_header.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

const char* const kTrialColumns =
    "trial,object,condition,repetition,result,start,completion_time,manipulation_time,maintenance_time,"
    "release_time,attempts,drops,path_length,grip_force_mean,grip_force_max,release_drift,release_speed,"
    "tracking_losses,grasps,manipulation_drops";
const char* const kEventColumns = "time,trial,stage,event,object,detail,stamp,utc";
const char* const kHandColumns = "time,hand_id,side,finger,bone,rendered,sx,sy,sz,ex,ey,ez,radius,touching";

/// A line of a table, of numbers with six decimals.
class Line {
 public:
  Line() {
    stream_.imbue(std::locale::classic());
    stream_.setf(std::ios::fixed);
  }
  template <class Value>
  Line& operator<<(const Value& value) {
    row_ << value;
    return *this;
  }
  std::string text() {
    row_.end_row();
    return stream_.str();
  }

 private:
  std::ostringstream stream_;
  CsvRows row_{stream_};
};

std::string read_all(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// In seconds, with all nine decimals: a double has too few digits for those since 1970.
std::string stamp_text(Nanoseconds stamp) {
  constexpr Nanoseconds kSecond = 1'000'000'000;
  std::string decimals = std::to_string(stamp % kSecond);
  decimals.insert(0, 9 - decimals.size(), '0');
  return std::to_string(stamp / kSecond) + '.' + decimals;
}

void write_now(std::ofstream& out, const std::string& text, const std::string& file) {
  out << text << std::flush;
  if (!out) throw SessionError(file + ": cannot be written; allowed: a folder to write to with space left");
}

/// 0 for what is none, or more than are ever counted.
int whole_number(const std::string& field) {
  constexpr int kMost = 1'000'000'000;
  std::istringstream in(field);
  int value = 0;
  return in >> value && value > 0 && value <= kMost ? value : 0;
}

TrialResult result_named(const std::string& name) {
  for (const TrialResult result :
       {TrialResult::completed, TrialResult::skipped, TrialResult::timed_out, TrialResult::aborted}) {
    if (name == to_string(result)) return result;
  }
  return TrialResult::none;
}

}  // namespace

SessionFolder::SessionFolder(const std::string& folder, const SessionHeader& header,
                             const SessionSetup& setup)
    : path_(folder), condition_(header.condition) {
  check_header(header);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw SessionError(folder + ": cannot be made: " + error.message());
  lock_ = std::make_unique<FolderLock>(folder);
  open_header(header, setup);

  for (const auto& row : open_table("trials.csv", kTrialColumns, trials_)) {
    earlier_.push_back({whole_number(row[0]), row[1], whole_number(row[3]), result_named(row[4]), 0.0, {}});
    last_trial_ = std::max(last_trial_, earlier_.back().trial);
  }
  for (const auto& row : open_table("events.csv", kEventColumns, events_)) {
    std::istringstream time(row[0]);
    time.imbue(std::locale::classic());
    if (double seconds = 0.0; time >> seconds) last_time_ = std::max(last_time_, seconds);
    last_trial_ = std::max(last_trial_, whole_number(row[1]));
  }
}

SessionFolder::~SessionFolder() = default;

void SessionFolder::open_header(const SessionHeader& header, const SessionSetup& setup) {
  const fs::path file = fs::path(path_) / "session.yaml";
  resumed_ = fs::exists(file);
  if (resumed_) {
    check_same_session(file.string(), header);
    check_same_setup(path_, setup);
    return;
  }
  write_setup(path_, setup);
  const fs::path unfinished = fs::path(path_) / "session.yaml.part";
  std::ofstream out(unfinished, std::ios::binary);
  write_now(out, header_text(header), file.string());
  out.close();
  fs::rename(unfinished, file);
}

/// To be written on; what is in it, in whole lines. Throws if it has other columns.
std::string SessionFolder::open_file(const char* name, const char* columns, std::ofstream& out) {
  const fs::path file = fs::path(path_) / name;
  std::string text = read_all(file);
  const std::size_t whole = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
  if (whole < text.size()) {
    notes_.push_back(file.string() + ": its last line was cut off while it was written: taken away");
    fs::resize_file(file, whole);
    text.resize(whole);
  }
  out.open(file, std::ios::binary | std::ios::app);
  if (text.empty()) write_now(out, std::string(columns) + '\n', file.string());
  if (!text.empty() && text.substr(0, text.find('\n')) != columns)
    throw SessionError(file.string() + ":1: these columns are not allowed; allowed: " + columns);
  return text;
}

std::vector<std::vector<std::string>> SessionFolder::open_table(const char* name, const char* columns,
                                                                std::ofstream& out) {
  const std::string file = (fs::path(path_) / name).string();
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(open_file(name, columns, out));
  std::string line;
  std::getline(lines, line);
  const std::size_t fields = text::split(columns).size();
  for (int number = 2; std::getline(lines, line); ++number) {
    rows.push_back(text::split(line));
    if (rows.back().size() != fields)
      throw SessionError(file + ":" + std::to_string(number) + ": " + std::to_string(rows.back().size()) +
                         " fields; allowed: " + std::to_string(fields));
  }
  return rows;
}

void SessionFolder::log(const EventRow& row) {
  Line line;
  line << row.time;
  line << (row.trial > 0 ? std::make_optional(row.trial) : std::nullopt);
  line << to_string(row.stage) << row.event << row.object << row.detail;
  line << stamp_text(row.stamp) << row.utc;
  write_now(events_, line.text(), path_ + "/events.csv");
}

void SessionFolder::log(const TrialRow& row) {
  const TrialMeasures& m = row.measures;
  Line line;
  line << row.trial << row.object << condition_ << row.repetition << to_string(row.result);
  line << row.start << m.completion_time;
  for (const std::optional<double>& time : m.stage_times) line << time;
  line << m.attempts << m.drops << m.path_length << m.grip_force_mean << m.grip_force_max;
  line << m.release_drift << m.release_speed << m.tracking_losses;
  line << m.attempts << m.manipulation_drops;
  write_now(trials_, line.text(), path_ + "/trials.csv");
}

void SessionFolder::log(const HandRow& row) {
  constexpr int kIndex = 1, kDistal = 3, kTracked = 0, kUntouched = 0;
  Line line;
  line << row.time << row.hand << row.side << kIndex << kDistal << kTracked;
  line << row.start << row.end << row.radius << kUntouched;
  const char* const name = row.filtered ? "hands.csv" : "hands_raw.csv";
  std::ofstream& out = row.filtered ? hands_ : hands_raw_;
  if (!out.is_open()) open_file(name, kHandColumns, out);
  write_now(out, line.text(), path_ + '/' + name);
}

}  // namespace mrhi
