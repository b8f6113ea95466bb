#include "dictionary.h"

#include <sstream>
#include <stdexcept>

#include "json_text.h"

namespace mrhi {
namespace {

// A line "FILE: what has a row", then one "name|unit|meaning" per column. Columns of a vector share a line:
// "px py pz|m|position" are "position, x" to "position, z".
const char* const kTables = R"(
objects.csv: each object that moves, and frame
time|s|stamp of the frame relative to the first
name||of the object
px py pz|m|place of the centre of mass in world
qx qy qz qw||orientation, unit quaternion
vx vy vz|m/s|velocity of the centre of mass
wx wy wz|rad/s|spin, world axes
level||highest of any hand: 0 none, 1 hover, 2 contact, 3 grasp
held||1 if a hand grasps it
assisted||1 if contact/grasp_assist supports it
assist_fx assist_fy assist_fz|N|force of the grasp assist, mean over the frame; not part of the contacts' forces
frame||number of the frame, from 0, by which the tables' rows belong together

joints.csv: each joint per frame, of a scene that has any; of one that slides m and N in place of rad and N m
time|s|stamp of the frame relative to the first
name||of the joint
position|rad|from where its link is in the URDF
velocity|rad/s|
effort|N m|of its own spring, friction, limits and the like in the last step
frame||number of the frame, from 0, by which the tables' rows belong together

contacts.csv: each point at which a hand touches an object in the last step of a frame
time|s|stamp of the frame relative to the first
object||its name
hand_id||the tracker's number of the hand
finger||0 thumb, 1 index, 2 middle, 3 ring, 4 little, 5 palm
bone||0 metacarpal, 1 proximal, 2 intermediate, 3 distal; of the palm 0
phase||0 blow, 1 sticking, 2 slipping
x y z|m|place on the object's surface in world
nx ny nz||unit normal, from the object to the hand
depth|m|of the finger in the object
jx jy jz|N s|impulse of a blow on the object
fx fy fz|N|force on the object
finger_name||thumb, index, middle, ring, little, palm
bone_name||metacarpal, proximal, intermediate, distal, palm
phase_name||the phase in words
normal_force|N|push along the normal
tangential_force|N|size of the force along the surface
friction_limit|N|what friction bears: the object's coefficient, static while it sticks, times the push
friction_share||tangential_force over friction_limit; 0 where that is 0
touching||0 if it has struck the object in the frame and has left it again
slipping||1 if the contact's friction slides
patch|m|radius of the contact patch
frame||number of the frame, from 0, by which the tables' rows belong together

hands.csv: each phalanx that there is, tracked and rendered, and frame
time|s|stamp of the frame relative to the first
hand_id||the tracker's number of the hand
side||0 left, 1 right
finger||0 thumb, 1 index, 2 middle, 3 ring, 4 little, 5 palm
bone||0 metacarpal, 1 proximal, 2 intermediate, 3 distal; of the palm 0
rendered||0 tracked and filtered, 1 rendered
sx sy sz|m|start of its axis in world
ex ey ez|m|end of its axis in world
radius|m|of the phalanx
touching||1 if it touches an object
frame||number of the frame, from 0, by which the tables' rows belong together

palms.csv: each tracked and filtered hand, and frame
time|s|stamp of the frame relative to the first
hand_id||the tracker's number of the hand
side||0 left, 1 right
px py pz|m|centre of the palm in world
qx qy qz qw||orientation, unit quaternion: x to the fingers, z out of the hand's back
confidence||the tracker's, 0 to 1
lost||1 if the tracker does not see the hand, which keeps its pose
frame||number of the frame, from 0, by which the tables' rows belong together

events.csv: each event, in their order
time|s|stamp of the event relative to the first frame
kind||as in InteractionEvent.msg: GRASP_BEGIN
object||its name; empty for events of hands
hand_id||the tracker's number of the hand
frame||number of the frame, from 0, by which the tables' rows belong together
assisted||1 if contact/grasp_assist supports the object in that frame

frames.csv: each frame
time|s|stamp of the frame relative to the first
frame||number of the frame, from 0, by which the tables' rows belong together
stamp|ns|of the frame
gx gy gz|m/s^2|gravity in world

bodies.csv: each object that moves, as the run begins and after each change of the scene
time|s|stamp of the frame relative to the first
name||of the object
mass|kg|
static_friction||coefficient while it sticks
dynamic_friction||coefficient while it slides
restitution||of Newton's impact law
radius|m|bounding radius about the centre of mass
hx hy hz|m|half extents of an object that is one box, else 0
joint||name of the joint by which it hangs on another body, or empty
joint_kind||turning or sliding
lower|rad|the joint's lower limit, -inf if none; m of one that slides
upper|rad|the joint's upper limit, inf if none; m of one that slides
frame||number of the frame, from 0, by which the tables' rows belong together

hashes.csv: each message of simulation_input that has been done again
sequence||its number
stamp|ns|of the hands' stream
state_hash||of the state after it, 16 hexadecimal digits
)";

void add_columns(const std::string& line, Table& table) {
  const std::size_t unit = line.find('|'), meaning = line.find('|', unit + 1);
  std::istringstream names(line.substr(0, unit));
  const bool vector = line.find(' ') < unit;
  for (std::string name; names >> name;)
    table.columns.push_back({name, line.substr(unit + 1, meaning - unit - 1),
                             line.substr(meaning + 1) + (vector ? std::string(", ") + name.back() : "")});
}

std::vector<Table> tables_in(const std::string& text) {
  std::vector<Table> tables;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(".csv: ");
    if (line.empty()) continue;
    if (colon != std::string::npos) {
      tables.push_back({line.substr(0, colon + 4), line.substr(colon + 6), {}});
    } else {
      add_columns(line, tables.back());
    }
  }
  return tables;
}

std::string column_json(const Column& column) {
  std::vector<std::pair<std::string, std::string>> members{{"name", json::quoted(column.name)}};
  if (!column.unit.empty()) members.emplace_back("unit", json::quoted(column.unit));
  members.emplace_back("meaning", json::quoted(column.meaning));
  return json::object(members);
}

}  // namespace

std::string Table::header() const {
  std::string names;
  for (const Column& column : columns) names += (names.empty() ? "" : ",") + column.name;
  return names;
}

const std::vector<Table>& tables() {
  static const std::vector<Table> all = tables_in(kTables);
  return all;
}

const Table& table_of(const std::string& file) {
  for (const Table& table : tables())
    if (table.file == file) return table;
  throw std::out_of_range("no table " + file);
}

std::string schema_json() {
  std::string text = "{";
  for (const Table& table : tables()) {
    text += (text == "{" ? "\n  " : ",\n  ") + json::quoted(table.file) +
            ": {\"a row for\": " + json::quoted(table.rows) + ", \"columns\": [";
    for (const Column& column : table.columns)
      text += (&column == &table.columns.front() ? "\n    " : ",\n    ") + column_json(column);
    text += "]}";
  }
  return text + "\n}\n";
}

}  // namespace mrhi
