// Bodies are placed where recorded hands close: how many are held until the hand opens? See
// docs/real_grasps.md.

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <iostream>
#include <thread>

#include "mr_hand_interaction/parameters.h"
#include "nodes/exit_status.h"
#include "report.h"
#include "text/command_line.h"
#include "text/text.h"

namespace mrhi::real_grasps {
namespace {

constexpr const char* kUsage = R"(usage: real_grasps [OPTION]... [--arctic DIR] FOLDER...
Puts bodies at rest (0 g) where recorded hands close and tells how many are held until the hand opens.
  FOLDER            recordings in the CSV schema, or single files
  --set KEY=VALUE   a parameter, as replay's; repeatable
  --only ROW,...    pinch20, pinch30, pinch40, grab_sphere60, grab_sphere80, grab_cube60, grab_cube80; at 1 g on a
                    column: rest_sphere60, rest_sphere100, rest_cube60, rest_cube100; hands that stay open round it,
                    of which none is to be held: pass_sphere40, pass_cube40, pass_sphere60, pass_cube60
  --list            one line for each closing
  --noise RMS_MM    white noise on each joint and axis; 0 if not said
  --rate HZ         frames evenly spaced at this rate; as recorded if not said; not with --arctic, whose objects were
                    captured frame by frame
  --seeds N         each closing and window is played N times with other noise; 1 if not said
  --compare         our models in several stiffnesses
  --engine FILE     a physics engine too: its module, .../speed_accuracy_NAME.so; repeatable
  --output DIR      writes real_grasps.csv, real_grasps_events.csv (a line for each closing) and, with --arctic,
                    real_grasps_arctic.csv
  --arctic DIR      plays the windows that import_captures cut into DIR: captured hands on captured objects;
                    together, by person and by object, with intervals by capture
  --lead LEAD,...   for how long such an object is led before it is let free: seconds (0: hands appear on it), or
                    clear: since no hand touched it; 0.3,1,clear if not said
  --jobs N          recordings or windows at the same time; 1 if not said
docs/real_grasps.md says what the figures mean.
)";

struct Arguments {
  Configuration configuration;
  std::vector<Row> rows = all_rows();
  bool list = false;
  std::string output;  ///< folder, or empty
  unsigned jobs = 1;
  Disturbance disturbance;
  unsigned seeds = 1;                                   ///< runs of each closing, with different noise
  bool compare = false;                                 ///< our models in several settings
  std::vector<std::string> engines;                     ///< modules of physics engines
  std::string arctic;                                   ///< folder of windows, or empty
  std::vector<std::string> leads{"0.3", "1", "clear"};  ///< before windows: seconds, or clear
  std::vector<std::string> paths;                       ///< recordings, or folders with recordings
};

std::vector<Row> rows_of(const OptionValue& given) {
  const std::vector<Row> all = all_rows();
  std::vector<Row> rows;
  for (const std::string& name : text::split(given.text)) {
    const Row* row = text::find_named(all, name);
    if (row == nullptr) given.refuse(text::joined(text::names_of(all)));
    rows.push_back(*row);
  }
  return rows;
}

/// Seconds of a lead; empty for `clear`.
std::optional<double> seconds_of(const std::string& lead) {
  if (lead == "clear") return std::nullopt;
  return OptionValue{"--lead", "LEAD,...", lead}.number(0.0, 10.0);
}

std::vector<std::string> leads_of(const OptionValue& given) {
  const std::vector<std::string> leads = text::split(given.text);
  if (leads.empty()) given.refuse("seconds or 'clear', separated by commas");
  for (const std::string& lead : leads) seconds_of(lead);
  return leads;
}

/// Empty for --help. Throws UsageError.
std::optional<Arguments> read_arguments(const std::vector<std::string>& words) {
  Arguments a;
  CommandLine line;
  line.flag("--list", a.list).flag("--compare", a.compare);
  line.once("--output", "DIR", a.output).once("--arctic", "DIR", a.arctic);
  line.once("--only", "ROW,...", [&](const OptionValue& given) { a.rows = rows_of(given); });
  line.once("--lead", "LEAD,...", [&](const OptionValue& given) { a.leads = leads_of(given); });
  line.once("--noise", "RMS_MM",
            [&](const OptionValue& given) { a.disturbance.noise = 1e-3 * given.number(0.0, 50.0); });
  line.once("--rate", "HZ",
            [&](const OptionValue& given) { a.disturbance.rate = given.number(5.0, 1000.0); });
  line.once("--seeds", "N",
            [&](const OptionValue& given) { a.seeds = static_cast<unsigned>(given.whole(1, 1000)); });
  line.once("--jobs", "N",
            [&](const OptionValue& given) { a.jobs = static_cast<unsigned>(given.whole(1, 64)); });
  line.each("--engine", "FILE", [&](const OptionValue& given) { a.engines.push_back(given.text); });
  line.each("--set", "KEY=VALUE", [&](const OptionValue& given) {
    const auto [key, value] = given.setting();
    rethrown<UsageError, ParameterError>("",
                                         [&, k = key, v = value] { set_parameter(a.configuration, k, v); });
  });
  line.words([&](const OptionValue& given) { a.paths.push_back(given.text); });
  if (!line.read(words)) return std::nullopt;
  rethrown<UsageError, ParameterError>("", [&] { validate(a.configuration); });
  if (a.paths.empty() && a.arctic.empty())
    throw UsageError("a folder of recordings or --arctic is needed; see --help");
  if (a.disturbance.rate && !a.arctic.empty())
    throw UsageError(
        "--rate is not allowed with --arctic, whose objects were captured frame by frame; allowed: "
        "--noise and --seeds");
  return a;
}

std::vector<Recording> load(const std::vector<std::string>& paths) {
  std::vector<Recording> recordings;
  for (const std::string& file : recording_files(paths)) recordings.push_back(load_recording(file));
  if (recordings.empty() && !paths.empty()) throw std::runtime_error("no recording in the folders given");
  return recordings;
}

/// A table in the output folder, if there is one; processes of engines append to it.
std::ofstream table(const Arguments& arguments, const std::string& name) {
  std::ofstream csv;
  if (arguments.output.empty()) return csv;
  csv.open(arguments.output + "/" + name, std::ios::app);
  if (!csv) throw std::runtime_error("cannot write " + arguments.output + "/" + name);
  return csv;
}

void begin_table(const Arguments& arguments, const std::string& name, void (*header)(std::ostream&)) {
  if (arguments.output.empty()) return;
  std::ofstream csv(arguments.output + "/" + name);
  if (!csv) throw std::runtime_error("cannot write " + arguments.output + "/" + name);
  header(csv);
}

void play_recording(const Recording& recording, const Row& row, const Arguments& arguments,
                    const Player& player, std::vector<Event>& events) {
  for (const Closing& closing : closings(recording, row)) {
    for (unsigned seed = 1; seed <= arguments.seeds; ++seed) {
      Disturbance disturbance = arguments.disturbance;
      disturbance.seed = seed;
      events.push_back(
          {recording.name, closing, play(recording, closing, row, disturbance, player), recording.object});
    }
  }
}

/// Calls `work` with each index below `count`, in `jobs` threads.
template <typename Work>
void for_each(std::size_t count, unsigned jobs, Work work) {
  std::atomic<std::size_t> next{0};
  const auto some = [&] {
    for (std::size_t i; (i = next++) < count;) work(i);
  };
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < jobs; ++i) threads.emplace_back(some);
  some();
  for (std::thread& thread : threads) thread.join();
}

/// Plays recordings concurrently; returns events in the recordings' order.
std::vector<Event> play_row(const std::vector<Recording>& recordings, const Row& row,
                            const Arguments& arguments, unsigned jobs, const Player& player) {
  std::vector<std::vector<Event>> found(recordings.size());
  for_each(recordings.size(), jobs,
           [&](std::size_t i) { play_recording(recordings[i], row, arguments, player, found[i]); });
  std::vector<Event> events;
  for (auto& of_one : found) events.insert(events.end(), of_one.begin(), of_one.end());
  return events;
}

void play_closings(const std::vector<Recording>& recordings, const Arguments& arguments, unsigned jobs,
                   const Contender& contender) {
  if (recordings.empty()) return;
  std::cout << contender.engine << ", " << contender.setting << std::endl;
  std::ofstream rows = table(arguments, "real_grasps.csv"),
                closings = table(arguments, "real_grasps_events.csv");
  for (const Row& row : arguments.rows) {
    const std::vector<Event> events = play_row(recordings, row, arguments, jobs, contender.player);
    if (arguments.list)
      for (const Event& event : events) std::cout << line(event) << '\n';
    std::cout << line(row.name, events) << std::endl;
    for (const char* object : kObjects) {
      const std::vector<Event> some = with_object(object, events);
      if (!some.empty()) std::cout << line("  object " + std::string(object), some) << std::endl;
    }
    if (arguments.list) std::cout << line(loss_causes(events)) << std::endl;
    write_rows(rows, contender, row.name, events);
    write_events(closings, contender, row.name, events);
  }
}

/// Reports windows together, and by person and by object where there are several.
void report_windows(const std::string& name, const std::string& lead,
                    const std::vector<WindowOutcome>& outcomes, const Contender& contender,
                    std::ostream& csv) {
  std::cout << line(name + (lead.empty() ? "" : " lead " + lead), outcomes) << std::endl;
  write_arctic(csv, contender, "all", lead, outcomes);
  for (const auto& [kind, label] :
       {std::make_pair("person ", &WindowLabels::person), std::make_pair("object ", &WindowLabels::object)}) {
    const auto groups = by_label(outcomes, label);
    if (groups.size() < 2) continue;
    for (const auto& [value, some] : groups) {
      std::cout << line("  " + (kind + value), some) << std::endl;
      write_arctic(csv, contender, kind + value, lead, some);
    }
  }
}

/// The outcomes of each window, one for each seed.
std::vector<WindowOutcome> play_lead(const std::vector<Window>& windows, const Arguments& arguments,
                                     const Configuration& configuration, const std::string& lead) {
  std::vector<WindowOutcome> outcomes(windows.size() * arguments.seeds);
  for_each(outcomes.size(), arguments.jobs, [&](std::size_t i) {
    Window window = windows[i / arguments.seeds];
    const auto seed = static_cast<unsigned>(i % arguments.seeds + 1);
    window.frames =
        disturbed(window.frames, 0, window.frames.size() - 1, {arguments.disturbance.noise, {}, seed});
    outcomes[i] = play(window, configuration, seconds_of(lead));
  });
  return outcomes;
}

void play_windows(const Arguments& arguments, const Contender& contender,
                  const std::vector<WindowOutcome>& rigid) {
  if (arguments.arctic.empty()) return;
  if (arguments.paths.empty()) std::cout << contender.engine << ", " << contender.setting << std::endl;
  std::ofstream csv = table(arguments, "real_grasps_arctic.csv");
  const std::vector<Window> windows = load_windows(arguments.arctic, contender.configuration);
  LeadSpread spread;
  for (const std::string& lead : arguments.leads) {
    const std::vector<WindowOutcome> outcomes = play_lead(windows, arguments, contender.configuration, lead);
    if (arguments.list)
      for (std::size_t i = 0; i < outcomes.size(); ++i)
        std::cout << line(windows[i / arguments.seeds].name, {outcomes[i]}) << '\n';
    report_windows("windows", lead, outcomes, contender, csv);
    std::cout << line_against_rigid(outcomes, rigid) << std::endl;
    spread.within_50mm.push_back(fraction_within(outcomes, 0.05));
    spread.within_20mm.push_back(fraction_within(outcomes, 0.02));
  }
  std::cout << line(spread) << std::endl;
}

/// Rigid baseline without a contact model: the captured hands carry the object as one piece.
std::vector<WindowOutcome> play_windows_rigidly(const Arguments& arguments) {
  std::vector<WindowOutcome> outcomes;
  if (arguments.arctic.empty()) return outcomes;
  const Contender hand{"none", "rigid hand", arguments.configuration, {}};
  std::ofstream csv = table(arguments, "real_grasps_arctic.csv");
  for (const Window& window : load_windows(arguments.arctic, arguments.configuration))
    outcomes.push_back(play_rigidly(window));
  report_windows("rigid", "", outcomes, hand, csv);
  return outcomes;
}

/// Only rows of free bodies, for other engines.
Arguments free_rows(Arguments arguments) {
  auto& rows = arguments.rows;
  rows.erase(std::remove_if(rows.begin(), rows.end(), [](const Row& row) { return row.rests; }), rows.end());
  return arguments;
}

/// Plays in a separate process: engines need not share one, and a crash affects only that engine.
void play_engine(const std::vector<Recording>& recordings, const Arguments& arguments,
                 const std::string& module) {
  std::cout << std::flush;
  const pid_t child = fork();
  if (child == 0) {
    try {
      for (const Contender& contender : peer_settings(module, arguments.configuration))
        play_closings(recordings, free_rows(arguments), 1, contender);
    } catch (const std::exception& error) {
      std::cerr << "real_grasps: " << error.what() << std::endl;
      _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || status != 0)
    std::cerr << "real_grasps: " << engine_name(module) << " did not come to its end\n";
}

/// Plays, prints and writes tables by the arguments. Throws std::exception with one line.
int run(const std::optional<Arguments>& read) {
  if (!read) {
    std::cout << kUsage;
    return 0;
  }
  const Arguments& arguments = *read;
  const std::vector<Recording> recordings = load(arguments.paths);
  begin_table(arguments, "real_grasps.csv", write_header);
  begin_table(arguments, "real_grasps_events.csv", write_events_header);
  if (!arguments.arctic.empty()) begin_table(arguments, "real_grasps_arctic.csv", write_arctic_header);
  const std::vector<Contender> contenders = arguments.compare
                                                ? our_settings(arguments.configuration)
                                                : std::vector<Contender>{ours(arguments.configuration)};
  const std::vector<WindowOutcome> rigid = play_windows_rigidly(arguments);
  for (const Contender& contender : contenders) {
    play_closings(recordings, arguments, arguments.jobs, contender);
    play_windows(arguments, contender, rigid);
  }
  for (const std::string& module : arguments.engines) play_engine(recordings, arguments, module);
  return 0;
}

}  // namespace
}  // namespace mrhi::real_grasps

int main(int argc, char** argv) {
  using namespace mrhi::real_grasps;
  return mrhi::exit_status("real_grasps", [&] { return run(read_arguments({argv + 1, argv + argc})); });
}
