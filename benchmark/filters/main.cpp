// Jitter against lag of every filter and setting, over real recordings with and without added noise, and the
// motion of a cube held by a noisy hand; lag of a hand that sets off. See docs/pipeline.md.

#include <fstream>
#include <iostream>
#include <string>

#include "nodes/exit_status.h"
#include "scores.h"
#include "settings.h"
#include "support/recordings.h"
#include "text/files.h"

namespace mrhi::filter_benchmark {
namespace {

constexpr double kBetweenRates = 80.0;  // frames per second; the recordings have 38 to 60, or 99 to 116

/// Takes of one rate, recorded or with noise added.
struct Group {
  std::string input, rate;
  std::vector<Take> takes;
};

std::vector<Group> load_groups(const std::vector<std::string>& files) {
  std::vector<Group> groups;
  for (const bool with_noise : {false, true}) {
    const std::string input = with_noise ? "noise added" : "as recorded";
    Group fast{input, "99 to 116", {}}, slow{input, "38 to 60", {}};
    for (Take& take : load_takes(files, with_noise))
      (take.frame_rate() > kBetweenRates ? fast : slow).takes.push_back(std::move(take));
    for (Group* group : {&fast, &slow})
      if (!group->takes.empty()) groups.push_back(std::move(*group));
  }
  return groups;
}

constexpr double kMilli = 1e3;

CsvRows& named(const Setting& setting, CsvRows& row) {
  return row << setting.filter << setting.series << setting.setting << setting.is_default;
}

void write_recordings(const std::vector<std::string>& files, std::ostream& csv) {
  csv << "input,frames_per_s,filter,series,setting,default,jitter_mm,lag_ms,lag_p90_ms,moving_error_mm,"
         "still_error_mm,moving_jitter_mm,bone_error_mm,moves\n";
  CsvRows row(csv);
  for (const Group& group : load_groups(files)) {
    for (const Setting& setting : settings()) {
      const Scores scores = score(group.takes, setting.configuration);
      named(setting, row << group.input << group.rate);
      for (const double value : {scores.jitter, scores.lag, scores.lag_p90, scores.moving_error,
                                 scores.still_error, scores.moving_jitter, scores.bone_error})
        row << kMilli * value;
      (row << scores.moves).end_row();
    }
  }
}

void write_rides(std::ostream& csv) {
  csv << "filter,series,setting,default,true_slip_mm,displacement_mm,jitter_mm,gain\n";
  CsvRows row(csv);
  for (const Setting& setting : settings()) {
    const Ride held = ride(setting.configuration);
    named(setting, row) << kMilli * held.true_slip << kMilli * held.displacement << kMilli * held.jitter
                        << gain_of_a_shake(setting.configuration);
    row.end_row();
  }
}

void write_starts(std::ostream& csv) {
  csv << "filter,frames_per_s,noise_mm,lag_mm,rest_mm\n";
  CsvRows row(csv);
  for (const char* filter : {"none", "one_euro", "constant_velocity"}) {
    FilterConfiguration configuration;
    configuration.type.name = filter;
    for (const double rate : {30.0, 60.0, 90.0, 120.0}) {
      for (const double noise : {0.0003, 0.001, 0.0012, 0.0015, 0.002, 0.003, 0.005}) {
        const Start start = start_of_a_reach(configuration, noise, rate);
        (row << filter << rate << kMilli * noise << kMilli * start.lag << kMilli * start.rest).end_row();
      }
    }
  }
}

/// Returns false if the file cannot be written.
template <typename Write>
bool write_file(const std::string& path, Write write) {
  std::ofstream csv(path);
  csv.precision(6);
  if (csv) write(csv);
  csv.close();
  if (!csv) std::cerr << "filters: cannot write " << path << '\n';
  return static_cast<bool>(csv);
}

int run(const std::string& folder, std::vector<std::string> files) {
  if (files.empty()) files = testing::recordings();
  if (files.empty()) {
    std::cerr << "filters: no recordings in " << testing::recordings_folder()
              << "; name CSV files of hands, or set MR_HAND_RECORDINGS to their folder\n";
    return 1;
  }
  const bool written =
      write_file(folder + "/filters.csv", [&](std::ostream& csv) { write_recordings(files, csv); }) &&
      write_file(folder + "/filters_held.csv", [](std::ostream& csv) { write_rides(csv); }) &&
      write_file(folder + "/filters_start.csv", [](std::ostream& csv) { write_starts(csv); });
  return written ? 0 : 1;
}

}  // namespace
}  // namespace mrhi::filter_benchmark

int main(int argc, char** argv) {
  if (argc < 3 || std::string(argv[1]) != "--output") {
    std::cerr << "usage: filters --output DIR [RECORDING.csv]...\n"
                 "Without recordings, those in the folder MR_HAND_RECORDINGS.\n";
    return 2;
  }
  return mrhi::exit_status("filters", [&] {
    return mrhi::filter_benchmark::run(argv[2], {argv + 3, argv + argc});
  });
}
