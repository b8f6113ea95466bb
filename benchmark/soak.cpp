// Runs recordings and scripted motions through the core, one after the other, for hours of simulated time.
// Reports memory, open files and step cost at the end of each hour, and the drift of a free body.
// scripts/soak.
#include <dirent.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "record/duration_histogram.h"
#include "support/random_way.h"
#include "support/recorded_frames.h"

namespace mrhi::benchmark {
namespace {

constexpr double kHour = 3600.0;            // [s]
constexpr Nanoseconds kBreak = 50'000'000;  // between two recordings

/// Largest growth after the first hour. The step's cost varies with other load of the machine.
constexpr double kMaxMemory = 1.02, kMaxTime = 1.5;
/// Largest relative drift of a body in free flight. Rotation is exact to rounding, which accumulates.
constexpr double kMaxDrift = 1e-9;

double resident_megabytes() {
  std::ifstream pages("/proc/self/statm");
  double all = 0.0, resident = 0.0;
  pages >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1048576.0;
}

int open_files() {
  DIR* folder = opendir("/proc/self/fd");
  int count = 0;
  while (readdir(folder) != nullptr) ++count;
  closedir(folder);
  return count;
}

/// A spinning body far from all others.
Body spinner() {
  Body body = testing::box_body(Vector3(0.2, 0.1, 0.05), 0.5);
  body.name = "spinner";
  body.start.position = Vector3(0.0, 0.0, 9.0);
  body.start_twist.angular = Vector3(0.2, 3.0, 0.1);
  complete(body);
  return body;
}

struct Take {
  std::string name;
  std::vector<HandFrame> frames;
};

std::vector<Take> takes() {
  std::vector<Take> all;
  for (const std::string& file : testing::recordings()) all.push_back({file, testing::recorded_frames(file)});
  for (const std::string& motion : motion_names()) {
    SyntheticHandOptions options;
    options.motion = motion;
    Take take{motion, {}};
    for (const JointsFrame& joints : record_motion(options)) {
      HandFrame frame{joints.stamp, {}};
      for (const HandJoints& hand : joints.hands)
        frame.hands.push_back(complete_hand(hand, default_device_mount()));
      take.frames.push_back(std::move(frame));
    }
    all.push_back(std::move(take));
  }
  return all;
}

/// One simulation of all takes in turn; the bodies of each are at their start when it begins.
class Soak {
 public:
  explicit Soak(const Take& first) : simulation_(scene(first), Configuration()) {}

  void play(const Take& take) {
    const Nanoseconds offset = time_ + kBreak - take.frames.front().stamp;
    for (HandFrame frame : take.frames) {
      frame.stamp += offset;
      if (simulation_.begin(frame) != Rejection::none) continue;
      while (timed_step()) {
      }
      simulation_.end();
      time_ = frame.stamp;
      ++frames;
    }
  }

  double seconds() const { return to_seconds(time_); }
  DurationHistogram steps;
  long frames = 0;

  /// Relative change of the spinner's energy and angular momentum.
  double drift() const {
    const std::size_t last = simulation_.scene().bodies.size() - 1;
    const Body& body = simulation_.scene().bodies[last];
    const BodyState start = start_state(body), &now = simulation_.state().bodies[last];
    const double energy = kinetic_energy(body, now) / kinetic_energy(body, start) - 1.0;
    const double momentum =
        (now.angular_momentum - start.angular_momentum).norm() / start.angular_momentum.norm();
    return std::max(std::abs(energy), momentum);
  }

 private:
  static Scene scene(const Take& take) {
    Scene scene = testing::scene_at_random(take.frames, 0);
    scene.bodies.push_back(spinner());
    return scene;
  }
  bool timed_step() {
    timespec before{}, after{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &before);
    if (!simulation_.step()) return false;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &after);
    steps.add((after.tv_sec - before.tv_sec) * 1'000'000'000 + after.tv_nsec - before.tv_nsec);
    return true;
  }

  Simulation simulation_;
  Nanoseconds time_ = 0;
};

struct Hour {
  double megabytes, p99;
  int files;
};

int run(double hours) {
  const std::vector<Take> all = takes();
  Soak soak(all.front());
  std::vector<Hour> seen;
  std::printf("%6s %10s %8s %6s %10s %10s %10s\n", "hour", "frames", "MiB", "files", "p50/us", "p99/us",
              "drift");
  for (std::size_t i = 0; soak.seconds() < hours * kHour; ++i) {
    soak.play(all[i % all.size()]);
    if (soak.seconds() < static_cast<double>(seen.size() + 1) * kHour) continue;
    seen.push_back({resident_megabytes(), soak.steps.quantile_us(0.99), open_files()});
    std::printf("%6zu %10ld %8.2f %6d %10.2f %10.2f %10.1e\n", seen.size(), soak.frames,
                seen.back().megabytes, seen.back().files, soak.steps.quantile_us(0.5), seen.back().p99,
                soak.drift());
    std::fflush(stdout);
    soak.steps.clear();
  }
  bool flat = soak.drift() < kMaxDrift;
  for (const Hour& hour : seen)
    flat = flat && hour.megabytes < kMaxMemory * seen[0].megabytes && hour.files == seen[0].files &&
           hour.p99 < kMaxTime * seen[0].p99;
  std::puts(flat ? "flat" : "NOT FLAT");
  return flat ? 0 : 1;
}

}  // namespace
}  // namespace mrhi::benchmark

int main(int argc, char** argv) {
  const double hours = argc > 1 ? std::atof(argv[1]) : 24.0;
  try {
    return mrhi::benchmark::run(hours);
  } catch (const std::exception& error) {
    std::cerr << "soak: " << error.what() << '\n';
    return 2;
  }
}
