#include <ostream>
#include <utility>

#include "report.h"
#include "statistics.h"
#include "text/csv.h"

namespace mrhi::real_grasps {
namespace {

constexpr double kMilli = 1e3;

std::string number_or_nothing(const std::optional<double>& value) {
  return value ? std::to_string(*value) : "";
}

void write_row(std::ostream& csv, const Contender& contender, const std::string& row, const char* half,
               const Summary& sum) {
  const Interval interval = wilson(sum.carried, sum.events);
  (CsvRows(csv) << contender.engine << contender.setting << row << half << sum.events << sum.held
                << sum.carried << interval.low << interval.high << sum.fair << sum.held_fair
                << sum.carried_fair << sum.force << kMilli * sum.away << kMilli * sum.release
                << sum.frame_time << sum.frame_time_p99 << sum.taken)
      .end_row();
}

}  // namespace

void write_header(std::ostream& csv) {
  csv << "engine,setting,row,half,events,held,carried,carried_low,carried_high,fair,held_fair,carried_fair,"
         "force_p90_N,away_mm,release_mm_per_s,us_per_frame,us_per_frame_p99,taken\n";
}

void write_rows(std::ostream& csv, const Contender& contender, const std::string& row,
                const std::vector<Event>& events) {
  write_row(csv, contender, row, "all", summarise(events));
  write_row(csv, contender, row, "tuned", summarise(events, Half::tuned));
  write_row(csv, contender, row, "held_out", summarise(events, Half::held_out));
}

void write_events_header(std::ostream& csv) {
  csv << "engine,setting,row,recording,closed_s,opens_s,held,carried,away_mm,early_mm,force_p90_N,grasp_"
         "began_s,"
         "grasp_ended_s,let_go_s,release_mm_per_s,speed_ratio,note,taken,blow_s,blow_by\n";
}

void write_events(std::ostream& csv, const Contender& contender, const std::string& row,
                  const std::vector<Event>& events) {
  for (const Event& event : events) {
    const Outcome& o = event.outcome;
    const std::string blow_time = o.blow ? std::to_string(o.blow->time) : "";
    const std::string blow_by = o.blow ? to_string(o.blow->blow) : "";
    (CsvRows(csv) << contender.engine << contender.setting << row << event.recording << event.closing.closed
                  << event.closing.opens << o.held << o.carried << kMilli * o.away << kMilli * o.early
                  << o.force << number_or_nothing(o.grasp_began) << number_or_nothing(o.grasp_ended)
                  << number_or_nothing(o.let_go) << kMilli * o.release << o.speed << o.note << o.taken
                  << blow_time << blow_by)
        .end_row();
  }
}

void write_arctic_header(std::ostream& csv) {
  csv << "engine,setting,windows,count,stayed,stayed_low,stayed_high,within_50mm,within_20mm,force_p90_N\n";
}

void write_arctic(std::ostream& csv, const Contender& contender, const std::string& group,
                  const std::vector<WindowOutcome>& outcomes) {
  const std::size_t to_the_end = stayed(outcomes, 0.05);
  const Interval interval = wilson(to_the_end, outcomes.size());
  (CsvRows(csv) << contender.engine << contender.setting << group << outcomes.size() << to_the_end
                << interval.low << interval.high << share_within(outcomes, 0.05)
                << share_within(outcomes, 0.02) << force_p90(outcomes))
      .end_row();
}

}  // namespace mrhi::real_grasps
