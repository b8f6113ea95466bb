#include "report.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <ostream>

#include "text/files.h"
#include "text/text.h"

namespace mrhi::real_grasps {
namespace {

constexpr double kHinge = 10.0 * M_PI / 180.0;  // [rad]

std::string time_or_dash(const std::optional<double>& time) {
  if (!time) return "-";
  return text::format("%.2f", *time);
}

constexpr double kMilli = 1e3;

std::string number_or_nothing(const std::optional<double>& value) {
  return value ? std::to_string(*value) : "";
}

void write_row(std::ostream& csv, const Contender& contender, const std::string& row,
               const std::string& object, const Summary& sum) {
  (CsvRows(csv) << contender.engine << contender.setting << row << object << sum.events << sum.held
                << sum.carried << sum.carried_interval.low << sum.carried_interval.high << sum.fair
                << sum.held_fair << sum.carried_fair << sum.force << kMilli * sum.away << kMilli * sum.release
                << sum.frame_time << sum.frame_time_p99 << sum.assisted << sum.held_interval.low
                << sum.held_interval.high << sum.held_fair_interval.low << sum.held_fair_interval.high)
      .end_row();
}

/// Successful events among those for which `counts` holds, by recording.
template <typename Counts, typename Succeeds>
Interval by_recording(const std::vector<Event>& events, Counts counts, Succeeds succeeds) {
  std::map<std::string, SuccessCount> groups;
  for (const Event& event : events) {
    if (!counts(event.outcome)) continue;
    SuccessCount& group = groups[event.recording];
    ++group.trials;
    group.successes += succeeds(event.outcome);
  }
  std::vector<SuccessCount> shares;
  for (const auto& group : groups) shares.push_back(group.second);
  return grouped(shares);
}

bool is_fair(const Outcome& outcome) {
  return outcome.early < kFair;
}

}  // namespace

std::vector<Event> with_object(const std::string& object, const std::vector<Event>& events) {
  std::vector<Event> found;
  std::copy_if(events.begin(), events.end(), std::back_inserter(found),
               [&](const Event& event) { return event.object == object; });
  return found;
}

Summary summarise(const std::vector<Event>& events) {
  Summary sum;
  std::vector<double> forces, aways, releases, times;
  for (const Event& event : events) {
    const Outcome& outcome = event.outcome;
    const bool fair = is_fair(outcome);
    ++sum.events;
    sum.held += outcome.held, sum.carried += outcome.carried, sum.assisted += outcome.assisted;
    sum.fair += fair;
    sum.held_fair += fair && outcome.held, sum.carried_fair += fair && outcome.carried;
    if (outcome.force > 0.0) forces.push_back(outcome.force);
    if (outcome.carried) aways.push_back(outcome.away);
    if (outcome.held && outcome.released) releases.push_back(outcome.release);
    times.insert(times.end(), outcome.frame_times.begin(), outcome.frame_times.end());
  }
  sum.force = quantile(forces, 0.5), sum.away = quantile(aways, 0.5), sum.release = quantile(releases, 0.5);
  sum.frame_time = quantile(times, 0.5), sum.frame_time_p99 = quantile(times, 0.99);
  const auto any = [](const Outcome&) { return true; };
  const auto held = [](const Outcome& outcome) { return outcome.held; };
  sum.held_interval = by_recording(events, any, held);
  sum.carried_interval = by_recording(events, any, [](const Outcome& outcome) { return outcome.carried; });
  sum.held_fair_interval = by_recording(events, is_fair, held);
  return sum;
}

LossCauses loss_causes(const std::vector<Event>& events) {
  LossCauses lost;
  for (const Event& event : events) {
    if (event.outcome.held) continue;
    const auto& motion = event.outcome.first_motion;
    ++(motion ? lost.by_cause[static_cast<std::size_t>(motion->cause)] : lost.none);
  }
  return lost;
}

std::string line(const LossCauses& lost) {
  std::string text = "  lost, first moved by:";
  for (const MotionCause cause :
       {MotionCause::back, MotionCause::sweep, MotionCause::closing, MotionCause::open})
    text += std::string(" ") + to_string(cause) + " " +
            std::to_string(lost.by_cause[static_cast<std::size_t>(cause)]) + ",";
  return text + " nothing " + std::to_string(lost.none);
}

std::string line(const Event& event) {
  const Outcome& outcome = event.outcome;
  if (!outcome.note.empty())
    return text::format("%-24s %6.2f s  lost  %s", event.recording.c_str(), event.closing.closed,
                        outcome.note.c_str());
  return text::format(
      "%-24s %6.2f s  %s  %4.0f mm away, %3.0f mm early, p90 %4.0f N, grasp %s to %s s, opens %.2f s, "
      "release %.0f mm/s, %.2f of the hand's speed%s",
      event.recording.c_str(), event.closing.closed, outcome.held ? "held" : "lost", 1e3 * outcome.away,
      1e3 * outcome.early, outcome.force, time_or_dash(outcome.grasp_began).c_str(),
      time_or_dash(outcome.grasp_ended).c_str(), event.closing.opens, 1e3 * outcome.release, outcome.speed,
      outcome.assisted ? ", taken" : "");
}

std::string line(const std::string& name, const std::vector<Event>& events) {
  const Summary all = summarise(events);
  const Interval &held = all.held_interval, &fair = all.held_fair_interval;
  return text::format(
      "%-14s held %2zu of %2zu (%2.0f to %2.0f %%), carried %zu, taken %zu; within 10 mm %2zu of %2zu "
      "(%2.0f to %2.0f %%); p90 %5.1f N; release %4.0f mm/s; frame %.0f us, p99 %.0f",
      name.c_str(), all.held, all.events, 100.0 * held.low, 100.0 * held.high, all.carried, all.assisted,
      all.held_fair, all.fair, 100.0 * fair.low, 100.0 * fair.high, all.force, 1e3 * all.release,
      all.frame_time, all.frame_time_p99);
}

std::string line_against_rigid(const std::vector<WindowOutcome>& outcomes,
                               const std::vector<WindowOutcome>& rigid) {
  const Interval interval = difference_interval(outcomes, rigid, 0.02);
  return text::format("  against a rigid hand: within 20 mm %+.0f points (%+.0f to %+.0f)",
                      100.0 * (fraction_within(outcomes, 0.02) - fraction_within(rigid, 0.02)),
                      100.0 * interval.low, 100.0 * interval.high);
}

std::string line(const LeadSpread& spread) {
  const auto range = [](const std::vector<double>& shares) {
    const auto [low, high] = std::minmax_element(shares.begin(), shares.end());
    double sum = 0.0;
    for (const double share : shares) sum += share;
    return text::format("%.0f %% (%.0f to %.0f)", 100.0 * sum / double(shares.size()), 100.0 * *low,
                        100.0 * *high);
  };
  return "  over " + std::to_string(spread.within_50mm.size()) + " leads: within 50 mm " +
         range(spread.within_50mm) + ", within 20 mm " + range(spread.within_20mm);
}

std::string line(const std::string& name, const std::vector<WindowOutcome>& outcomes) {
  std::size_t frames = 0;
  for (const WindowOutcome& outcome : outcomes) frames += outcome.away.size();
  const Interval loose = fraction_interval(outcomes, 0.05), tight = fraction_interval(outcomes, 0.02);
  const std::string line = text::format(
      "%-26s %5zu frames of %3zu captures; within 50 mm %3.0f %% (%.0f to %.0f), within 20 mm "
      "%3.0f %% (%.0f to %.0f); p90 force %5.1f N; to the end %zu of %zu",
      name.c_str(), frames, by_label(outcomes, &WindowLabels::capture).size(),
      100.0 * fraction_within(outcomes, 0.05), 100.0 * loose.low, 100.0 * loose.high,
      100.0 * fraction_within(outcomes, 0.02), 100.0 * tight.low, 100.0 * tight.high, force_p90(outcomes),
      stayed(outcomes, 0.05), outcomes.size());
  if (outcomes.empty() || outcomes.front().turned.empty()) return line;
  return line + text::format("; with its hinge within 10 degrees 50 mm %.0f %%, 20 mm %.0f %%",
                             100.0 * fraction_within(outcomes, 0.05, kHinge),
                             100.0 * fraction_within(outcomes, 0.02, kHinge));
}

void write_header(std::ostream& csv) {
  csv << "engine,setting,row,object,events,held,carried,carried_low,carried_high,fair,held_fair,carried_fair,"
         "force_p90_N,away_mm,release_mm_per_s,us_per_frame,us_per_frame_p99,taken,held_low,held_"
         "high,held_fair_low,held_fair_high\n";
}

void write_rows(std::ostream& csv, const Contender& contender, const std::string& row,
                const std::vector<Event>& events) {
  write_row(csv, contender, row, "all", summarise(events));
  for (const char* object : kObjects) {
    const std::vector<Event> some = with_object(object, events);
    if (!some.empty()) write_row(csv, contender, row, object, summarise(some));
  }
}

void write_events_header(std::ostream& csv) {
  csv << "engine,setting,row,recording,closed_s,opens_s,held,carried,away_mm,early_mm,force_p90_N,grasp_"
         "began_s,"
         "grasp_ended_s,let_go_s,release_mm_per_s,speed_ratio,note,taken,blow_s,blow_by,object\n";
}

void write_events(std::ostream& csv, const Contender& contender, const std::string& row,
                  const std::vector<Event>& events) {
  for (const Event& event : events) {
    const Outcome& o = event.outcome;
    const std::string motion_time = o.first_motion ? std::to_string(o.first_motion->time) : "";
    const std::string motion_cause = o.first_motion ? to_string(o.first_motion->cause) : "";
    (CsvRows(csv) << contender.engine << contender.setting << row << event.recording << event.closing.closed
                  << event.closing.opens << o.held << o.carried << kMilli * o.away << kMilli * o.early
                  << o.force << number_or_nothing(o.grasp_began) << number_or_nothing(o.grasp_ended)
                  << number_or_nothing(o.released) << kMilli * o.release << o.speed << o.note << o.assisted
                  << motion_time << motion_cause << event.object)
        .end_row();
  }
}

void write_arctic_header(std::ostream& csv) {
  csv << "engine,setting,split,lead,count,stayed,stayed_low,stayed_high,within_50mm,within_20mm,force_p90_N,"
         "within_50mm_low,within_50mm_high,within_20mm_low,within_20mm_high,captures\n";
}

void write_arctic(std::ostream& csv, const Contender& contender, const std::string& split,
                  const std::string& lead, const std::vector<WindowOutcome>& outcomes) {
  const std::size_t to_the_end = stayed(outcomes, 0.05);
  const Interval interval = wilson(to_the_end, outcomes.size());
  const Interval loose = fraction_interval(outcomes, 0.05), tight = fraction_interval(outcomes, 0.02);
  (CsvRows(csv) << contender.engine << contender.setting << split << lead << outcomes.size() << to_the_end
                << interval.low << interval.high << fraction_within(outcomes, 0.05)
                << fraction_within(outcomes, 0.02) << force_p90(outcomes) << loose.low << loose.high
                << tight.low << tight.high << by_label(outcomes, &WindowLabels::capture).size())
      .end_row();
}

}  // namespace mrhi::real_grasps
