#include <filesystem>
#include <fstream>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/scene/object_request.h"
#include "mr_hand_interaction/training/session.h"
#include "scene/scene_files.h"
#include "training/operator_trial.h"
#include "training/trials.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

const std::string kStl =
    "solid t\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0.1 0\nvertex 0.1 0 "
    "0\nendloop\nendfacet\n"
    "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0 0.1\nendloop\nendfacet\n"
    "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 0.1\nvertex 0 0.1 0\nendloop\nendfacet\n"
    "facet normal 0 0 0\nouter loop\nvertex 0.1 0 0\nvertex 0 0.1 0\nvertex 0 0 0.1\nendloop\nendfacet\n"
    "endsolid t\n";

class SessionSetupTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("thing.urdf", test::thing(test::kInertial + std::string(test::kBox)));
    folder_.write("thing.yaml", "gravity: [0, 0, 0]\n");
    folder_.write("task.yaml", "name: two_places\nhold: 3.0\n");
    task_.objects = {{"thing", folder_.path() + "/thing.urdf", {}, {}}};
  }
  SessionSetup setup(const std::string& version = "0.1.0") const {
    return session_setup(folder_.path() + "/task.yaml", task_, configuration_, {}, {}, version);
  }
  void open(const SessionSetup& setup) const { Session(task_, test::header(), 0, session_, 0, setup); }
  std::string refusal(const SessionSetup& setup) const {
    try {
      open(setup);
    } catch (const SessionError& error) {
      EXPECT_EQ(std::string::npos, std::string(error.what()).find('\n'));
      return error.what();
    }
    return "";
  }
  void expect_refused(const SessionSetup& setup, const std::vector<std::string>& words) const {
    const std::string said = refusal(setup);
    for (const std::string& word : words)
      EXPECT_NE(std::string::npos, said.find(word)) << word << "\n" << said;
  }

  test::Folder folder_;
  std::string session_ = folder_.path() + "/P01";
  Task task_ = test::two_places();
  Configuration configuration_;
};

TEST_F(SessionSetupTest, the_folder_keeps_task_parameters_scene_and_software_with_their_hashes) {
  open(setup());
  for (const char* name : {"task.yaml", "parameters.yaml", "software.yaml", "scenes/thing.urdf",
                           "scenes/thing.yaml", "SHA256SUMS"})
    EXPECT_TRUE(fs::exists(session_ + "/setup/" + name)) << name;
  const std::string check = "cd '" + session_ + "/setup' && sha256sum --quiet --strict -c SHA256SUMS";
  EXPECT_EQ(0, std::system(check.c_str())) << "sha256sum reads the list, and finds the same";
}

TEST_F(SessionSetupTest, goes_on_with_the_same) {
  open(setup());
  EXPECT_EQ("", refusal(setup()));
}

TEST_F(SessionSetupTest, another_parameter_is_refused_and_named_with_both_values) {
  open(setup());
  set_parameter(configuration_, "contact_model", "soft_pad");
  expect_refused(setup(), {"setup/parameters.yaml:", "'contact_model: implicit'", "'contact_model: soft_pad'",
                           "allowed: the same, or another folder"});
}

TEST_F(SessionSetupTest, an_edited_task_is_refused_with_its_line) {
  open(setup());
  folder_.write("task.yaml", "name: two_places\nhold: 2.0\n");
  expect_refused(setup(), {"setup/task.yaml:2:", "'hold: 3.0'", "'hold: 2.0'"});
  folder_.write("task.yaml", "name: two_places\nhold: 3.0\nrepetitions: 2\n");
  expect_refused(setup(), {"setup/task.yaml:3:", "'no such line'", "'repetitions: 2'"});
}

TEST_F(SessionSetupTest, another_scene_is_refused) {
  open(setup());
  folder_.write("thing.yaml", "gravity: [0, 0, -1]\n");
  expect_refused(setup(), {"setup/scenes/thing.yaml:1:", "-1"});
}

TEST_F(SessionSetupTest, another_version_or_revision_is_refused) {
  open(setup());
  expect_refused(setup("0.2.0"), {"setup/software.yaml:1:", "'version: 0.1.0'", "'version: 0.2.0'"});
  SessionSetup other = setup();
  other.files["software.yaml"] = "version: 0.1.0\nrevision: another\n";
  expect_refused(other, {"setup/software.yaml:2:", "another"});
}

TEST_F(SessionSetupTest, what_was_kept_and_edited_since_is_refused) {
  open(setup());
  std::ofstream(session_ + "/setup/task.yaml", std::ios::app) << "# edited\n";
  folder_.write("task.yaml", "name: two_places\nhold: 3.0\n# edited\n");
  expect_refused(setup(), {"setup/SHA256SUMS:"});
}

TEST_F(SessionSetupTest, a_session_without_a_record_is_refused) {
  open({});
  expect_refused(setup(), {"without a record of its task"});
}

TEST_F(SessionSetupTest, a_record_without_a_session_is_of_a_start_that_was_cut_off_and_is_written_anew) {
  write_setup(session_, setup("0.0.9"));
  EXPECT_EQ("", refusal(setup()));
  EXPECT_EQ("", refusal(setup()));
}

TEST_F(SessionSetupTest, a_record_that_cannot_be_written_is_told_in_one_line) {
  const std::string file = folder_.write("no_folder", "");
  for (const std::string& folder : {file, std::string("/proc")}) {
    try {
      write_setup(folder, setup());
      ADD_FAILURE() << "written in " << folder;
    } catch (const SessionError& error) {
      test::expect_words(error.what(), {folder, "cannot be written"});
    }
  }
}

TEST_F(SessionSetupTest, a_file_that_cannot_be_written_or_read_is_named) {
  const std::string unwritable(300, 'x');
  try {
    write_setup(session_, {{{unwritable, ""}}});
    ADD_FAILURE() << "written";
  } catch (const SessionError& error) {
    test::expect_words(error.what(), {unwritable, "cannot be written"});
  }
  fs::remove(folder_.path() + "/task.yaml");
  try {
    setup();
    ADD_FAILURE() << "read";
  } catch (const SceneError& error) {
    test::expect_words(error.what(), {folder_.path() + "/task.yaml", "cannot be read"});
  }
}

TEST_F(SessionSetupTest, refused_sessions_are_left_as_they_were) {
  open(setup());
  const auto size = fs::file_size(session_ + "/events.csv");
  refusal(setup("0.2.0"));
  EXPECT_EQ(size, fs::file_size(session_ + "/events.csv"));
  EXPECT_EQ("", refusal(setup()));
}

TEST_F(SessionSetupTest, a_second_session_has_a_folder_of_its_own) {
  open(setup());
  SessionHeader second = test::header();
  second.session = 2;
  try {
    Session(task_, second, 0, session_, 0, setup());
    ADD_FAILURE() << "taken for the first session";
  } catch (const SessionError& error) {
    EXPECT_NE(std::string::npos,
              std::string(error.what()).find("session: the session in this folder has '1'"));
  }
}

// Its file, not its text: the mesh is named relative to it.
TEST_F(SessionSetupTest, an_object_of_the_user_s_own_mesh_can_be_spawned) {
  folder_.write("part.stl", kStl);
  const std::string urdf = folder_.write(
      "thing.urdf",
      test::thing(test::kInertial +
                  std::string(R"(<collision><geometry><mesh filename="part.stl"/></geometry></collision>)")));
  const Pose start{Vector3(0.1, 0.2, 0.3), Quaternion(0, 0, 0, 1)};
  const Twist twist{Vector3(0.5, 0, 0), Vector3(0, 1, 0)};
  const ObjectModel model = load_object({"thing", urdf, start, twist}, {}, {}, {});
  const Body body = requested_body(model.request, {});
  EXPECT_EQ(1u, body.shapes.size());
  EXPECT_LT((body.start.position - start.position).norm(), 1e-12);
  EXPECT_LT(body.start.orientation.angularDistance(start.orientation), 1e-9);
  EXPECT_EQ(body.start_twist.linear, twist.linear);
  EXPECT_EQ(body.start_twist.angular, twist.angular);
}

TEST_F(SessionSetupTest, the_mesh_files_are_known_by_their_hashes) {
  folder_.write("part.stl", kStl);
  folder_.write(
      "thing.urdf",
      test::thing(test::kInertial +
                  std::string(R"(<collision><geometry><mesh filename="part.stl"/></geometry></collision>)")));
  const SessionSetup whole = setup();
  ASSERT_EQ(1u, whole.files.count("meshes.txt"));
  EXPECT_EQ("cc29a60fddcf5589fb1fefb85cdd6652cb45436f8dcaa56b20194f60f56df7cd  part.stl\n",
            whole.files.at("meshes.txt"));
}

}  // namespace
}  // namespace mrhi
