#include "mr_hand_interaction/training/session.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <locale>
#include <sstream>
#include <utility>

#include "../text/files.h"
#include "../text/text.h"
#include "../text/yaml.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

const char *const kTrials = "trials.csv", *const kEvents = "events.csv", *const kHands = "hands.csv",
                  *const kHandsRaw = "hands_raw.csv";
const char* const kTrialColumns =
    "trial,object,condition,repetition,result,start,completion_time,manipulation_time,maintenance_time,"
    "release_time,attempts,drops,path_length,grip_force_mean,grip_force_max,release_drift,release_speed,"
    "tracking_losses,grasps,manipulation_drops,touches,arrival_speed,misplacement,misalignment,"
    "operator_speed,operator_spin";
const char* const kEventColumns = "time,trial,stage,event,object,detail,stamp,utc";
const char* const kHandColumns = "time,hand_id,side,finger,bone,rendered,sx,sy,sz,ex,ey,ez,radius,touching";

/// A line of a table; numbers have six decimals.
template <class... Values>
std::string line_of(const Values&... values) {
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.setf(std::ios::fixed);
  CsvRows row(stream);
  (row << ... << values);
  row.end_row();
  return stream.str();
}

constexpr std::size_t kMaxTableBytes = std::size_t{256} << 20;

bool is_there(const fs::path& file) {
  std::error_code ignored;
  return fs::exists(file, ignored);
}

/// Whole lines of a table; `cut`: an incomplete line follows them.
struct Contents {
  std::string lines;
  bool cut = false;
};

/// Reads a table without changing it. Throws SessionError for other columns.
Contents contents_of(const std::string& file, const std::string& columns) {
  if (!is_there(file)) return {};
  const std::optional<std::string> text = file_text(file, kMaxTableBytes + 1);
  if (!text || text->size() > kMaxTableBytes)
    throw SessionError(file + ": cannot be read; allowed: a readable file of at most 256 MB");
  const std::size_t whole = text->rfind('\n') + 1;  // 0 where there is none
  const std::string first = text->substr(0, text->find('\n'));
  if (whole == 0 ? columns.compare(0, first.size(), first) != 0 : first != columns)
    throw SessionError(file + ":1: these columns are not allowed; allowed: " + columns);
  return {text->substr(0, whole), whole < text->size()};
}

/// Rows without the header.
std::vector<std::vector<std::string>> rows_in(const std::string& file, const std::string& columns,
                                              const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
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

/// Seconds with nine decimals: a double has too few digits for nanoseconds since 1970.
std::string stamp_text(Nanoseconds stamp) {
  constexpr Nanoseconds kPerSecond = 1'000'000'000;
  std::string decimals = std::to_string(stamp % kPerSecond);
  decimals.insert(0, 9 - decimals.size(), '0');
  return std::to_string(stamp / kPerSecond) + '.' + decimals;
}

void write_now(std::ofstream& out, const std::string& text, const std::string& file) {
  out << text << std::flush;
  if (!out) throw SessionError(file + ": cannot be written; allowed: a folder to write to with space left");
}

/// Returns 0 if the text is not a count or is implausibly large.
int whole_number(const std::string& field) {
  constexpr int kMax = 1'000'000'000;
  const std::optional<double> value = text::to_number(field);
  return value && *value > 0.0 && *value <= kMax ? static_cast<int>(*value) : 0;
}

TrialResult result_named(const std::string& name) {
  for (const TrialResult result :
       {TrialResult::completed, TrialResult::skipped, TrialResult::timed_out, TrialResult::aborted}) {
    if (name == to_string(result)) return result;
  }
  return TrialResult::none;
}

constexpr int kVersion = 1;

using Field = std::pair<const char*, std::string>;

/// Fields that identify a session, besides its gravity.
std::vector<Field> identity(const SessionHeader& header) {
  return {{"participant", header.participant},
          {"group", header.group},
          {"handedness", header.handedness},
          {"condition", header.condition},
          {"seed", std::to_string(header.seed)},
          {"task", header.task},
          {"session", std::to_string(header.session)},
          {"simulated", header.simulated ? "true" : "false"},
          {"order", "[" + text::joined(header.order) + "]"}};
}

std::string field_text(const YAML::Node& node) {
  if (!node) return "nothing";
  if (!node.IsSequence()) return yaml_text(node);
  std::vector<std::string> items;
  for (const auto& item : node) items.push_back(yaml_text(item));
  return "[" + text::joined(items) + "]";
}

[[noreturn]] void refuse(const std::string& file, const std::string& key, const std::string& there,
                         const std::string& here) {
  throw SessionError(file + ": " + key + ": the session in this folder has " + there + ", this one " + here +
                     "; allowed: the same, or another folder");
}

void check_word(const char* key, const std::string& value) {
  if (!is_name(value))
    throw SessionError(std::string(key) + " '" + text::one_line(value, 60) +
                       "' is not allowed; allowed: a name of " + kNameIs);
}

/// Throws SessionError for a value that is not allowed in session.yaml.
void check_header(const SessionHeader& header) {
  check_word("participant", header.participant);
  check_word("condition", header.condition);
  check_word("group", header.group);
  if (header.handedness != "right" && header.handedness != "left")
    throw SessionError("handedness '" + header.handedness + "' is not allowed; allowed: right or left");
}

/// The text of session.yaml.
std::string header_text(const SessionHeader& header) {
  YAML::Emitter out;
  out << YAML::BeginMap << YAML::Key << "version" << YAML::Value << kVersion;
  const auto quoted = [&out](const char* key, const std::string& value) {
    out << YAML::Key << key << YAML::Value << YAML::DoubleQuoted << value;
  };
  quoted("participant", header.participant);
  quoted("group", header.group);
  out << YAML::Key << "handedness" << YAML::Value << header.handedness;
  quoted("condition", header.condition);
  out << YAML::Key << "gravity" << YAML::Value << YAML::Flow << YAML::BeginSeq;
  for (const double g : {header.gravity.x(), header.gravity.y(), header.gravity.z()}) out << g;
  out << YAML::EndSeq << YAML::Key << "seed" << YAML::Value << header.seed;
  quoted("task", header.task);
  out << YAML::Key << "session" << YAML::Value << header.session;
  out << YAML::Key << "simulated" << YAML::Value << header.simulated;
  quoted("started", header.started);
  out << YAML::Key << "order" << YAML::Value << YAML::Flow << header.order;
  quoted("software", header.software);
  out << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

/// Throws SessionError if the file is not that of the same session; `started` and `software` may differ.
void check_same_session(const std::string& file, const SessionHeader& header) {
  read_yaml<SessionError>(file, [&] {
    const YAML::Node there = load_yaml_file(file);
    if (!there.IsMap())
      throw SessionError(file + ": is not a list of keys with values; allowed: a session's header");
    for (const auto& [key, here] : identity(header)) {
      const bool first = std::string(key) == "session" &&
                         !there[key];  // of recordings before a participant could have several
      const std::string said = first ? "1" : field_text(there[key]);
      if (said != here) refuse(file, key, "'" + said + "'", "'" + here + "'");
    }
    const std::optional<Vector3> gravity = yaml_vector(there["gravity"]);
    if (!gravity || *gravity != header.gravity)
      refuse(file, "gravity", field_text(there["gravity"]), text::vector(header.gravity));
  });
}

const char* const kLockFile = "/session.lock";

/// Writes who holds the lock, for messages only.
void write_holder(int file) {
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  const std::string text = "process " + std::to_string(getpid()) + " on " + host + "\n";
  if (ftruncate(file, 0) != 0 || write(file, text.data(), text.size()) < 0) return;
}

std::string holder(const std::string& file) {
  const std::string text = text::one_line(file_text(file, 300).value_or(""), 300);
  return text.empty() ? "another process" : text;
}

}  // namespace

/// Locks a folder for one program at a time. The lock ends with the program, however it ends.
class FolderLock {
 public:
  /// Throws SessionError that names the process and machine that has it, or says that it cannot be written.
  explicit FolderLock(const std::string& folder) {
    const std::string file = folder + kLockFile;
    file_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOCTTY, 0644);
    struct stat opened {};
    if (file_ >= 0 && (fstat(file_, &opened) != 0 || !S_ISREG(opened.st_mode))) {
      close(file_);
      throw SessionError(file + ": is no file; allowed: a file, or none yet");
    }
    if (file_ < 0)
      throw SessionError(file + ": cannot be written: " + std::strerror(errno) +
                         "; allowed: a folder to write to with space left");
    if (flock(file_, LOCK_EX | LOCK_NB) == 0) {
      write_holder(file_);
      return;
    }
    const std::string has_it = holder(file);
    close(file_);
    throw SessionError(folder + ": is in use by " + has_it + "; allowed: another folder, or end that first");
  }
  ~FolderLock() { close(file_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_ = -1;
};

SessionFolder::SessionFolder(const std::string& folder, const SessionHeader& header,
                             const SessionSetup& setup)
    : path_(folder), condition_(header.condition) {
  check_header(header);
  check(header, setup);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw SessionError(folder + ": cannot be made: " + error.message());
  lock_ = std::make_unique<FolderLock>(folder);
  check(header, setup);  // again, now that it is locked
  open_header(header, setup);

  const std::string trials = open_table(kTrials, kTrialColumns, trials_);
  for (const auto& row : rows_in(trials_.file, kTrialColumns, trials)) {
    earlier_.push_back({whole_number(row[0]), row[1], whole_number(row[3]), result_named(row[4]), 0.0, {}});
    last_trial_ = std::max(last_trial_, earlier_.back().trial);
  }
  const std::string events = open_table(kEvents, kEventColumns, events_);
  for (const auto& row : rows_in(events_.file, kEventColumns, events)) {
    const double time = text::to_number(row[0]).value_or(0.0);
    if (std::isfinite(time)) last_time_ = std::max(last_time_, time);
    last_trial_ = std::max(last_trial_, whole_number(row[1]));
  }
}

SessionFolder::~SessionFolder() = default;

void SessionFolder::check(const SessionHeader& header, const SessionSetup& setup) const {
  const fs::path folder = path_;
  const std::string file = (folder / "session.yaml").string();
  if (is_there(file)) {
    check_same_session(file, header);
    check_same_setup(path_, setup);
  } else if (is_there(folder / "setup") && !is_there(folder / "setup" / "SHA256SUMS")) {
    throw SessionError((folder / "setup").string() + ": is no session's; allowed: another folder");
  }
  const std::pair<const char*, const char*> tables[]{
      {kTrials, kTrialColumns}, {kEvents, kEventColumns}, {kHands, kHandColumns}, {kHandsRaw, kHandColumns}};
  for (const auto& [name, columns] : tables) {
    const std::string table = (folder / name).string();
    rows_in(table, columns, contents_of(table, columns).lines);
  }
}

void SessionFolder::open_header(const SessionHeader& header, const SessionSetup& setup) {
  const fs::path file = fs::path(path_) / "session.yaml";
  resumed_ = is_there(file);
  if (resumed_) return;
  write_setup(path_, setup);
  const fs::path unfinished = fs::path(path_) / "session.yaml.part";
  std::error_code error;
  fs::remove(unfinished, error);
  std::ofstream out = file_to_write(unfinished.string());
  write_now(out, header_text(header), file.string());
  out.close();
  fs::rename(unfinished, file, error);
  if (error) throw SessionError(file.string() + ": cannot be written: " + error.message());
}

/// Opens a table to append to, and returns its whole lines. Throws SessionError for other columns.
std::string SessionFolder::open_table(const char* name, const char* columns, Table& table) {
  table.file = (fs::path(path_) / name).string();
  const Contents there = contents_of(table.file, columns);
  if (there.cut) {
    std::error_code error;
    fs::resize_file(table.file, there.lines.size(), error);
    if (error) throw SessionError(table.file + ": cannot be written: " + error.message());
    notes_.push_back(table.file + ": its last line was cut off while it was written: taken away");
  }
  table.out = file_to_write(table.file, std::ios::binary | std::ios::app);
  struct stat opened {};
  if (!table.out || stat(table.file.c_str(), &opened) != 0) write_now(table.out, "", table.file);
  table.device = opened.st_dev;
  table.inode = opened.st_ino;
  if (there.lines.empty()) table.write(std::string(columns) + '\n');
  return there.lines;
}

/// Detects a removed or replaced file, to which the kernel would still write.
void SessionFolder::Table::check_there() const {
  if (!out.is_open()) return;
  struct stat now {};
  if (stat(file.c_str(), &now) == 0 && now.st_dev == device && now.st_ino == inode) return;
  throw SessionError(file +
                     ": was removed or replaced while the session runs; allowed: a folder that is left alone "
                     "until then");
}

void SessionFolder::Table::write(const std::string& text) {
  check_there();
  write_now(out, text, file);
}

void SessionFolder::check_there() const {
  for (const Table* table : {&trials_, &events_, &hands_, &hands_raw_}) table->check_there();
}

void SessionFolder::log(const EventRow& row) {
  const auto trial = row.trial > 0 ? std::make_optional(row.trial) : std::nullopt;
  events_.write(line_of(row.time, trial, to_string(row.stage), row.event, row.object, row.detail,
                        stamp_text(row.stamp), row.utc));
}

void SessionFolder::log(const TrialRow& row) {
  const TrialMeasures& m = row.measures;
  trials_.write(line_of(row.trial, row.object, condition_, row.repetition, to_string(row.result), row.start,
                        m.completion_time, m.stage_times[0], m.stage_times[1], m.stage_times[2], m.attempts,
                        m.drops, m.path_length, m.grip_force_mean, m.grip_force_max, m.release_drift,
                        m.release_speed, m.tracking_losses, m.attempts, m.manipulation_drops, m.touches,
                        m.arrival_speed, m.misplacement, m.misalignment, m.operator_speed, m.operator_spin));
}

void SessionFolder::log(const HandRow& row) {
  constexpr int kIndex = 1, kDistal = 3, kTracked = 0, kUntouched = 0;
  Table& table = row.filtered ? hands_ : hands_raw_;
  if (!table.out.is_open()) open_table(row.filtered ? kHands : kHandsRaw, kHandColumns, table);
  table.write(line_of(row.time, row.hand, row.side, kIndex, kDistal, kTracked, row.start, row.end, row.radius,
                      kUntouched));
}

}  // namespace mrhi
