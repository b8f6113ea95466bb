#include "tables.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "../simulation/contact_phase.h"
#include "../text/files.h"

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

const char *const kObjects = "objects.csv", *const kJoints = "joints.csv", *const kContacts = "contacts.csv",
                  *const kHands = "hands.csv", *const kEvents = "events.csv", *const kFrames = "frames.csv",
                  *const kPalms = "palms.csv", *const kBodies = "bodies.csv";

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

std::string made_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (std::filesystem::is_directory(folder)) return folder;
  throw std::runtime_error("cannot make folder " + folder + (error ? ": " + error.message() : ""));
}

void add_quaternion(CsvFile& file, const Quaternion& q) {
  file << q.x() << q.y() << q.z() << q.w();
}

/// The highest level of any hand.
InteractionLevel level_of(std::size_t body, const SimulationState& state) {
  InteractionLevel level = InteractionLevel::none;
  for (std::size_t i = body; i < state.interactions.size(); i += state.bodies.size())
    level = std::max(level, state.interactions[i].level);
  return level;
}

bool is_lost(const Hand& hand, const SimulationState& state) {
  return std::any_of(state.hands.begin(), state.hands.end(), [&](const HandTrack& track) {
    return track.active && track.current.id == hand.id && track.held;
  });
}

Vector3 half_extents(const Body& body) {
  const Box* box = body.shapes.size() == 1 ? std::get_if<Box>(&body.shapes[0].shape) : nullptr;
  return box == nullptr ? Vector3(Vector3::Zero()) : box->half_extents;
}

const Joint* joint_of(std::size_t body, const Scene& scene) {
  for (const Joint& joint : scene.joints)
    if (joint.child == static_cast<int>(body)) return &joint;
  return nullptr;
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

const char* event_name(EventKind kind) {
  static const char* const names[] = {"HOVER_BEGIN",   "HOVER_END",   "CONTACT_BEGIN", "CONTACT_END",
                                      "GRASP_BEGIN",   "GRASP_END",   "HAND_LOST",     "HAND_FOUND",
                                      "OUT_OF_BOUNDS", "JOINT_LIMIT", "DETENT",        "LATCH_OPEN"};
  return names[static_cast<std::size_t>(kind)];
}

ResultWriter::ResultWriter(const std::string& folder, const Scene& scene)
    : folder_(made_folder(folder)), scene_(&scene) {
  const std::string path = folder + "/schema.json";
  std::ofstream schema = file_to_write(path);
  schema << schema_json() << std::flush;
  if (!schema) throw std::runtime_error("cannot write " + path);
  for (const char* file : {kObjects, kContacts, kHands, kEvents, kFrames, kPalms, kBodies}) table(file);
  follow(scene);
}

CsvFile& ResultWriter::table(const std::string& file) {
  const auto [known, is_new] = tables_.try_emplace(file);
  if (is_new) known->second = std::make_unique<CsvFile>(folder_ + "/" + file, table_of(file).header());
  return *known->second;
}

void ResultWriter::follow(const Scene& scene) {
  scene_ = &scene;
  scene_is_new_ = true;
  if (!scene.joints.empty()) table(kJoints);
}

void ResultWriter::write(const FrameResult& result, const SimulationState& state, const Vector3& gravity) {
  frame_ = begun_ ? frame_ + 1 : 0;
  if (!begun_) first_stamp_ = result.stamp;
  begun_ = true;
  const double time = to_seconds(result.stamp - first_stamp_);
  CsvFile& frames = table(kFrames);
  frames << time << frame_ << result.stamp << gravity;
  frames.end_row();
  if (scene_is_new_) write_bodies(time);
  write_objects(time, result, state);
  if (!scene_->joints.empty()) write_joints(time, state);
  write_contacts(time, result, state);
  for (const Hand& hand : result.tracked) write_palm(time, hand, state);
  for (const Hand& hand : result.tracked) write_hand(time, hand, nullptr);
  for (const RenderedHand& rendered : result.rendered) write_hand(time, rendered.hand, &rendered);
  write_events(result);
}

void ResultWriter::flush() {
  for (const auto& [name, file] : tables_) file->flush();
}

void ResultWriter::write_bodies(double time) {
  scene_is_new_ = false;
  CsvFile& bodies = table(kBodies);
  for (std::size_t i = 0; i < scene_->bodies.size(); ++i) {
    const Body& body = scene_->bodies[i];
    if (body.fixed) continue;
    bodies << time << body.name << body.mass << body.material.static_friction
           << body.material.dynamic_friction << body.material.restitution << body.bounding_radius
           << half_extents(body);
    const Joint* joint = joint_of(i, *scene_);
    if (joint == nullptr) bodies.skip(4);
    if (joint != nullptr)
      bodies << joint->name << (joint->kind == JointKind::turning ? "turning" : "sliding") << joint->lower
             << joint->upper;
    bodies << frame_;
    bodies.end_row();
  }
}

void ResultWriter::write_objects(double time, const FrameResult& result, const SimulationState& state) {
  CsvFile& objects = table(kObjects);
  for (std::size_t i = 0; i < scene_->bodies.size(); ++i) {
    const Body& body = scene_->bodies[i];
    if (body.fixed) continue;
    const Twist twist = twist_of(body, state.bodies[i]);
    const InteractionLevel level = level_of(i, state);
    const std::optional<Vector3> assist = assist_force(i, result);
    objects << time << body.name << state.bodies[i].pose.position;
    add_quaternion(objects, state.bodies[i].pose.orientation);
    objects << twist.linear << twist.angular << static_cast<int>(level)
            << (level == InteractionLevel::grasp ? 1 : 0) << (assist ? 1 : 0)
            << assist.value_or(Vector3::Zero()) << frame_;
    objects.end_row();
  }
}

void ResultWriter::write_joints(double time, const SimulationState& state) {
  CsvFile& joints = table(kJoints);
  for (std::size_t i = 0; i < scene_->joints.size(); ++i) {
    const JointState& joint = state.joints[i];
    joints << time << scene_->joints[i].name << joint.position << joint_velocity(*scene_, i, state.bodies)
           << joint.effort << frame_;
    joints.end_row();
  }
}

void ResultWriter::write_contacts(double time, const FrameResult& result, const SimulationState& state) {
  CsvFile& contacts = table(kContacts);
  for (const Contact& contact : result.contacts) {
    const Body& body = scene_->bodies[contact.key.body];
    const int capsule = contact.key.capsule;
    const FrictionUse use = friction_use(contact, body.material);
    contacts << time << body.name << hand_id(contact, state) << finger_of(capsule) << bone_of(capsule)
             << static_cast<int>(phase(contact)) << contact.point << contact.normal << contact.depth
             << contact.impulse << contact.force << finger_name(capsule) << bone_name(capsule)
             << phase_name(phase(contact)) << use.normal << use.tangential << use.limit
             << (use.limit > 0.0 ? use.tangential / use.limit : 0.0) << (contact.touching() ? 1 : 0)
             << (contact.friction == Friction::slipping ? 1 : 0) << contact.patch << frame_;
    contacts.end_row();
  }
}

void ResultWriter::write_palm(double time, const Hand& hand, const SimulationState& state) {
  CsvFile& palms = table(kPalms);
  palms << time << hand.id << static_cast<int>(hand.side) << hand.palm.position;
  add_quaternion(palms, hand.palm.orientation);
  palms << hand.confidence << (is_lost(hand, state) ? 1 : 0) << frame_;
  palms.end_row();
}

void ResultWriter::write_hand(double time, const Hand& hand, const RenderedHand* rendered) {
  CsvFile& hands = table(kHands);
  for (int i = 0; i < kCapsules; ++i) {
    if (!hand.has(i)) continue;
    const Capsule& capsule = hand.capsules[static_cast<std::size_t>(i)];
    const bool touching = rendered != nullptr && rendered->touching[static_cast<std::size_t>(i)];
    hands << time << hand.id << static_cast<int>(hand.side) << finger_of(i) << bone_of(i)
          << (rendered != nullptr ? 1 : 0) << capsule.start << capsule.end << capsule.radius
          << (touching ? 1 : 0) << frame_;
    hands.end_row();
  }
}

void ResultWriter::write_events(const FrameResult& result) {
  CsvFile& events = table(kEvents);
  for (const Event& event : result.events) {
    const bool has_body = event.body >= 0;
    events << to_seconds(event.stamp - first_stamp_) << event_name(event.kind)
           << (has_body ? scene_->bodies[static_cast<std::size_t>(event.body)].name : std::string())
           << event.hand_id << frame_
           << (has_body && assist_force(static_cast<std::size_t>(event.body), result) ? 1 : 0);
    events.end_row();
  }
}

}  // namespace mrhi
