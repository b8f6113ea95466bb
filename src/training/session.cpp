#include "mr_hand_interaction/training/session.h"

#include <algorithm>
#include <utility>

#include "../text/text.h"
#include "latin_square.h"

namespace mrhi {
namespace {

std::vector<std::size_t> object_order(const Task& task, std::uint64_t seed, std::uint64_t place) {
  if (task.latin_square) return latin_square_order(task.objects.size(), place, seed);
  std::vector<std::size_t> order(task.objects.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  return order;
}

SessionHeader complete_header(SessionHeader header, const Task& task, std::uint64_t place) {
  header.gravity = task.gravity;
  header.task = task.name;
  header.order.clear();
  for (const std::size_t i : object_order(task, header.seed, place))
    header.order.push_back(task.objects[i].name);
  return header;
}

}  // namespace

std::uint64_t participant_place(const std::string& participant) {
  constexpr std::size_t kMostDigits = 9;
  const std::size_t last_letter = participant.find_last_not_of("0123456789");
  const std::string digits =
      last_letter == std::string::npos ? participant : participant.substr(last_letter + 1);
  if (digits.empty() || digits.size() > kMostDigits)
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
  go_on_from(0);
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

void Session::go_on_from(std::size_t position) {
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
    go_on_from(position_ - 1);
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
  go_on_from(position_);
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

}  // namespace mrhi
