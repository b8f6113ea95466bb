// Cost of steps with large islands: CPU time of each, frequency of expensive ones, and error of momentum.
// crowds [NAME [SECONDS]]: scenes with NAME in their names, each for at most SECONDS of CPU time. crowds
// --cut-short: error against cost over the size of an island. crowds --heaps: cost of the most expensive step
// of a heap of dice, over 16 starts. Each scene is played three times with equal results; the lowest time of
// a step counts, as least disturbed by other load.
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "scenes.h"
#include "support/fixtures.h"

namespace mrhi::crowds {
namespace {

/// CPU time of this thread [us], unaffected by other load.
double cpu_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// Total momentum of all bodies.
Vector3 momentum_of(const Simulation& simulation) {
  Vector3 sum = Vector3::Zero();
  for (const BodyState& state : simulation.state().bodies) sum += state.linear_momentum;
  return sum;
}

/// Impulse of gravity and hands in a step. Not defined with fixtures, which absorb momentum.
Vector3 given_from_outside(const Simulation& simulation, double step) {
  const SimulationState& state = simulation.state();
  Vector3 sum = Vector3::Zero();
  for (const Body& body : simulation.scene().bodies) sum += step * body.mass * simulation.scene().gravity;
  for (const Contact& contact : state.contacts) sum += step * contact.force + contact.impulse;
  return sum;
}

bool has_fixtures(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) { return body.fixed; });
}

struct Measured {
  std::vector<double> times;  // of a step, or of a frame if timed as a whole [us]
  double error = 0.0;         // largest error of momentum in one step, without fixtures [N s]
  std::size_t contacts = 0;   // maximum
  double slept = -1.0;        // time at which all slept [s]
};

bool all_asleep(const Simulation& simulation) {
  const auto& bodies = simulation.scene().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b].fixed && !simulation.state().asleep[b]) return false;
  }
  return true;
}

Measured play_once(const Crowd& crowd, double most_seconds) {
  Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
  configuration.contact.sleep = crowd.sleep;
  Simulation simulation(crowd.scene, configuration);
  simulation.advance({testing::at(0.0), crowd.hands(0.0)});
  Measured measured;
  const double begun = cpu_time();
  for (long i = 1; i <= std::lround(crowd.seconds / crowd.frame); ++i) {
    const double t = static_cast<double>(i) * crowd.frame;
    const HandFrame frame{testing::at(t), crowd.hands(t)};
    const Vector3 before = momentum_of(simulation);
    double from = cpu_time();
    simulation.begin(frame);
    if (!crowd.whole_frame) from = cpu_time();
    int steps = 0;
    while (simulation.step()) ++steps;
    if (!crowd.whole_frame) measured.times.push_back((cpu_time() - from) / std::max(1, steps));
    simulation.end();
    if (crowd.whole_frame) {
      measured.times.push_back(cpu_time() - from);
    } else if (!has_fixtures(crowd.scene)) {
      const Vector3 expected = before + given_from_outside(simulation, crowd.frame);
      measured.error = std::max(measured.error, (momentum_of(simulation) - expected).norm());
    }
    measured.contacts = std::max(measured.contacts, simulation.state().body_contacts.size());
    if (!all_asleep(simulation)) {
      measured.slept = -1.0;
    } else if (measured.slept < 0.0) {
      measured.slept = t;
    }
    if (cpu_time() - begun > 1e6 * most_seconds) {
      std::printf("cut short at %.3f s: ", t);
      break;
    }
  }
  return measured;
}

Measured play(const Crowd& crowd, double most_seconds) {
  constexpr int kPlays = 3;
  Measured measured = play_once(crowd, most_seconds / kPlays);
  for (int i = 1; i < kPlays; ++i) {
    const Measured again = play_once(crowd, most_seconds / kPlays);
    measured.times.resize(std::min(measured.times.size(), again.times.size()));
    for (std::size_t step = 0; step < measured.times.size(); ++step)
      measured.times[step] = std::min(measured.times[step], again.times[step]);
  }
  return measured;
}

void print(const Crowd& crowd, Measured measured) {
  std::vector<double>& times = measured.times;
  double sum = 0.0;
  for (const double time : times) sum += time;
  const double first = times.front();
  std::sort(times.begin(), times.end());
  const auto part = [&](double p) {
    return times[static_cast<std::size_t>(p * static_cast<double>(times.size() - 1))];
  };
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const double mean = sum / static_cast<double>(times.size());
  std::printf("%-40s %6zu %6zu %10.1f %10.1f %10.1f %10.1f %8.1f %8.1f %10.1f %9.1e %7.2f %6.0f\n",
              crowd.name.c_str(), crowd.scene.bodies.size(), measured.contacts, mean, part(0.5), part(0.99),
              times.back(), times.back() / part(0.5), times.back() / mean, first, measured.error,
              measured.slept, 1e-3 * static_cast<double>(usage.ru_maxrss));
}

/// Dropped dice, displaced by up to 0.4 mm between starts.
void print_heaps(int dice) {
  constexpr int kStarts = 16;
  double sum = 0.0, worst = 0.0, mean = 0.0;
  for (int start = 0; start < kStarts; ++start) {
    Crowd crowd = dropped(dice, 0.016, "dice");
    for (std::size_t b = 1; b < crowd.scene.bodies.size(); ++b) {
      const auto off = [&](int axis) {
        return 4e-4 * std::sin(100.0 * start + 12.9898 * static_cast<double>(b) + 31.0 * axis);
      };
      if (start > 0) crowd.scene.bodies[b].start.position += Vector3(off(0), off(1), off(2));
    }
    const Measured measured = play(crowd, 60.0);
    const double most = *std::max_element(measured.times.begin(), measured.times.end());
    sum += most / kStarts;
    worst = std::max(worst, most);
    for (const double time : measured.times)
      mean += time / static_cast<double>(kStarts * measured.times.size());
  }
  std::printf(
      "%d heaps of %d dice: mean step %.1f us; dearest step %.0f us in the mean of heaps, %.0f us in the "
      "worst\n",
      kStarts, dice, mean, sum, worst);
}

}  // namespace
}  // namespace mrhi::crowds

int main(int argc, char** argv) {
  using namespace mrhi::crowds;
  if (argc == 2 && std::string(argv[1]) == "--cut-short") {
    print_cut_short();
    return 0;
  }
  if (argc == 2 && std::string(argv[1]) == "--heaps") {
    for (const int dice : {8, 12}) print_heaps(dice);
    return 0;
  }
  std::printf("%-40s %6s %6s %10s %10s %10s %10s %8s %8s %10s %9s %7s %6s\n", "CPU us a step", "bodies",
              "contac", "mean", "median", "p99", "max", "/median", "/mean", "first", "momentum", "asleep",
              "MB");
  for (const Crowd& crowd : all_crowds()) {
    if (argc > 1 && crowd.name.find(argv[1]) == std::string::npos) continue;
    print(crowd, play(crowd, argc > 2 ? std::stod(argv[2]) : 60.0));
    std::fflush(stdout);
  }
  return 0;
}
