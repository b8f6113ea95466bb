#include "replay/tables.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <yaml-cpp/yaml.h>
#include <algorithm>

#include "mr_hand_interaction/replay/replay.h"
#include "replay/replay_files.h"
#include "support/fixtures.h"

namespace mrhi {
namespace {

struct Written {
  Written() : scene(testing::scene_of(testing::box_body({0.05, 0.05, 0.05}, 0.1))) {
    scene.bodies.front().material.dynamic_friction = 0.6;
    scene.bodies.push_back(scene.bodies.front());
    scene.bodies.back().name = "table";
    scene.bodies.back().fixed = true;
    for (const Body& body : scene.bodies) state.bodies.push_back(start_state(body));
    state.bodies[0].pose.position = {0.1, -0.2, 1.0 / 3.0};
    state.bodies[0].linear_momentum = {0.01, 0.0, 0.0};  // 0.1 kg: 0.1 m/s
    state.hands.resize(kMaxHands);
    state.hands[1].current.id = 4000000000u;
  }

  void write(Nanoseconds first, Nanoseconds second) {
    ResultWriter writer(folder / "new/out", scene);
    for (const Nanoseconds stamp : {first, second}) {
      result.stamp = stamp;
      writer.write(result, state, Vector3::Zero());
    }
    writer.flush();
  }

  std::vector<std::string> lines(const std::string& name) const {
    return test::lines_of(folder / ("new/out/" + name));
  }

  test::Folder folder;
  Scene scene;
  SimulationState state;
  FrameResult result;
};

TEST(ResultWriter, objects_have_a_row_for_each_free_body_and_frame) {
  Written written;
  written.write(5'000'000'000, 5'008'333'333);
  const auto lines = written.lines("objects.csv");
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(
      lines[0],
      "time,name,px,py,pz,qx,qy,qz,qw,vx,vy,vz,wx,wy,wz,level,held,assisted,assist_fx,assist_fy,assist_fz,"
      "frame,assist_tx,assist_ty,assist_tz");
  EXPECT_EQ(lines[1], "0,object,0.1,-0.2,0.333333333333,0,0,0,1,0.1,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0");
  EXPECT_EQ(lines[2].substr(0, lines[2].find(",0.1")), "0.008333333,object");
}

TEST(ResultWriter, contacts_name_object_hand_and_phase) {
  Written written;
  Contact contact;
  contact.key.body = 0;
  contact.key.hand = 1;
  contact.key.capsule = static_cast<std::uint8_t>(capsule_index(1, 3));
  contact.point = {1, 2, 3};
  contact.depth = 0.002;
  contact.force = {0.3, 0, -0.5};
  contact.friction = Friction::slipping;
  contact.patch = 0.004;
  contact.peak_force = 0.75;
  contact.torque = 0.002;
  written.result.contacts = {contact, contact};
  written.result.contacts[1].impulse = {0, 0, -0.25};
  written.result.contacts[1].key.capsule = kPalm;
  written.result.contacts[1].depth = 0.0;
  written.write(0, 1);
  const auto lines = written.lines("contacts.csv");
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_EQ(lines[0],
            "time,object,hand_id,finger,bone,phase,x,y,z,nx,ny,nz,depth,jx,jy,jz,fx,fy,fz,"
            "finger_name,bone_name,phase_name,normal_force,tangential_force,friction_limit,friction_share,"
            "touching,slipping,patch,frame,peak_force,torque");
  EXPECT_EQ(lines[1],
            "0,object,4000000000,1,3,2,1,2,3,0,0,1,0.002,0,0,0,0.3,0,-0.5,index,distal,slipping,0.5,0.3,0.3,"
            "1,1,1,0.004,0,0.75,0.002");
  EXPECT_EQ(lines[2],
            "0,object,4000000000,5,0,0,1,2,3,0,0,1,0,0,0,-0.25,0.3,0,-0.5,palm,palm,impulse,0.5,0.3,0.3,1,0,"
            "1,0.004,0,0.75,0.002");
}

TEST(ResultWriter, hands_have_the_phalanges_that_exist_tracked_and_rendered) {
  Written written;
  Hand hand = testing::finger({0, 0, 0}, {0.02, 0, 0}, 0.009);
  hand.capsules[kPalm] = {{0, 0, 0}, {0, 0, 0.03}, 0.0125};
  written.result.tracked = {hand};
  written.result.rendered = {{hand, {}}};
  written.result.rendered[0].touching[static_cast<std::size_t>(capsule_index(1, 3))] = true;
  written.write(0, 1);
  const auto lines = written.lines("hands.csv");
  ASSERT_EQ(lines.size(), 9u);
  EXPECT_EQ(lines[0], "time,hand_id,side,finger,bone,rendered,sx,sy,sz,ex,ey,ez,radius,touching,frame");
  EXPECT_EQ(lines[1], "0,1,1,1,3,0,0,0,0,0.02,0,0,0.009,0,0");
  EXPECT_EQ(lines[2], "0,1,1,5,0,0,0,0,0,0,0,0.03,0.0125,0,0");
  EXPECT_EQ(lines[3], "0,1,1,1,3,1,0,0,0,0.02,0,0,0.009,1,0");
  EXPECT_EQ(lines[4], "0,1,1,5,0,1,0,0,0,0,0,0.03,0.0125,0,0");
}

TEST(ResultWriter, palms_say_which_hands_their_tracker_does_not_see) {
  Written written;
  for (const std::uint32_t id : {4u, 5u}) {
    Hand hand = testing::finger({0, 0, 0}, {0.02, 0, 0}, 0.009);
    hand.id = id;
    written.result.tracked.push_back(hand);
    HandTrack& track = written.state.hands[id - 3];
    track.active = true;
    track.held = id == 5;
    track.current = hand;
  }
  written.state.hands[0].held = true;  // an old track of the first
  written.state.hands[0].current.id = 4;
  written.write(0, 1);
  const auto lines = written.lines("palms.csv");
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_EQ(lines[0], "time,hand_id,side,px,py,pz,qx,qy,qz,qw,confidence,lost,frame");
  EXPECT_EQ(lines[1].substr(lines[1].rfind(',', lines[1].rfind(',') - 1)), ",0,0");
  EXPECT_EQ(lines[2].substr(lines[2].rfind(',', lines[2].rfind(',') - 1)), ",1,0");
}

TEST(ResultWriter, events_have_names_and_the_time_at_which_they_happened) {
  Written written;
  written.result.events = {{1'000'000'000, EventKind::hand_found, -1, 7},
                           {1'500'000'000, EventKind::grasp_begin, 0, 7}};
  written.write(1'000'000'000, 2'000'000'000);
  const auto lines = written.lines("events.csv");
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_EQ(lines[0], "time,kind,object,hand_id,frame,assisted");
  EXPECT_EQ(lines[1], "0,HAND_FOUND,,7,0,0");
  EXPECT_EQ(lines[2], "0.5,GRASP_BEGIN,object,7,0,0");
}

TEST(ResultWriter, frames_have_their_stamp_and_gravity_and_bodies_what_they_are) {
  Written written;
  written.write(5'000'000'000, 5'500'000'000);
  const auto frames = written.lines("frames.csv");
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[2], "0.5,1,5500000000,0,0,0");
  const auto bodies = written.lines("bodies.csv");
  ASSERT_EQ(bodies.size(), 2u);  // nothing has changed since, and the table does not move
  EXPECT_EQ(bodies[1].substr(0, 13), "0,object,0.1,");
  EXPECT_EQ(bodies[1].substr(bodies[1].size() - 6), ",,,,,0");  // on no joint
}

TEST(ResultWriter, palms_say_whether_the_tracker_sees_the_hand) {
  Written written;
  Hand hand = testing::finger({0, 0, 0}, {0.02, 0, 0}, 0.009);
  hand.palm.position = {1, 2, 3};
  hand.confidence = 0.5;
  written.result.tracked = {hand};
  written.state.hands[0].active = true;
  written.state.hands[0].current = hand;
  written.state.hands[0].held = true;
  written.write(0, 1);
  EXPECT_EQ(written.lines("palms.csv").at(1), "0,1,1,1,2,3,0,0,0,1,0.5,1,0");
}

TEST(ResultWriter, an_object_that_grasp_assist_supports_is_marked_with_its_wrench) {
  Written written;
  written.state.interactions.assign(kMaxHands * written.state.bodies.size(), Interaction());
  written.state.interactions[2].level = InteractionLevel::grasp;  // of the second hand
  written.result.assists = {{0, 0, {0, 0, 0.25}, {0.5, 0, 0}}};
  written.write(0, 1);
  const std::string row = written.lines("objects.csv").at(1);
  EXPECT_EQ(row.substr(row.size() - 25), ",3,1,1,0,0,0.25,0,0.5,0,0");
}

TEST(ResultWriter, a_folder_that_cannot_be_made_is_named) {
  Written written;
  std::ofstream(written.folder / "file") << "x";
  try {
    ResultWriter writer(written.folder / "file", written.scene);
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(written.folder / "file"), std::string::npos) << error.what();
  }
}

TEST(ResultWriter, a_pipe_among_its_files_is_refused_and_not_waited_for) {
  Written written;
  const std::string pipe = written.folder / "objects.csv";
  ASSERT_EQ(0, mkfifo(pipe.c_str(), 0600));
  try {
    ResultWriter writer(written.folder / "", written.scene);
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("objects.csv: it is no file"), std::string::npos)
        << error.what();
  }
}

// What scripts of others read by place stays where it was.
TEST(Dictionary, columns_that_were_there_stand_first_and_keep_their_names) {
  const std::vector<std::pair<std::string, std::string>> old{
      {"objects.csv", "time,name,px,py,pz,qx,qy,qz,qw,vx,vy,vz,wx,wy,wz"},
      {"contacts.csv",
       "time,object,hand_id,finger,bone,phase,x,y,z,nx,ny,nz,depth,jx,jy,jz,fx,fy,fz,finger_name,bone_name,"
       "phase_name,"
       "normal_force,tangential_force,friction_limit"},
      {"hands.csv", "time,hand_id,side,finger,bone,rendered,sx,sy,sz,ex,ey,ez,radius,touching"},
      {"events.csv", "time,kind,object,hand_id"}};
  for (const auto& [file, header] : old)
    EXPECT_EQ(table_of(file).header().compare(0, header.size(), header), 0) << file;
}

TEST(Dictionary, every_column_is_in_the_page_of_files) {
  const std::string page = test::text_of("docs/messages.md");
  for (const Table& table : tables()) {
    const std::size_t begin = page.find("\n### " + table.file);
    ASSERT_NE(begin, std::string::npos) << table.file;
    const std::string section = page.substr(begin, page.find("\n### ", begin + 1) - begin);
    for (const Column& column : table.columns) {
      const auto stands = [&](const char* before, const char* after) {
        return section.find(before + column.name + after) != std::string::npos;
      };
      EXPECT_TRUE(stands("`", "`") || stands("`", ",") || stands(",", ",") || stands(",", "`"))
          << table.file << ": " << column.name;
    }
  }
}

TEST(Dictionary, rows_that_are_written_have_a_cell_for_each_column_and_the_schema_lies_beside_them) {
  const test::Folder folder;
  ReplayArguments arguments;
  arguments.scene = "config/scenes/cube.urdf";
  arguments.input = test::write_recording(folder / "nudge.csv", test::motion_frames("nudge", 60.0, 0));
  arguments.output = folder / "out";
  replay(arguments);
  const YAML::Node schema = YAML::LoadFile(folder / "out/schema.json");
  for (const Table& table : tables()) {
    EXPECT_EQ(schema[table.file]["columns"].size(), table.columns.size()) << table.file;
    if (table.file == "hashes.csv" || table.file == "joints.csv") continue;  // of bags; of joints
    const auto lines = test::lines_of(folder / ("out/" + table.file));
    ASSERT_GT(lines.size(), 1u) << table.file;
    for (const std::string& line : {lines.front(), lines.back()})
      EXPECT_EQ(static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1, table.columns.size())
          << table.file;
  }
}

}  // namespace
}  // namespace mrhi
