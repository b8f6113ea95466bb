#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "mr_hand_interaction/training/session.h"
#include "scene/scene_files.h"
#include "training/trials.h"

namespace mrhi {
namespace {

Task three_objects() {
  Task task = test::two_places();
  task.objects = {{"cube", "cube", {}, {}}, {"flat", "flat", {}, {}}, {"long", "long", {}, {}}};
  task.latin_square = false;
  return task;
}

std::vector<std::string> lines(const std::string& file) {
  std::ifstream in(file);
  std::vector<std::string> all;
  for (std::string line; std::getline(in, line);) all.push_back(line);
  return all;
}

std::string text(const std::string& file) {
  std::ifstream in(file);
  std::ostringstream all;
  all << in.rdbuf();
  return all.str();
}

class SessionTest : public ::testing::Test {
 protected:
  Session open(const SessionHeader& who = test::header(), Nanoseconds now = 0) {
    return Session(three_objects(), who, 0, path_, now);
  }
  /// Plays the running trial to its release, or only `seconds` of it.
  void play(Session& session, double seconds = 1e9) {
    test::Feeder hand(session.task());  // tells what is seen at each time
    hand.seen.stamp = stamp_;
    const auto see = [&](const Vector3& position, bool held, double duration) {
      hand.seen.pose.position = position;
      hand.seen.held = held;
      for (int i = 0; i < static_cast<int>(100 * duration) && seconds > 0.0; ++i, seconds -= 0.01) {
        hand.seen.stamp += 10'000'000;
        session.update(hand.seen);
      }
      stamp_ = hand.seen.stamp;
    };
    see({0, 0, 0}, false, 0.5);
    see({0.06, 0, 0}, true, 0.5);
    see(test::kFirst, true, 3.1);
    see(test::kSecond, true, 3.1);
    see(test::kSecond, false, 2.1);
  }
  void do_trial(Session& session) {
    session.begin(stamp_);
    play(session);
  }
  std::string refusal(const SessionHeader& who) {
    try {
      open(who);
    } catch (const SessionError& error) {
      EXPECT_EQ(std::string::npos, std::string(error.what()).find('\n'));
      return error.what();
    }
    return "";
  }

  test::Folder folder_;
  std::string path_ = folder_.path() + "/P01";
  std::string trials_ = path_ + "/trials.csv", events_ = path_ + "/events.csv";
  Nanoseconds stamp_ = 0;
};

TEST_F(SessionTest, runs_each_object_and_is_finished) {
  Session session = open();
  for (const char* name : {"cube", "flat", "long"}) {
    EXPECT_EQ(SessionPhase::ready, session.phase());
    EXPECT_EQ(name, session.object().name);
    do_trial(session);
    EXPECT_EQ(TrialResult::completed, session.last()->result);
  }
  EXPECT_EQ(SessionPhase::finished, session.phase());
  const auto rows = lines(trials_);
  ASSERT_EQ(4u, rows.size());
  EXPECT_EQ(0u, rows[1].find("1,cube,implicit,1,completed,0.01")) << rows[1];
  EXPECT_EQ(0u, rows[3].find("3,long,implicit,1,completed,18.")) << rows[3];
}

TEST_F(SessionTest, events_are_in_the_file_at_once) {
  Session session = open();
  session.begin(0);
  play(session, 1.5);
  const std::string log = text(events_);
  for (const char* event : {"session_begun", ",1,manipulation,begun,cube,", ",1,manipulation,grasped,cube,",
                            ",1,maintenance,reached,cube,2"})
    EXPECT_NE(std::string::npos, log.find(event)) << event << "\n" << log;
}

TEST_F(SessionTest, the_fingertip_s_path_is_logged_while_a_trial_runs_and_goes_on_after_a_crash) {
  HandRow row;
  row.end = Vector3(0.1, 0.2, 0.3);
  {
    Session session = open();
    session.log_hand(row, 0);
    EXPECT_FALSE(std::filesystem::exists(path_ + "/hands_raw.csv")) << "no trial has begun";
    session.begin(0);
    play(session, 1.0);
    session.log_hand(row, stamp_);
    row.filtered = true;
    session.log_hand(row, stamp_);
  }
  std::ofstream(path_ + "/hands.csv", std::ios::app) << "1.02,0,0,1,3,0,0.0";
  Session session = open();
  session.begin(0);
  play(session, 1.0);
  session.log_hand(row, stamp_);
  const auto filtered = lines(path_ + "/hands.csv");
  ASSERT_EQ(3u, filtered.size()) << "the line that was cut off is gone";
  EXPECT_EQ("time,hand_id,side,finger,bone,rendered,sx,sy,sz,ex,ey,ez,radius,touching", filtered[0]);
  EXPECT_NE(std::string::npos,
            filtered[1].find(",1,3,0,0.000000,0.000000,0.000000,0.100000,0.200000,0.300000,"));
  EXPECT_LT(std::stod(filtered[1]), std::stod(filtered[2]));
  EXPECT_EQ(2u, lines(path_ + "/hands_raw.csv").size());
}

TEST_F(SessionTest, skip_passes_over_the_running_trial_or_the_next) {
  Session session = open();
  session.begin(0);
  play(session, 1.0);
  session.skip(stamp_);
  EXPECT_EQ(TrialResult::skipped, session.last()->result);
  EXPECT_EQ("flat", session.object().name);
  session.skip(stamp_);
  EXPECT_EQ("long", session.object().name);
  EXPECT_EQ(SessionPhase::ready, session.phase());
  session.skip(stamp_);
  EXPECT_EQ(SessionPhase::finished, session.phase());
  session.skip(stamp_);
  EXPECT_EQ(4u, lines(trials_).size());
}

TEST_F(SessionTest, repeat_aborts_the_running_trial_and_does_it_again_under_a_new_number) {
  Session session = open();
  session.begin(0);
  play(session, 1.0);
  session.repeat(stamp_);
  EXPECT_EQ(SessionPhase::ready, session.phase());
  EXPECT_EQ("cube", session.object().name);
  do_trial(session);
  const auto rows = lines(trials_);
  ASSERT_EQ(3u, rows.size());
  EXPECT_EQ(0u, rows[1].find("1,cube,implicit,1,aborted,"));
  EXPECT_EQ(0u, rows[2].find("2,cube,implicit,1,completed,"));
}

TEST_F(SessionTest, repeat_between_trials_does_the_last_again) {
  Session session = open();
  session.repeat(0);
  EXPECT_EQ("cube", session.object().name) << "nothing before the first";
  do_trial(session);
  session.repeat(stamp_);
  EXPECT_EQ("cube", session.object().name);
  do_trial(session);
  EXPECT_EQ("flat", session.object().name);
  EXPECT_EQ(0u, lines(trials_)[2].find("2,cube,implicit,1,completed,"));
}

TEST_F(SessionTest, repeat_after_the_last_trial_goes_back_to_it) {
  Session session = open();
  for (int i = 0; i < 3; ++i) do_trial(session);
  session.repeat(stamp_);
  EXPECT_EQ(SessionPhase::ready, session.phase());
  EXPECT_EQ("long", session.object().name);
}

TEST_F(SessionTest, what_is_seen_while_paused_is_not_taken) {
  Session session = open();
  session.begin(0);
  play(session, 1.2);
  const double elapsed = session.trial().elapsed();
  session.pause(true, stamp_);
  play(session, 5.0);
  EXPECT_EQ(elapsed, session.trial().elapsed());
  session.pause(false, stamp_);
  play(session, 0.5);
  EXPECT_NEAR(elapsed + 0.5, session.trial().elapsed(), 0.011);
  EXPECT_NE(std::string::npos, text(events_).find("paused"));
}

TEST_F(SessionTest, goes_on_after_the_last_trial_that_has_ended) {
  {
    Session session = open();
    do_trial(session);
    session.begin(stamp_);
    play(session, 2.0);
  }
  Session session = open(test::header(), 7'000'000'000'000);
  EXPECT_TRUE(session.folder().resumed());
  EXPECT_EQ("flat", session.object().name);
  EXPECT_EQ(1u, session.position());
  stamp_ = 7'000'000'000'000;
  do_trial(session);
  const auto rows = lines(trials_);
  ASSERT_EQ(3u, rows.size());
  EXPECT_EQ(0u, rows[2].find("3,flat,implicit,1,completed,10.3")) << "number 2 is in the events: " << rows[2];
}

TEST_F(SessionTest, survives_being_killed_in_the_middle_of_a_trial) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    Session session = open();
    do_trial(session);
    session.begin(stamp_);
    play(session, 2.0);
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(child, waitpid(child, &status, 0));
  ASSERT_TRUE(WIFSIGNALED(status));
  const std::string before = text(trials_);
  EXPECT_EQ(2u, lines(trials_).size());
  EXPECT_NE(std::string::npos, text(events_).find(",2,maintenance,reached,flat,")) << "up to the kill";

  Session session = open();
  EXPECT_EQ(before, text(trials_));
  for (int i = 0; i < 2; ++i) do_trial(session);
  EXPECT_EQ(SessionPhase::finished, session.phase());
  EXPECT_EQ(4u, lines(trials_).size());
  EXPECT_EQ(0u, text(trials_).find(before)) << "what was there stays";
}

TEST_F(SessionTest, a_line_that_was_cut_off_anywhere_is_done_again) {
  {
    Session session = open();
    for (int i = 0; i < 2; ++i) do_trial(session);
  }
  const std::string whole = text(trials_);
  const std::size_t second = whole.rfind('\n', whole.size() - 2) + 1;
  for (std::size_t cut = second; cut < whole.size(); cut += 5) {
    std::ofstream(trials_, std::ios::trunc) << whole.substr(0, cut);
    const Session session = open();
    EXPECT_EQ("flat", session.object().name) << cut;
    EXPECT_EQ(whole.substr(0, second), text(trials_));
    EXPECT_EQ(cut == second ? 0u : 1u, session.folder().notes().size());
  }
  std::ofstream(trials_, std::ios::trunc) << whole.substr(0, 30);
  EXPECT_EQ("cube", open().object().name) << "cut in the header";
  EXPECT_EQ(1u, lines(trials_).size());
}

TEST_F(SessionTest, refuses_the_folder_of_another_session_and_leaves_it_alone) {
  open();
  const std::string before = text(events_);
  SessionHeader other = test::header();
  other.participant = "P02";
  test::expect_words(refusal(other), {path_ + "/session.yaml", "participant", "'P01'", "'P02'"});
  other = test::header();
  const std::string whole = text(path_ + "/session.yaml");
  std::string without = whole;
  without.erase(without.find("\nseed:"),
                without.find('\n', without.find("\nseed:") + 1) - without.find("\nseed:"));
  std::ofstream(path_ + "/session.yaml", std::ios::trunc) << without;
  test::expect_words(refusal(test::header()), {"seed: the session in this folder has 'nothing'"});
  std::ofstream(path_ + "/session.yaml", std::ios::trunc) << whole;
  other.condition = "seed";
  test::expect_words(refusal(other), {"condition", "'implicit'", "'seed'"});
  other = test::header();
  other.group = "veteran";
  test::expect_words(refusal(other), {"group", "'beginner'", "'veteran'"});
  EXPECT_EQ(before, text(events_));
  other = test::header();
  other.started = "2025-01-01T00:00:00Z";
  EXPECT_EQ("", refusal(other)) << "it has been started anew";
}

TEST_F(SessionTest, refuses_a_header_that_is_none_or_has_another_order_or_gravity) {
  open();
  const std::string file = path_ + "/session.yaml", kept = text(file);
  const std::size_t order = kept.find("order:");
  ASSERT_NE(order, std::string::npos);
  std::ofstream(file) << kept.substr(0, order) << "order: [flat, cube]\n";
  test::expect_words(refusal(test::header()), {file, "order", "'[flat, cube]'"});
  const std::string weightless = "gravity: [0, 0, 0]";
  std::string on_earth = kept;
  ASSERT_NE(kept.find(weightless), std::string::npos) << kept;
  on_earth.replace(kept.find(weightless), weightless.size(), "gravity: [0, 0, -9.81]");
  std::ofstream(file) << on_earth;
  test::expect_words(refusal(test::header()), {file, "gravity", "[0, 0, -9.81]", "[0, 0, 0]"});
  std::ofstream(file) << "- participant\n";
  test::expect_words(refusal(test::header()), {file, "is not a list of keys with values"});
  std::ofstream(file) << kept;
  EXPECT_EQ("", refusal(test::header()));
}

TEST_F(SessionTest, does_a_trial_again_whose_result_it_does_not_know) {
  {
    Session session = open();
    do_trial(session);
  }
  std::string rows = text(trials_);
  const std::string result = "completed";
  ASSERT_NE(rows.find(result + ","), std::string::npos) << rows;
  EXPECT_EQ(1u, open().position());
  rows.replace(rows.find(result + ","), result.size(), "perfect");
  std::ofstream(trials_) << rows;
  EXPECT_EQ(0u, open().position());
}

TEST_F(SessionTest, is_refused_while_another_program_has_its_folder_and_names_that) {
  int ready[2], done[2];
  ASSERT_EQ(0, pipe(ready));
  ASSERT_EQ(0, pipe(done));
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  char byte = 0;
  if (child == 0) {
    const Session session = open();
    if (write(ready[1], "r", 1) == 1 && read(done[0], &byte, 1) >= 0) kill(getpid(), SIGKILL);
  }
  ASSERT_EQ(1, read(ready[0], &byte, 1));
  const std::string before = text(events_);
  test::expect_words(refusal(test::header()), {path_, "in use by process " + std::to_string(child) + " on "});
  EXPECT_EQ(before, text(events_));
  ASSERT_EQ(1, write(done[1], "d", 1));
  ASSERT_EQ(child, waitpid(child, nullptr, 0));
  EXPECT_EQ("", refusal(test::header())) << "a lock ends with its program, however that ends";
}

/// No file of the child may grow further, as on a disk that is full.
TEST_F(SessionTest, a_disk_that_is_full_is_told_and_what_is_in_the_files_stays) {
  {
    Session session = open();
    do_trial(session);
  }
  const std::string trials = text(trials_);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    Session session = open();
    const rlimit full{1, 1};
    setrlimit(RLIMIT_FSIZE, &full);
    try {
      do_trial(session);
    } catch (const SessionError& error) {
      _exit(std::string(error.what()).find("space left") != std::string::npos ? 7 : 8);
    }
    _exit(9);
  }
  int status = 0;
  ASSERT_EQ(child, waitpid(child, &status, 0));
  EXPECT_EQ(7, WEXITSTATUS(status));
  EXPECT_EQ(trials, text(trials_));
  Session session = open();
  EXPECT_EQ("flat", session.object().name);
}

TEST_F(SessionTest, a_folder_that_cannot_be_is_refused_in_one_line) {
  path_ = "/dev/null/P01";
  test::expect_words(refusal(test::header()), {"/dev/null/P01", "cannot be made"});
  path_ = "/proc/P01";
  EXPECT_NE("", refusal(test::header()));
}

TEST_F(SessionTest, refuses_what_must_not_be_in_a_header) {
  SessionHeader bad = test::header();
  bad.group = "two words";
  test::expect_words(refusal(bad), {"group", "'two words'", "allowed: a name"});
  bad = test::header();
  bad.handedness = "both";
  test::expect_words(refusal(bad), {"'both'", "right or left"});
  bad = test::header();
  for (const std::string& name :
       {std::string("a,b"), std::string("../../x"), std::string("=1+1"), std::string("-1"), std::string("@a"),
        std::string("\x1b[2J"), std::string("a b"), std::string(65, 'a'), std::string("P\n1"),
        std::string()}) {
    bad = test::header();
    bad.participant = name;
    test::expect_words(refusal(bad), {"participant", "64 letters, digits, '_' and '-'"});
    EXPECT_EQ(refusal(bad).find('\x1b'), std::string::npos);
    bad = test::header();
    bad.condition = name;
    test::expect_words(refusal(bad), {"condition", "64 letters, digits, '_' and '-'"});
  }
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(SessionTest, refuses_tables_with_other_columns_or_a_broken_line) {
  open();
  std::ofstream(trials_, std::ios::trunc) << "trial,object\n";
  test::expect_words(refusal(test::header()), {"trials.csv:1", "columns"});
  std::filesystem::remove(trials_);
  open();
  std::ofstream(trials_, std::ios::app) << "1,cube\n";
  test::expect_words(refusal(test::header()), {"trials.csv:2", "2 fields"});
}

/// All files below the folder, with what is in them.
std::map<std::string, std::string> all_in(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    files[entry.path().string()] = entry.is_regular_file() ? text(entry.path().string()) : "";
  return files;
}

TEST_F(SessionTest, refuses_a_folder_with_tables_of_others_and_touches_nothing_in_it) {
  std::filesystem::create_directory(path_);
  for (const std::string name : {"trials.csv", "events.csv", "hands.csv", "hands_raw.csv"}) {
    for (const std::string foreign : {"day,weight\n1,70\n2,7", "day,weight", "trial,object\n"}) {
      std::ofstream(path_ + "/" + name) << foreign;
      const auto before = all_in(path_);
      test::expect_words(refusal(test::header()), {name + ":1", "columns"});
      EXPECT_EQ(before, all_in(path_)) << name;
    }
    std::filesystem::remove(path_ + "/" + name);
  }
  std::filesystem::create_directory(path_ + "/setup");
  std::ofstream(path_ + "/setup/mine") << "x";
  const auto before = all_in(path_);
  test::expect_words(refusal(test::header()), {"/setup: is no session's"});
  EXPECT_EQ(before, all_in(path_));
}

/// Opening a pipe waits for who writes to it; a device may have no end.
TEST_F(SessionTest, refuses_pipes_and_devices_in_place_of_its_files) {
  std::filesystem::create_directory(path_);
  for (const std::string name : {"trials.csv", "events.csv", "hands.csv", "session.lock", "session.yaml"}) {
    const std::string file = path_ + "/" + name;
    ASSERT_EQ(0, mkfifo(file.c_str(), 0600));
    EXPECT_NE(refusal(test::header()).find(file), std::string::npos);
    std::filesystem::remove(file);
    std::filesystem::create_symlink("/dev/zero", file);
    EXPECT_NE(refusal(test::header()).find(file), std::string::npos);
    std::filesystem::remove(file);
  }
  std::filesystem::create_directory(path_ + "/session.lock");
  test::expect_words(refusal(test::header()), {path_ + "/session.lock", "cannot be written"});
  std::filesystem::remove(path_ + "/session.lock");
  EXPECT_EQ("", refusal(test::header()));
}

/// Writing goes on without an error to a file that has no name any more.
TEST_F(SessionTest, tells_that_its_folder_was_removed_or_its_tables_replaced) {
  const auto said = [](const auto& work) {
    try {
      work();
    } catch (const SessionError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string told = ": was removed or replaced while the session runs; allowed: a folder that is left";
  for (const bool replaced : {false, true}) {
    Session session = open();
    session.folder().check_there();
    std::filesystem::remove_all(path_);
    if (replaced) {
      std::filesystem::create_directory(path_);
      std::ofstream(trials_) << "mine";
    }
    EXPECT_NE(said([&] { session.folder().check_there(); }).find(trials_ + told), std::string::npos);
    EXPECT_NE(said([&] { session.skip(1); }).find(told), std::string::npos);
    std::filesystem::remove_all(path_);
  }
}

TEST_F(SessionTest, goes_on_counting_whatever_numbers_are_in_its_tables) {
  open();
  std::ofstream(events_, std::ios::app)
      << "0.1,2147483647,manipulation,drop,cube,,,\n-5,x,manipulation,drop,cube,,,\n";
  Session session = open();
  session.begin(0);
  session.abort(1);
  EXPECT_EQ(lines(trials_).back().substr(0, 2), "1,");
}

TEST_F(SessionTest, orders_objects_by_the_latin_square_and_writes_it_down) {
  Task task = three_objects();
  task.latin_square = true;
  std::vector<std::string> firsts;
  for (std::uint64_t place = 0; place < 3; ++place) {
    const std::string path = folder_.path() + "/" + std::to_string(place);
    Session session(task, test::header(), place, path, 0);
    firsts.push_back(session.object().name);
    EXPECT_NE(std::string::npos, text(path + "/session.yaml").find("order: [" + firsts.back()));
  }
  std::sort(firsts.begin(), firsts.end());
  EXPECT_EQ((std::vector<std::string>{"cube", "flat", "long"}), firsts);
}

TEST_F(SessionTest, repetitions_go_through_the_order_again) {
  Task task = three_objects();
  task.repetitions = 2;
  Session session(task, test::header(), 0, path_, 0);
  EXPECT_EQ(6u, session.trials());
  for (int i = 0; i < 3; ++i) session.skip(0);
  EXPECT_EQ("cube", session.object().name);
  session.skip(0);
  EXPECT_EQ(0u, lines(trials_)[4].find("4,cube,implicit,2,skipped,"));
}

TEST_F(SessionTest, practice_is_a_repetition_before_the_first_and_is_not_done_twice) {
  Task task = three_objects();
  task.practice = true;
  {
    Session session(task, test::header(), 0, path_, 0);
    EXPECT_EQ(6u, session.trials());
    session.skip(0);
    EXPECT_EQ(0u, lines(trials_)[1].find("1,cube,implicit,0,skipped,"));
  }
  Session session(task, test::header(), 0, path_, 0);
  EXPECT_EQ(1u, session.position());
  for (int i = 0; i < 3; ++i) session.skip(0);
  EXPECT_EQ(0u, lines(trials_)[4].find("4,cube,implicit,1,skipped,"));
}

TEST(ParticipantPlace, is_the_number_at_the_end_of_the_name) {
  EXPECT_EQ(6u, participant_place("P07"));
  EXPECT_EQ(0u, participant_place("1"));
  EXPECT_EQ(29u, participant_place("group2_30"));
  EXPECT_THROW(participant_place("Anna"), SessionError);
  EXPECT_THROW(participant_place("P07b"), SessionError);
}

TEST_F(SessionTest, notes_what_was_changed_meanwhile_in_one_field) {
  Session session = open();
  session.begin(0);
  session.note_parameter("gravity", "[0, 0,\n-1]", false, stamp_);
  session.note_parameter("gravity", "[0, 0, 0]", true, stamp_);
  const auto rows = lines(events_);
  ASSERT_GE(rows.size(), 3u);
  const std::string changed = rows[rows.size() - 2], restored = rows.back();
  EXPECT_NE(changed.find("parameter_changed"), std::string::npos) << changed;
  EXPECT_NE(restored.find("parameter_restored"), std::string::npos) << restored;
  EXPECT_NE(restored.find("gravity: [0  0  0]"), std::string::npos) << restored;
  const auto fields = [](const std::string& row) { return std::count(row.begin(), row.end(), ','); };
  EXPECT_EQ(fields(changed), fields(rows.front()));
  EXPECT_EQ(fields(restored), fields(rows.front()));
}

}  // namespace
}  // namespace mrhi
