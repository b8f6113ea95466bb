#include "mr_hand_interaction/training/session.h"

#include <openssl/sha.h>
#include <algorithm>
#include <array>
#include <filesystem>
#include <numeric>
#include <random>
#include <sstream>
#include <utility>

#include "../text/files.h"
#include "../text/text.h"
#include "mr_hand_interaction/parameters.h"
#include "revision.h"

namespace mrhi {
namespace {

/// Fisher-Yates shuffle with the same result for every standard library.
void shuffle(std::vector<std::size_t>& items, std::mt19937_64& random) {
  for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[random() % i]);
}

std::vector<std::size_t> counted(std::size_t n) {
  std::vector<std::size_t> items(n);
  std::iota(items.begin(), items.end(), std::size_t{0});
  return items;
}

/// 0, 1, n - 1, 2, n - 2, ...: neighbours differ by each amount once.
std::size_t zigzag(std::size_t place, std::size_t n) {
  return place % 2 == 1 ? (place + 1) / 2 : (n - place / 2) % n;
}

std::vector<std::size_t> object_order(const Task& task, std::uint64_t seed, std::uint64_t place) {
  if (task.latin_square) return latin_square_order(task.objects.size(), place, seed);
  return counted(task.objects.size());
}

SessionHeader complete_header(SessionHeader header, const Task& task, std::uint64_t place) {
  header.gravity = task.gravity;
  header.task = task.name;
  header.order.clear();
  for (const std::size_t i : object_order(task, header.seed, place))
    header.order.push_back(task.objects[i].name);
  return header;
}

namespace fs = std::filesystem;

constexpr std::size_t kMaxMeshBytes = std::size_t{256} << 20;
/// Characters shown of a line that differs, and of those before the difference.
constexpr std::size_t kMaxShown = 60, kMaxBefore = 30;
const char* const kSums = "SHA256SUMS";
const char* const kAllowed = "; allowed: the same, or another folder";

std::string bytes_of(const std::string& file) {
  std::optional<std::string> text = file_text(file, kMaxMeshBytes + 1);
  if (!text || text->size() > kMaxMeshBytes)
    throw SceneError(file + ": cannot be read; allowed: a readable file of at most 256 MB");
  return *std::move(text);
}

/// SHA-256 in hexadecimal, as `sha256sum` prints it.
std::string sha256(const std::string& bytes) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest;
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest.data());
  std::string digits;
  for (const unsigned char byte : digest) {
    digits += "0123456789abcdef"[byte >> 4];
    digits += "0123456789abcdef"[byte & 0xf];
  }
  return digits;
}

std::string parameters_text(const Configuration& configuration) {
  std::string all;
  for (const auto& [name, text] : parameter_texts(configuration)) all += name + ": " + text + '\n';
  return all;
}

std::string list_of(const std::map<std::string, std::string>& sums) {
  std::string all;
  for (const auto& [name, sum] : sums) all.append(sum).append("  ").append(name).append("\n");
  return all;
}

std::string sums_of(const SessionSetup& setup) {
  std::map<std::string, std::string> sums;
  for (const auto& [name, text] : setup.files) sums[name] = sha256(text);
  return list_of(sums);
}

/// A name that no other file has: files of two scenes may have the same name.
std::string free_name(const SessionSetup& setup, const std::string& object, const std::string& ending) {
  const std::string name = "scenes/" + object + ending;
  return setup.files.count(name) == 0 ? name : "scenes/fixture_" + object + ending;
}

void write_whole(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  out << text << std::flush;
  if (!out)
    throw SessionError(file.string() + ": cannot be written; allowed: a folder to write to with space left");
}

/// The line that begins at `start`, from shortly before the difference at `differs`.
std::string shown(const std::string& text, std::size_t start, std::size_t differs) {
  if (start >= text.size()) return "'no such line'";
  const std::size_t from = std::max(start, differs - std::min(differs, kMaxBefore));
  const std::string line = text.substr(from, text.find('\n', from) - from);
  return (from > start ? "'..." : "'") + text::one_line(line, kMaxShown) + "'";
}

/// Throws SessionError that shows the first difference between `there` and `here`.
[[noreturn]] void refuse(const std::string& file, const std::string& there, const std::string& here) {
  const auto end = there.begin() + static_cast<std::ptrdiff_t>(std::min(there.size(), here.size()));
  const auto differs = std::mismatch(there.begin(), end, here.begin()).first;
  const auto number = 1 + std::count(there.begin(), differs, '\n');
  const auto at = static_cast<std::size_t>(differs - there.begin());
  const std::size_t start = at == 0 ? 0 : there.rfind('\n', at - 1) + 1;  // 0 in the first line
  throw SessionError(file + ":" + std::to_string(number) + ": the session in this folder was begun with " +
                     shown(there, start, at) + ", this one has " + shown(here, start, at) + kAllowed);
}

/// Names in the order of comparison: readable files come before the checksums.
std::vector<std::string> in_order(const SessionSetup& setup) {
  std::vector<std::string> names{"parameters.yaml", "task.yaml", "software.yaml"};
  for (const auto& [name, text] : setup.files) {
    if (name != kSums && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  names.emplace_back(kSums);
  return names;
}

}  // namespace

std::vector<std::size_t> latin_square_order(std::size_t n, std::uint64_t participant, std::uint64_t seed) {
  if (n == 0) return {};
  std::mt19937_64 random(seed);
  std::vector<std::size_t> things = counted(n), rows = counted(n), mirrored_rows = counted(n);
  shuffle(things, random);
  shuffle(rows, random);
  shuffle(mirrored_rows, random);

  const bool mirrored = n % 2 == 1 && participant / n % 2 == 1;
  const std::size_t row = (mirrored ? mirrored_rows : rows)[participant % n];
  std::vector<std::size_t> order(n);
  for (std::size_t place = 0; place < n; ++place) {
    const std::size_t from = mirrored ? n - 1 - place : place;
    order[place] = things[(zigzag(from, n) + row) % n];
  }
  return order;
}

std::uint64_t participant_place(const std::string& participant) {
  constexpr std::size_t kMaxDigits = 9;
  const std::size_t last_letter = participant.find_last_not_of("0123456789");
  const std::string digits =
      last_letter == std::string::npos ? participant : participant.substr(last_letter + 1);
  if (digits.empty() || digits.size() > kMaxDigits)
    throw SessionError("participant '" + text::one_line(participant, 60) +
                       "' has no number for the order of objects; allowed: a name "
                       "that ends with one, such as P07, or a number of its own");
  const std::uint64_t number = std::stoull(digits);
  return number > 0 ? number - 1 : 0;
}

Session::Session(Task task, const SessionHeader& header, std::uint64_t place, const std::string& folder,
                 Nanoseconds now, const SessionSetup& setup, SessionHooks hooks)
    : task_(std::make_unique<const Task>(std::move(task))),
      folder_(folder, complete_header(header, *task_, place), setup),
      hooks_(std::move(hooks)),
      first_(now),
      number_(folder_.last_trial()),
      trial_(*task_) {
  for (int repetition = task_->practice ? 0 : 1; repetition <= task_->repetitions; ++repetition) {
    for (const std::size_t object : object_order(*task_, header.seed, place))
      plan_.push_back({object, repetition, false});
  }
  for (const TrialRow& row : folder_.earlier_trials()) {
    if (row.result == TrialResult::aborted || row.result == TrialResult::none) continue;
    for (Planned& planned : plan_) {
      planned.done |=
          planned.repetition == row.repetition && task_->objects[planned.object].name == row.object;
    }
  }
  advance_to(0);
  log_event(folder_.resumed() ? "session_resumed" : "session_begun", now);
}

double Session::time(Nanoseconds stamp) const {
  return folder_.last_time() + to_seconds(std::max<Nanoseconds>(0, stamp - first_));
}

const Session::Planned& Session::planned() const {
  return plan_[std::min(position_, plan_.size() - 1)];
}

const TaskObject& Session::object() const {
  return task_->objects[planned().object];
}

void Session::advance_to(std::size_t position) {
  position_ = position;
  while (position_ < plan_.size() && plan_[position_].done) ++position_;
  phase_ = position_ < plan_.size() ? SessionPhase::ready : SessionPhase::finished;
}

void Session::begin(Nanoseconds now) {
  if (phase_ != SessionPhase::ready) return;
  trial_ = Trial(*task_);
  ++number_;
  start_ = time(now);
  phase_ = SessionPhase::running;
}

void Session::update(const Observation& seen) {
  if (phase_ != SessionPhase::running) return;
  if (!trial_.begun()) start_ = time(seen.stamp);
  trial_.update(seen);
  log_trial_events();
  if (trial_.result() != TrialResult::none) note_result();
}

void Session::log_hand(HandRow row, Nanoseconds stamp) {
  if (phase_ != SessionPhase::running || !trial_.begun()) return;
  row.time = time(stamp);
  folder_.log(row);
}

void Session::pause(bool paused, Nanoseconds now) {
  if (phase_ != (paused ? SessionPhase::running : SessionPhase::paused)) return;
  trial_.pause();
  phase_ = paused ? SessionPhase::paused : SessionPhase::running;
  log_event(paused ? "paused" : "resumed", now);
}

void Session::skip(Nanoseconds now) {
  begin(now);
  if (active()) end(TrialResult::skipped, now);
}

void Session::repeat(Nanoseconds now) {
  if (active()) {
    end(TrialResult::aborted, now);
  } else if (position_ > 0) {
    plan_[position_ - 1].done = false;
    advance_to(position_ - 1);
  }
  log_event("repeat", now);
}

void Session::note_parameter(const std::string& name, const std::string& value, bool as_begun,
                             Nanoseconds now) {
  std::string detail = text::one_line(name + ": " + value, 120);
  std::replace(detail.begin(), detail.end(), ',', ' ');  // of a vector; it is one field
  log_event(as_begun ? "parameter_restored" : "parameter_changed", now, detail);
}

void Session::abort(Nanoseconds now) {
  if (active()) end(TrialResult::aborted, now);
}

void Session::end(TrialResult result, Nanoseconds now) {
  const bool begun = trial_.begun();
  trial_.end(result);
  if (begun) log_trial_events();
  if (!begun) log_event(to_string(result), now);
  note_result();
}

void Session::note_result() {
  last_ = TrialRow{number_, object().name, planned().repetition, trial_.result(), start_, trial_.measures()};
  folder_.log(*last_);
  plan_[position_].done = trial_.result() != TrialResult::aborted;
  advance_to(position_);
}

void Session::log_trial_events() {
  for (const TrialEvent& event : trial_.events()) {
    EventRow row;
    row.time = time(event.stamp);
    row.stamp = event.stamp;
    row.trial = number_;
    row.stage = event.stage;
    row.event = to_string(event.kind);
    row.object = object().name;
    if (event.kind == TrialEventKind::ended) {
      row.detail = to_string(trial_.result());
    } else if (event.detail > 0.0) {
      row.detail = text::number(event.detail);
    }
    log(std::move(row));
  }
}

void Session::log_event(const char* event, Nanoseconds now, const std::string& detail) {
  EventRow row;
  row.time = time(now);
  row.stamp = now;
  row.event = event;
  row.detail = detail;
  if (active()) {
    row.trial = number_;
    row.stage = trial_.stage();
    row.object = object().name;
  }
  log(std::move(row));
}

void Session::log(EventRow row) {
  if (hooks_.utc) row.utc = hooks_.utc();
  folder_.log(row);
  if (hooks_.on_event) hooks_.on_event(row);
}

std::string source_revision() {
  return MR_HAND_INTERACTION_REVISION;
}

SessionSetup session_setup(const std::string& task_file, const Task& task, Configuration configuration,
                           const std::vector<std::string>& scene_folders, const SceneOptions& options,
                           const std::string& version) {
  SessionSetup setup;
  std::map<std::string, std::string> meshes;
  const auto add = [&](const std::string& name, const std::string& scene) {
    const std::string urdf = find_scene_file(scene, scene_folders);
    setup.files[free_name(setup, name, ".urdf")] = bytes_of(urdf);
    const fs::path yaml = fs::path(urdf).replace_extension(".yaml");
    if (fs::exists(yaml)) setup.files[free_name(setup, name, ".yaml")] = bytes_of(yaml.string());
    // By file names, because the path of a package may change.
    for (const SceneFile& mesh : load_scene(urdf, options).mesh_files)
      meshes[fs::path(mesh.path).filename().string()] = sha256(bytes_of(mesh.path));
  };
  for (const TaskObject& object : task.objects) add(object.name, object.file);
  for (const Fixture& fixture : task.fixtures) add(fixture.name, fixture.file);
  if (!task.scene.empty()) add(fs::path(task.scene).stem().string(), task.scene);
  configuration.gravity = task.gravity;
  setup.files["task.yaml"] = bytes_of(task_file);
  setup.files["parameters.yaml"] = parameters_text(configuration);
  setup.files["software.yaml"] = "version: " + version + "\nrevision: " + source_revision() + "\n";
  if (!meshes.empty()) setup.files["meshes.txt"] = list_of(meshes);
  setup.files[kSums] = sums_of(setup);
  return setup;
}

void write_setup(const std::string& folder, const SessionSetup& setup) {
  if (setup.files.empty()) return;
  try {
    const fs::path kept = fs::path(folder) / "setup", unfinished = fs::path(folder) / "setup.part";
    fs::remove_all(unfinished);
    for (const auto& [name, text] : setup.files) write_whole(unfinished / name, text);
    fs::remove_all(kept);
    fs::rename(unfinished, kept);
  } catch (const fs::filesystem_error& error) {
    throw SessionError(folder + ": setup cannot be written: " + error.code().message());
  }
}

void check_same_setup(const std::string& folder, const SessionSetup& setup) {
  if (setup.files.empty()) return;
  const std::string kept = folder + "/setup/";
  if (!fs::is_directory(kept))
    throw SessionError(folder + ": the session in this folder was begun without a record of its task, " +
                       "parameters and software (setup)" + kAllowed);
  for (const std::string& name : in_order(setup)) {
    const auto here = setup.files.find(name);
    const std::string there = file_text(kept + name, kMaxMeshBytes).value_or("");
    const std::string wanted = here == setup.files.end() ? "" : here->second;
    if (there != wanted) refuse(kept + name, there, wanted);
  }
}

}  // namespace mrhi
