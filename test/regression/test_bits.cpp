#include <gnu/libc-version.h>
#include <gtest/gtest.h>

#include <cinttypes>
#include <cstdlib>
#include <map>

#include "mr_hand_interaction/replay/replay.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "replay/replay_files.h"

namespace mrhi {
namespace {

/// The oracle of a restructuring: bits of replays, one line each, as they were when somebody last looked at
/// what had changed them. `MR_HAND_WRITE_BITS=1 scripts/test regression` writes it anew.
const char* const kTable = "test/regression/bits.csv";

/// A scripted motion with a Leap's noise at a tracker's rate, in a scene that is shipped.
struct NoisyReplay {
  std::string motion, scene, model, gravity;
  int rate;           // [1/s]
  bool both = false;  // a left hand does the same, mirrored

  std::string name() const {
    return motion + "," + scene + "," + model + "," + gravity + "," + std::to_string(rate) + "," +
           (both ? "2" : "1");
  }
};

std::vector<NoisyReplay> runs() {
  std::vector<NoisyReplay> all;
  for (const std::string& motion : motion_names()) {
    for (const char* gravity : {"0", "-9.81"})
      all.push_back({motion, make_motion(motion).scene, "implicit", gravity, 90});
  }
  for (const ContactModelEntry* model : contact_models()) {
    if (model->name == std::string("implicit")) continue;
    for (const char* motion : {"grasp_cube", "slap", "turn_valve"})
      all.push_back({motion, make_motion(motion).scene, model->name, "0", 90});
  }
  for (const char* scene : {"mixed", "cube_on_table", "rack"})
    all.push_back({"grasp_cube", scene, "implicit", "0", 60});
  for (const int rate : {30, 60, 120}) all.push_back({"grasp_cube", "cube", "implicit", "0", rate});
  for (const char* motion : {"grasp_cube", "grasp_ball", "nudge"})
    all.push_back({motion, make_motion(motion).scene, "implicit", "0", 120, true});
  return all;
}

/// What bits depend on beside the code: roots and logarithms are the C library's, and those of a processor
/// with fused multiplication may differ in the last bit.
std::string platform() {
#if defined(__x86_64__)
  const char* processor = __builtin_cpu_supports("fma") ? "x86_64 with fma" : "x86_64";
#else
  const char* processor = "another processor";
#endif
  return "g++ " + std::to_string(__GNUC__) + "; glibc " + gnu_get_libc_version() + "; Eigen " +
         std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "; " + processor;
}

std::string bits_of(const NoisyReplay& run) {
  const test::TemporaryFolder folder;
  std::vector<JointsFrame> frames = test::motion_frames(run.motion, run.rate, 0);
  const ScriptedMotion motion = make_motion(run.motion);
  for (JointsFrame& frame : frames) {
    if (!run.both) break;
    for (HandJoints hand : sample(motion, Side::left, frame.stamp, default_device_mount()).hands) {
      hand.id += 1000;
      frame.hands.push_back(hand);
    }
  }
  TrackingNoise noise(1.0, 1);
  for (JointsFrame& frame : frames) noise.apply(frame);
  ReplayArguments arguments;
  arguments.scene = "config/scenes/" + run.scene + ".urdf";
  arguments.input = test::write_recording(folder / "recording.csv", frames);
  arguments.output = folder / "out";
  arguments.settings = {{"contact_model", run.model}, {"gravity", "[0, 0, " + run.gravity + "]"}};
  replay(arguments);
  std::uint64_t state = 0;
  for (const std::string& line : test::lines_of(folder / "out/summary.json")) {
    const auto at = line.find("\"state_hash\": \"");
    if (at != std::string::npos) state = std::strtoull(line.c_str() + at + 15, nullptr, 16);
  }
  std::string tables;
  for (const char* table : {"objects", "contacts", "hands", "events", "joints"})
    tables += test::text_of(folder / (std::string("out/") + table + ".csv"));
  char text[64];
  std::snprintf(text, sizeof text, "%016" PRIx64 ",%016zx", state, std::hash<std::string>()(tables));
  return text;
}

TEST(Bits, of_replays_are_those_that_were_reviewed) {
  std::map<std::string, std::string> reviewed;
  const std::vector<std::string> lines = test::lines_of(kTable);
  const bool write = std::getenv("MR_HAND_WRITE_BITS") != nullptr;
  ASSERT_TRUE(write || lines.size() > 2) << kTable << " has no lines";
  if (!write && lines[0] != "# " + platform())
    GTEST_SKIP() << kTable << " was made with " << lines[0].substr(2) << "; this is " << platform();
  for (const std::string& line : lines) {
    const std::size_t name = line.rfind(',', line.rfind(',') - 1);
    if (line[0] != '#') reviewed[line.substr(0, name)] = line.substr(name + 1);
  }
  std::string table = "# " + platform() + "\nmotion,scene,model,gravity,rate,hands,state,tables\n", changed;
  int count = 0;
  for (const NoisyReplay& run : runs()) {
    const std::string bits = bits_of(run);
    table += run.name() + "," + bits + "\n";
    if (reviewed[run.name()] == bits) continue;
    changed += "\n  " + run.name();
    ++count;
  }
  if (write) std::ofstream(kTable) << table;
  EXPECT_TRUE(write || count == 0)
      << count << " of " << runs().size() << " replays have other bits than " << kTable << ":" << changed
      << "\nIf that is meant, MR_HAND_WRITE_BITS=1 scripts/test regression writes the table anew; say in the "
         "commit which figures moved.";
}

}  // namespace
}  // namespace mrhi
