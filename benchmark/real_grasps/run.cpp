#include "run.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <iostream>
#include <thread>

#include "report.h"

namespace mrhi::real_grasps {
namespace {

std::vector<Recording> load(const std::vector<std::string>& paths) {
  std::vector<Recording> recordings;
  for (const std::string& file : recording_files(paths)) recordings.push_back(load_recording(file));
  if (recordings.empty() && !paths.empty()) throw std::runtime_error("no recording in the folders given");
  return recordings;
}

/// A table in the output folder, if there is one; engines in other processes write to its end.
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
      events.push_back({recording.name, closing, play(recording, closing, row, disturbance, player)});
    }
  }
}

/// Recordings at the same time; events in the recordings' order.
std::vector<Event> play_row(const std::vector<Recording>& recordings, const Row& row,
                            const Arguments& arguments, unsigned jobs, const Player& player) {
  std::vector<std::vector<Event>> found(recordings.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i; (i = next++) < recordings.size();)
      play_recording(recordings[i], row, arguments, player, found[i]);
  };
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < jobs; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
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
    if (arguments.list) std::cout << line(lost_to(events)) << std::endl;
    write_rows(rows, contender, row.name, events);
    write_events(closings, contender, row.name, events);
  }
}

/// Outcomes of windows, in the groups that are told of.
struct Groups {
  std::vector<WindowOutcome> first, tuned, held_out, all;

  void add(const Window& window, const WindowOutcome& outcome) {
    all.push_back(outcome);
    if (window.first) first.push_back(outcome);
    (half_of(capture_of(window.name)) == Half::tuned ? tuned : held_out).push_back(outcome);
  }
  void tell(const std::string& name, std::ostream& csv, const Contender& contender) const {
    const std::pair<const char*, const std::vector<WindowOutcome>*> groups[] = {
        {"_first", &first}, {"_tuned", &tuned}, {"_held_out", &held_out}, {"", &all}};
    for (const auto& [group, outcomes] : groups) {
      if (outcomes->empty()) continue;
      std::cout << line(name + group, *outcomes) << std::endl;
      write_arctic(csv, contender, name + group, *outcomes);
    }
  }
};

void play_windows(const Arguments& arguments, const Contender& contender) {
  if (arguments.arctic.empty()) return;
  if (arguments.paths.empty()) std::cout << contender.engine << ", " << contender.setting << std::endl;
  std::ofstream csv = table(arguments, "real_grasps_arctic.csv");
  Groups groups;
  for (const Window& window : load_windows(arguments.arctic, contender.configuration)) {
    groups.add(window, play(window, contender.configuration, arguments.lead));
    if (arguments.list) std::cout << line(window.name, {groups.all.back()}) << '\n';
  }
  groups.tell("arctic", csv, contender);
}

/// What no model has a part in: how far the captured hands, each as one piece, have the object with them.
void play_windows_rigidly(const Arguments& arguments) {
  if (arguments.arctic.empty()) return;
  const Contender hand{"none", "rigid hand", arguments.configuration, {}};
  std::ofstream csv = table(arguments, "real_grasps_arctic.csv");
  Groups groups;
  for (const Window& window : load_windows(arguments.arctic, arguments.configuration))
    groups.add(window, play_rigidly(window));
  groups.tell("rigid", csv, hand);
}

/// Other engines play free bodies alone.
Arguments free_rows(Arguments arguments) {
  auto& rows = arguments.rows;
  rows.erase(std::remove_if(rows.begin(), rows.end(), [](const Row& row) { return row.rests; }), rows.end());
  return arguments;
}

/// In a process of its own: engines that cannot share one need not, and what crashes there fails there.
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

}  // namespace

void run(const Arguments& arguments) {
  const std::vector<Recording> recordings = load(arguments.paths);
  begin_table(arguments, "real_grasps.csv", write_header);
  begin_table(arguments, "real_grasps_events.csv", write_events_header);
  if (!arguments.arctic.empty()) begin_table(arguments, "real_grasps_arctic.csv", write_arctic_header);
  const std::vector<Contender> contenders = arguments.compare
                                                ? our_settings(arguments.configuration)
                                                : std::vector<Contender>{ours(arguments.configuration)};
  for (const Contender& contender : contenders) {
    play_closings(recordings, arguments, arguments.jobs, contender);
    play_windows(arguments, contender);
  }
  play_windows_rigidly(arguments);
  for (const std::string& module : arguments.engines) play_engine(recordings, arguments, module);
}

}  // namespace mrhi::real_grasps
