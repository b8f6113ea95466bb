#pragma once

#include <array>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "arctic.h"
#include "contenders.h"
#include "statistics.h"
#include "trial.h"

namespace mrhi::real_grasps {

/// One closing, what was put there, and what became of it.
struct Event {
  std::string recording;
  Closing closing;
  Outcome outcome;
  std::string object;  ///< see Recording::object
};

/// What the events of a row come to.
struct Summary {
  std::size_t events = 0, held = 0, carried = 0, taken = 0;
  std::size_t fair = 0, held_fair = 0,
              carried_fair = 0;  ///< of those nudged less than kFair as the hand closed
  double force = 0.0;            ///< median of the p90 of a finger's force, where touched [N]
  double away = 0.0;             ///< median of those carried [m]
  double release = 0.0;          ///< median of those held [m/s]
  double frame_time = 0.0;       ///< median [us]
  double frame_time_p99 = 0.0;
  Interval held_interval, carried_interval, held_fair_interval;  ///< grouped by recording
};

Summary summarise(const std::vector<Event>& events);

/// Events of hands that had the same object before them.
std::vector<Event> with_object(const std::string& object, const std::vector<Event>& events);

/// What first set in motion those that were lost: of how many the back of the hand, the hand as a whole, a
/// closing finger, an open hand, and nothing that was seen.
struct LostTo {
  std::array<std::size_t, 4> blows{};  ///< by Blow
  std::size_t none = 0;
};
LostTo lost_to(const std::vector<Event>& events);

/// A line of text each.
std::string line(const Event& event);
std::string line(const std::string& name, const std::vector<Event>& events);
std::string line(const std::string& name, const std::vector<WindowOutcome>& outcomes);
std::string line(const LostTo& lost);

/// real_grasps.csv: a line for each contender, row and kind of object (`all`, or Recording::object).
void write_header(std::ostream& csv);
void write_rows(std::ostream& csv, const Contender& contender, const std::string& row,
                const std::vector<Event>& events);

/// real_grasps_events.csv: a line for each closing.
void write_events_header(std::ostream& csv);
void write_events(std::ostream& csv, const Contender& contender, const std::string& row,
                  const std::vector<Event>& events);

/// Shares of frames over the leads that windows were played with.
struct LeadSpread {
  std::vector<double> within_50mm, within_20mm;
};
std::string line(const LeadSpread& spread);

/// real_grasps_arctic.csv: a line for each contender, group of windows and lead.
void write_arctic_header(std::ostream& csv);
void write_arctic(std::ostream& csv, const Contender& contender, const std::string& group,
                  const std::string& lead, const std::vector<WindowOutcome>& outcomes);

}  // namespace mrhi::real_grasps
