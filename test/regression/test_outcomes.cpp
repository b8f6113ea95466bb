// What becomes of files in which one word is another: what is loaded, or the line that refuses it.
#include <filesystem>
#include <regex>
#include <sstream>

#include "mr_hand_interaction/replay/recording_csv.h"
#include "mr_hand_interaction/scene/save_scene.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/training/session.h"
#include "parts.h"
#include "training/trials.h"

namespace mrhi {
namespace {

/// The text with one of its numbers or words replaced, each by two of what stands there for it, in turn.
std::vector<std::string> spoiled(const std::string& text) {
  static const std::regex word(R"([-+]?[0-9]+(\.[0-9]*)?(e[-+]?[0-9]+)?|[A-Za-z_]+)");
  std::vector<std::string> all;
  int turn = 0;
  for (std::sregex_iterator at(text.begin(), text.end(), word), end; at != end; ++at) {
    const std::string was = at->str(), before = at->prefix(), after = at->suffix();
    const bool is_number = std::isalpha(static_cast<unsigned char>(was[0])) == 0 && was[0] != '_';
    const std::string whole_before = text.substr(0, static_cast<std::size_t>(at->position()));
    for (int i = 0; i < 2; ++i, ++turn) {
      const std::string numbers[] = {"0", "-" + was, "1e6", "0.5", "word", ""},
                        words[] = {"", was + was, "7", "box"};
      all.push_back(whole_before + (is_number ? numbers[turn % 6] : words[turn % 4]) + after);
    }
  }
  return all;
}

/// Bits of outcomes: of all refusals, and of all that was taken.
class Outcomes {
 public:
  explicit Outcomes(const test::Folder& folder) : folder_(folder) {}
  /// `taken`: text of what is made of a file.
  template <typename Taken>
  void add(const Taken& taken) {
    try {
      note(taken(), taken_);
    } catch (const std::exception& error) {
      note(error.what(), refused_);
    }
  }
  std::string bits() const {
    return test::hexadecimal(refused_.value) + "," + test::hexadecimal(taken_.value);
  }

 private:
  /// The folder has another name each time.
  void note(std::string text, Fnv1a& hash) const {
    for (std::size_t at; (at = text.find(folder_.path())) != std::string::npos;)
      text.erase(at, folder_.path().size());
    hash.add(text.data(), text.size() + 1);
  }
  const test::Folder& folder_;
  Fnv1a refused_, taken_;
};

std::string bits_of_scene(const std::string& name) {
  const test::Folder folder;
  Outcomes outcomes(folder);
  const auto load = [&] {
    const Scene scene = load_scene(folder / "scene.urdf", {});
    std::filesystem::remove(folder / "saved.yaml");
    save_scene(scene, folder / "saved.urdf");
    std::string text = test::text_of(folder / "saved.urdf") + test::text_of(folder / "saved.yaml");
    for (const std::string& warning : scene.warnings) text += warning + "\n";
    return text;
  };
  const std::string file = "config/scenes/" + name;
  const std::string urdf = test::text_of(file + ".urdf"), yaml = test::text_of(file + ".yaml");
  folder.write("scene.yaml", yaml);
  for (const std::string& text : spoiled(urdf)) folder.write("scene.urdf", text), outcomes.add(load);
  folder.write("scene.urdf", urdf);
  for (const std::string& text : spoiled(yaml)) folder.write("scene.yaml", text), outcomes.add(load);
  return outcomes.bits();
}

std::string bits_of_task(const std::string& name) {
  const test::Folder folder;
  Outcomes outcomes(folder);
  for (const std::string& text : spoiled(test::text_of("config/tasks/" + name + ".yaml"))) {
    folder.write("task.yaml", text);
    outcomes.add([&] {
      const Task task = load_task(folder / "task.yaml");
      std::ostringstream all;
      all.precision(17);
      all << task.name << task.instructions << task.gravity.transpose() << task.scene << task.latin_square
          << task.repetitions << task.practice << task.time_out;
      for (const auto* things : {&task.objects, &task.fixtures})
        for (const TaskObject& thing : *things)
          all << thing.name << thing.file << thing.start.position.transpose()
              << thing.start.orientation.coeffs().transpose() << thing.twist.linear.transpose();
      for (std::size_t i = 0; i < task.goals.size(); ++i) {
        const Goal& goal = task.goals[i];
        all << instruction(task, i, "thing") << to_string(goal.kind) << goal.position.transpose()
            << goal.orientation.coeffs().transpose() << goal.tolerance << ' '
            << goal.angle_tolerance.value_or(-1.0) << goal.axis.value_or(Vector3::Zero()).transpose()
            << goal.size.transpose() << goal.hold << ' ' << static_cast<int>(goal.leaving) << goal.distance
            << ' ' << goal.within.value_or(-1.0) << goal.joint << goal.above << ' ' << goal.below << ' '
            << goal.min_speed << ' ' << goal.max_speed << goal.of_operator << goal.max_spin << ' '
            << goal.drift_time;
      }
      return all.str();
    });
  }
  return outcomes.bits();
}

/// A session of two trials, one aborted and one passed over, that is gone on with.
std::string bits_of_session() {
  const test::Folder folder;
  Outcomes outcomes(folder);
  const SessionHeader header = test::header();
  const auto go_on = [&] {
    Session session(test::two_places(), header, 0, folder / "session", 0);
    return std::to_string(session.position()) + " of " + std::to_string(session.trials()) + ", " +
           session.object().name;
  };
  {
    Session session(test::two_places(), header, 0, folder / "session", 0);
    session.begin(1'000'000'000);
    session.abort(2'000'000'000);
    session.skip(3'000'000'000);
  }
  std::filesystem::copy(folder / "session", folder / "as it was");
  for (const char* name : {"session.yaml", "trials.csv", "events.csv"}) {
    for (const std::string& text : spoiled(test::text_of(folder / ("as it was/" + std::string(name))))) {
      std::filesystem::remove_all(folder / "session");
      std::filesystem::copy(folder / "as it was", folder / "session");
      folder.write(std::string("session/") + name, text);
      outcomes.add(go_on);
    }
  }
  return outcomes.bits();
}

std::string bits_of_recording() {
  const test::Folder folder;
  Outcomes outcomes(folder);
  auto frames = test::motion_frames("grasp_cube", 60.0, 0);
  frames.resize(2);
  const std::string file = test::write_recording(folder / "recording.csv", frames);
  for (const std::string& text : spoiled(test::text_of(file))) {
    folder.write("recording.csv", text);
    outcomes.add([&] {
      std::vector<std::string> warnings;
      Digest digest;
      for (const JointsFrame& frame : read_recording_csv(file, &warnings)) {
        digest.add(static_cast<double>(frame.stamp));
        for (const HandJoints& hand : frame.hands) {
          digest.add(hand.id);
          for (const float part :
               {hand.confidence, hand.grab_strength, hand.pinch_strength, hand.palm_width.value_or(-1.0f)})
            digest.add(part);
          for (const auto& point : {hand.palm_centre, hand.wrist})
            digest.add(point.value_or(Vector3::Zero()));
          for (const auto& finger : hand.joints)
            for (const auto& joint : finger) digest.add(joint.value_or(Vector3::Zero()));
          for (const auto& finger : hand.bone_width)
            for (const auto& width : finger) digest.add(width.value_or(-1.0f));
        }
      }
      std::string all = digest.text();
      for (const std::string& warning : warnings) all += warning + "\n";
      return all;
    });
  }
  return outcomes.bits();
}

TEST(Outcomes, are_those_that_were_reviewed) {
  test::ReviewedBits bits("test/regression/outcomes.csv", "file,refused,taken");
  if (!bits.made_elsewhere().empty()) GTEST_SKIP() << bits.made_elsewhere();
  for (const char* scene : {"bag", "cube_on_table", "docking", "hatch", "panel", "tongs"})
    bits.compare(std::string("scene ") + scene, bits_of_scene(scene));
  for (const char* task :
       {"assemble", "catch", "dock", "hatch_0g", "nudge_into_box", "pick_and_place", "tap", "throw"})
    bits.compare(std::string("task ") + task, bits_of_task(task));
  bits.compare("session", bits_of_session());
  bits.compare("recording", bits_of_recording());
  bits.check("regression");
}

}  // namespace
}  // namespace mrhi
