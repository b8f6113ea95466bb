#include "mr_hand_interaction/replay/recording_csv.h"

#include <dirent.h>
#include <gtest/gtest.h>
#include <locale.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "support/temporary_folder.h"

namespace mrhi {
namespace {

class RecordingFile {
 public:
  explicit RecordingFile(const std::string& text) : path_(folder_.write("recording.csv", text)) {}
  const std::string& path() const { return path_; }

 private:
  const test::Folder folder_;
  const std::string path_;
};

std::string error_of(const std::string& text) {
  const RecordingFile file(text);
  try {
    read_recording_csv(file.path());
  } catch (const RecordingError& error) {
    return std::string(error.what()).substr(file.path().size());
  }
  return "no error";
}

const char* const kHeader =
    "is_left,time_s,frame_id,hand_id,wrist_x,wrist_y,wrist_z,index_width,index_j1_x,index_j1_y,index_j1_z\n";

// As R's write.csv writes a table, and people type one.
TEST(RecordingCsv, QuotesAndBlanksAroundCellsAreNoPartOfThem) {
  const RecordingFile file(
      "\"\",\"time_s\",\"hand_id\",\"is_left\",\"wrist_x\",\"wrist_y\",\"wrist_z\",\"palm_width\"\n"
      "\"1\", 0.5,\t\"7\" ,0, 1, 2, 3, NA\r\n");
  const std::vector<JointsFrame> frames = read_recording_csv(file.path());
  ASSERT_EQ(1u, frames.size());
  EXPECT_EQ(500'000'000, frames[0].stamp);
  EXPECT_EQ(7u, frames[0].hands.at(0).id);
  EXPECT_EQ(Vector3(1, 2, 3), frames[0].hands[0].wrist.value());
  EXPECT_FALSE(frames[0].hands[0].palm_width);
}

// As numpy and pandas write what is missing.
TEST(RecordingCsv, NanIsAMissingValue) {
  const RecordingFile file(std::string(kHeader) + "0,0.5,1,7,1,2,3,nan,NaN,nan,-nan\n");
  const std::vector<JointsFrame> frames = read_recording_csv(file.path());
  EXPECT_EQ(Vector3(1, 2, 3), frames.at(0).hands.at(0).wrist.value());
  EXPECT_FALSE(frames[0].hands[0].finger_width[1]);
  EXPECT_FALSE(frames[0].hands[0].joints[1][1]);
  EXPECT_EQ(":2: index_j1: x, y and z are needed, or none of them",
            error_of(std::string(kHeader) + "0,0.5,1,7,1,2,3,0.01,nan,0,0\n"));
}

TEST(RecordingCsv, AColumnThatIsGivenTwiceAndACompressedTableAreRefused) {
  EXPECT_EQ(":1: column 'time_s' is given twice; allowed: once", error_of("time_s,hand_id,time_s\n0,1,2\n"));
  EXPECT_EQ(": is compressed by gzip; allowed: the table that 'gunzip' makes of it",
            error_of("\x1F\x8B\x08\x01time_s\n"));
}

TEST(RecordingCsv, ColumnsAreFoundByNameAndEmptyCellsAreAbsent) {
  const RecordingFile file(std::string(kHeader) + "1,0.016001,5,12,,,,0.018,0.1,-0.2,3e-1\r\n");
  const auto frames = read_recording_csv(file.path());
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].stamp, 16001000);
  ASSERT_EQ(frames[0].hands.size(), 1u);
  const HandJoints& hand = frames[0].hands[0];
  EXPECT_EQ(hand.id, 12u);
  EXPECT_EQ(hand.side, Side::left);
  EXPECT_EQ(hand.confidence, 1.0f);
  EXPECT_FALSE(hand.wrist);
  EXPECT_EQ(*hand.finger_width[1], 0.018f);
  EXPECT_EQ(*hand.joints[1][1], Vector3(0.1, -0.2, 0.3));
  EXPECT_FALSE(hand.joints[1][0]);
}

TEST(RecordingCsv, AsASpreadsheetSavesItIsTheSame) {
  const std::string plain = std::string(kHeader) + "1,0.016001,5,12,,,,0.018,0.1,-0.2,3e-1\n";
  const auto with = [&plain](char separator, char point) {
    std::string text = plain;
    for (char& c : text) c = c == ',' ? separator : c == '.' ? point : c;
    return text;
  };
  const std::string mark = "\xEF\xBB\xBF";
  for (const std::string& text :
       {mark + plain, with(';', ','), mark + with(';', ','), with(';', '.'), with('\t', ',')}) {
    const RecordingFile file(text);
    const auto frames = read_recording_csv(file.path());
    ASSERT_EQ(frames.size(), 1u) << text;
    EXPECT_EQ(frames[0].stamp, 16001000);
    EXPECT_EQ(*frames[0].hands.at(0).joints[1][1], Vector3(0.1, -0.2, 0.3));
  }
  EXPECT_EQ(error_of("time|hand\n1|2\n").find(":1: has no column 'time_s'; allowed:"), 0u);
}

TEST(RecordingCsv, RowsOfOneTimeAndFrameAreOneFrameAndMinusOneIsNoHand) {
  const RecordingFile file(std::string(kHeader) +
                           "0,0,1,4,,,,,,,\n1,0,1,5,,,,,,,\n,0.01,2,-1,,,,,,,\n0,0.01,3,4,,,,,,,\n");
  const auto frames = read_recording_csv(file.path());
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].hands.size(), 2u);
  EXPECT_EQ(frames[1].hands.size(), 0u);
  EXPECT_EQ(frames[2].hands.size(), 1u);
  EXPECT_EQ(frames[2].stamp, 10000000);
}

TEST(RecordingCsv, ErrorsNameLineAndColumn) {
  const std::string header = kHeader;
  EXPECT_EQ(error_of(header + "0,x,1,4,,,,,,,\n"), ":2: time_s: 'x' is not a number");
  EXPECT_EQ(error_of(header + "0,0,1,4,,,,,,,\n0,1.5,1,4,,,,,0.1s,,\n"),
            ":3: index_j1_x: '0.1s' is not a number");
  EXPECT_EQ(error_of(header + "0,0,1,4,1,,3,,,,\n"), ":2: wrist: x, y and z are needed, or none of them");
  EXPECT_EQ(error_of(header + "0,0,1,,,,,,,,\n"), ":2: hand_id: a number is needed");
  EXPECT_EQ(error_of(header + "0,0,1,1.5,,,,,,,\n"),
            ":2: hand_id: a whole number is needed, or -1 for a frame with no hand");
  EXPECT_EQ(error_of(header + "2,0,1,4,,,,,,,\n"), ":2: is_left: 0 or 1 is needed");
  EXPECT_EQ(error_of(header + "0,-1,1,4,,,,,,,\n"), ":2: time_s: a time of 0 to 1e9 s is needed");
  EXPECT_EQ(error_of(header + "0,0,1\n"), ":2: has 3 cells; the header names 11 columns");
  EXPECT_EQ(error_of(header), ": has a header and no frames");
  EXPECT_EQ(error_of(""), ": is empty; allowed: a header and frames");
  EXPECT_EQ(error_of(header + std::string(100'000, ',') + "\n"),
            ":2: is longer than 65536 bytes; allowed: at most that");
  EXPECT_THROW(read_recording_csv("/nowhere/at_all.csv"), RecordingError);
  EXPECT_THROW(read_recording_csv("/dev/zero"), RecordingError);
}

TEST(RecordingCsv, UnixTimeInAnyUnitIsCountedFromTheFirstFrame) {
  const std::vector<std::array<std::string, 3>> tables{{"1700000000.25", "1700000000.75", "s"},
                                                       {"1700000000250", "1700000000750", "ms"},
                                                       {"1700000000250000", "1700000000750000", "us"},
                                                       {"1700000000250000000", "1700000000750000000", "ns"}};
  for (const auto& [first, second, unit] : tables) {
    const RecordingFile file(std::string(kHeader) + "0," + first + ",1,4,,,,,,,\n0," + second +
                             ",2,4,,,,,,,\n");
    std::vector<std::string> warnings;
    const auto frames = read_recording_csv(file.path(), &warnings);
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_EQ(frames[0].stamp, 0);
    EXPECT_NEAR(static_cast<double>(frames[1].stamp), 5e8, 1e3) << unit;
    EXPECT_EQ(warnings, std::vector<std::string>{file.path() + ": time_s is taken as Unix time in " + unit +
                                                 ", and counted from the first frame"});
  }
  EXPECT_EQ(error_of(std::string(kHeader) + "0,1700000000,1,4,,,,,,,\n0,5,2,4,,,,,,,\n"),
            ":3: time_s: a time of 0 to 1e9 s is needed, counted from the first");
}

TEST(RecordingCsv, SidesMayBeTrueAndFalseAsPandasAndRWriteThem) {
  for (const auto& [left, right] :
       {std::pair<std::string, std::string>{"True", "False"}, {"TRUE", "FALSE"}}) {
    const RecordingFile file(std::string(kHeader) + left + ",0,1,4,,,,,,,\n" + right + ",0,1,5,,,,,,,\n");
    const auto frames = read_recording_csv(file.path());
    ASSERT_EQ(frames.at(0).hands.size(), 2u);
    EXPECT_EQ(frames[0].hands[0].side, Side::left);
    EXPECT_EQ(frames[0].hands[1].side, Side::right);
  }
}

TEST(RecordingCsv, ALastLineThatIsCutOffIsLeftOutWithAWarning) {
  const std::string whole = std::string(kHeader) + "0,0,1,4,,,,,,,\n";
  for (const char* rest : {"0,0.01,2,4,,,", "0,0.01,2,4,,,,,0.1,0.2,-"}) {
    const RecordingFile file(whole + rest);
    std::vector<std::string> warnings;
    EXPECT_EQ(read_recording_csv(file.path(), &warnings).size(), 1u) << rest;
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0].find(file.path() + ":3: "), 0u) << warnings[0];
    EXPECT_NE(error_of(whole + rest + "\n"), "no error") << "it is not cut off";
  }
  const RecordingFile file(whole + "0,0.01,2,4,,,,,,,");
  std::vector<std::string> warnings;
  EXPECT_EQ(read_recording_csv(file.path(), &warnings).size(), 2u);
  EXPECT_TRUE(warnings.empty());
}

TEST(RecordingCsv, CommentsAndBlankLinesAreNoRowsAndASeparatorInQuotesIsText) {
  const std::string header = "time_s,hand_id,note,is_left\n";
  for (const std::string& start :
       {"" + header, "\n \n" + header, "# taken at noon\n" + header, "# " + header}) {
    const RecordingFile file(start + "0,4,\"one, \"\"two\"\", 3\",1\n# a pause\n\n0.5,4,5\" wide,1\n");
    const auto frames = read_recording_csv(file.path());
    ASSERT_EQ(frames.size(), 2u) << start;
    EXPECT_EQ(frames[1].hands.at(0).side, Side::left);
  }
  EXPECT_EQ(error_of("\n\ntime,hand_id\n0,1\n").find(":3: has no column 'time_s'"), 0u);
}

TEST(RecordingCsv, AFileInUtf16IsNamedWithWhatConvertsIt) {
  for (const bool little : {true, false}) {
    for (const bool marked : {true, false}) {
      std::string text = !marked ? "" : little ? "\xFF\xFE" : "\xFE\xFF";
      for (const char c : std::string(kHeader) + "0,0,1,4,,,,,,,\n")
        text += little ? std::string{c, '\0'} : std::string{'\0', c};
      EXPECT_EQ(error_of(text), std::string(": is in UTF-16; allowed: UTF-8, such as 'iconv -f UTF-16") +
                                    (little ? "LE" : "BE") + " -t UTF-8' makes of it");
    }
  }
}

TEST(RecordingCsv, AByteOfZeroIsShownAndDoesNotCutTheMessage) {
  const std::string header = kHeader, zero(1, '\0');
  EXPECT_EQ(error_of(header + "0,1" + zero + "5,1,4,,,,,,,\n"), ":2: time_s: '1?5' is not a number");
  EXPECT_EQ(error_of("time" + zero + "_s,hand_id\n0,1\n"),
            ":1: has no column 'time_s'; allowed: a header with time_s, hand_id, is_left and joints; it "
            "begins with 'time?_s'");
}

TEST(RecordingCsv, NumbersAreReadAlikeInEveryLocale) {
  const char* comma_locale = nullptr;
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "nl_NL.UTF-8"})
    if (!comma_locale) comma_locale = setlocale(LC_NUMERIC, name);
  if (!comma_locale) GTEST_SKIP() << "no locale with a decimal comma is installed";
  const RecordingFile file(std::string(kHeader) + "0,0.5,1,4,,,,,,,\n");
  EXPECT_EQ(read_recording_csv(file.path())[0].stamp, 500000000);
  setlocale(LC_NUMERIC, "C");
}

/// The recordings' folder with a slash, or empty.
std::string recordings_folder() {
  const char* set = std::getenv("MR_HAND_RECORDINGS");
  const std::string folder = set ? set : "../shared/recordings";
  return std::ifstream(folder + "/SCHEMA.md") ? folder + "/" : "";
}

std::vector<std::string> recordings(const std::string& folder) {
  std::vector<std::string> files;
  DIR* directory = opendir(folder.c_str());
  while (const dirent* entry = readdir(directory)) {
    const std::string name = entry->d_name;
    if (name.size() > 4 && name.substr(name.size() - 4) == ".csv" && name != "MANIFEST.csv")
      files.push_back(name);
  }
  closedir(directory);
  std::sort(files.begin(), files.end());
  return files;
}

bool finite(const Hand& hand) {
  bool all =
      hand.palm.position.allFinite() && hand.palm.orientation.coeffs().allFinite() && hand.wrist.allFinite();
  for (const Capsule& capsule : hand.capsules)
    all = all && capsule.start.allFinite() && capsule.end.allFinite() && capsule.radius >= 0.0 &&
          capsule.radius < 0.02;
  return all && hand.palm_width > 0.05 && hand.palm_width < 0.12;
}

#define RECORDINGS_OR_SKIP()                      \
  const std::string folder = recordings_folder(); \
  if (folder.empty()) GTEST_SKIP() << "no recordings: set MR_HAND_RECORDINGS to their folder"

TEST(Recordings, AllParseAndCompleteToFiniteHands) {
  RECORDINGS_OR_SKIP();
  for (const std::string& name : recordings(folder)) {
    std::vector<std::string> defects;
    Nanoseconds last = -1;
    for (const JointsFrame& joints : read_recording_csv(folder + name)) {
      const auto frame = complete_frame(joints, Pose(), defects);
      ASSERT_TRUE(frame && defects.empty()) << name << ": " << (defects.empty() ? "" : defects[0]);
      ASSERT_GT(frame->stamp, last) << name;
      last = frame->stamp;
      for (const Hand& hand : frame->hands)
        ASSERT_TRUE(finite(hand)) << name << " at " << to_seconds(frame->stamp);
    }
  }
}

TEST(Recordings, PlacementKeepsRecordedBoneLengths) {
  RECORDINGS_OR_SKIP();
  const Pose device{Vector3(0.3, -0.2, 0.7), Quaternion(0.5, 0.1, -0.7, 0.5).normalized()};
  for (const std::string& name : recordings(folder))
    for (const JointsFrame& frame : read_recording_csv(folder + name))
      for (const HandJoints& joints : frame.hands) {
        const Hand hand = complete_hand(joints, device);
        for (std::size_t i = 0; i < kPhalanges; ++i) {
          const auto& finger = joints.joints[i / kBonesPerFinger];
          const std::size_t bone = i % kBonesPerFinger;
          if (!hand.has(static_cast<int>(i)) || !finger[bone] || !finger[bone + 1]) continue;
          const double recorded = (*finger[bone + 1] - *finger[bone]).norm();
          ASSERT_NEAR((hand.capsules[i].end - hand.capsules[i].start).norm(), recorded, 1e-12) << name;
        }
      }
}

struct PalmAngles {
  double normal = 0.0, direction = 0.0;  ///< sums [deg]
  int hands = 0;
};

double degrees_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / M_PI;
}

/// Compares the palm with the device's own normal and direction, which are not used to derive it.
PalmAngles compare_palms(const std::string& file, Side side) {
  std::ifstream input(file);
  std::string line;
  std::getline(input, line);
  PalmAngles angles;
  auto frames = read_recording_csv(file);
  for (const JointsFrame& frame : frames)
    for (std::size_t row = 0; row < std::max<std::size_t>(frame.hands.size(), 1); ++row) {
      std::getline(input, line);
      if (frame.hands.empty() || frame.hands[row].side != side) continue;
      std::array<double, 16> cells{};
      std::size_t begin = 0;
      for (double& cell : cells) {
        const std::size_t comma = line.find(',', begin);
        cell = comma == begin ? NAN : std::stod(line.substr(begin, comma - begin));
        begin = comma + 1;
      }
      if (std::isnan(cells[10])) continue;  // not recorded
      const Quaternion palm = complete_hand(frame.hands[row], Pose()).palm.orientation;
      angles.normal += degrees_between(palm * Vector3::UnitZ(), -Vector3(cells[10], cells[11], cells[12]));
      angles.direction += degrees_between(palm * Vector3::UnitX(), Vector3(cells[13], cells[14], cells[15]));
      ++angles.hands;
    }
  return angles;
}

TEST(Recordings, PalmAgreesWithTheDevicesNormalAndDirection) {
  RECORDINGS_OR_SKIP();
  for (const Side side : {Side::left, Side::right}) {
    PalmAngles all;
    for (const std::string& name : recordings(folder)) {
      const PalmAngles here = compare_palms(folder + name, side);
      if (here.hands == 0) continue;
      // The device's first skeleton gives knuckles and palm centre only, and one recording's centre is 20 mm
      // off.
      EXPECT_LT(here.normal / here.hands, 6.0) << name;
      EXPECT_LT(here.direction / here.hands, 10.0) << name;
      all.normal += here.normal;
      all.direction += here.direction;
      all.hands += here.hands;
    }
    ASSERT_GT(all.hands, 0);
    std::printf("%s: normal %.2f deg, direction %.2f deg, mean of %d hands\n",
                side == Side::left ? "left" : "right", all.normal / all.hands, all.direction / all.hands,
                all.hands);
    EXPECT_LT(all.normal / all.hands, 3.0);
    EXPECT_LT(all.direction / all.hands, 3.0);
  }
}

}  // namespace
}  // namespace mrhi
