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

/// One closing, its body, and the outcome.
struct Event {
  std::string recording;
  Closing closing;
  Outcome outcome;
  std::string object;  ///< see Recording::object
};

/// Statistics of a row's events.
struct Summary {
  std::size_t events = 0, held = 0, carried = 0, assisted = 0;
  std::size_t fair = 0, held_fair = 0,
              carried_fair = 0;  ///< among those moved less than kFair before the hand closed
  double force = 0.0;            ///< median of the 90th percentile of a finger's force, with contact [N]
  double away = 0.0;             ///< median of carried bodies [m]
  double release = 0.0;          ///< median of held bodies [m/s]
  double frame_time = 0.0;       ///< median [us]
  double frame_time_p99 = 0.0;
  Interval held_interval, carried_interval, held_fair_interval;  ///< grouped by recording
};

Summary summarise(const std::vector<Event>& events);

/// Events of hands with this kind of object.
std::vector<Event> with_object(const std::string& object, const std::vector<Event>& events);

/// Causes of the first motion of lost bodies: the back of the hand, the whole hand, a closing finger, an open
/// hand, or none observed.
struct LossCauses {
  std::array<std::size_t, 4> by_cause{};  ///< by MotionCause
  std::size_t none = 0;
};
LossCauses loss_causes(const std::vector<Event>& events);

/// Each as a line of text.
std::string line(const Event& event);
std::string line(const std::string& name, const std::vector<Event>& events);
std::string line(const std::string& name, const std::vector<WindowOutcome>& outcomes);
std::string line(const LossCauses& lost);

/// real_grasps.csv: a line for each contender, row and kind of object (`all`, or Recording::object).
void write_header(std::ostream& csv);
void write_rows(std::ostream& csv, const Contender& contender, const std::string& row,
                const std::vector<Event>& events);

/// real_grasps_events.csv: a line for each closing.
void write_events_header(std::ostream& csv);
void write_events(std::ostream& csv, const Contender& contender, const std::string& row,
                  const std::vector<Event>& events);

/// How much larger the fraction of frames within 20 mm is than with a rigid hand.
std::string line_against_rigid(const std::vector<WindowOutcome>& outcomes,
                               const std::vector<WindowOutcome>& rigid);

/// Fractions of frames over the leads of windows.
struct LeadSpread {
  std::vector<double> within_50mm, within_20mm;
};
std::string line(const LeadSpread& spread);

/// real_grasps_arctic.csv: a line for each contender, lead and split of the windows (`all`, `person NAME`,
/// `object NAME`).
void write_arctic_header(std::ostream& csv);
void write_arctic(std::ostream& csv, const Contender& contender, const std::string& split,
                  const std::string& lead, const std::vector<WindowOutcome>& outcomes);

}  // namespace mrhi::real_grasps
