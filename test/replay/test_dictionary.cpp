#include "replay/tables.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>

#include "mr_hand_interaction/replay/replay.h"
#include "replay/replay_files.h"

namespace mrhi {
namespace {

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
  const test::TemporaryFolder folder;
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
