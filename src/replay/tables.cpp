#include "tables.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "../scene/limits.h"
#include "../simulation/contact_phase.h"
#include "../text/files.h"
#include "../text/text.h"
#include "generated_tables.h"

namespace mrhi {
namespace {

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

/// Parses tables.txt: a line "FILE: meaning of a row", then one "name|unit|meaning" per column. Columns of a
/// vector share a line: "px py pz|m|position" are "position, x" to "position, z".
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

Json json_of(const Column& column) {
  std::vector<std::pair<std::string, Json>> members{{"name", column.name}, {"meaning", column.meaning}};
  if (!column.unit.empty()) members.insert(members.begin() + 1, {"unit", column.unit});
  return members;
}

std::string made_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (std::filesystem::is_directory(folder)) return folder;
  throw std::runtime_error("cannot make folder " + folder + (error ? ": " + error.message() : ""));
}

/// The highest level of interaction with any hand.
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

}  // namespace

std::string Table::header() const {
  return text::joined(text::names_of(columns), ",");
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
  std::vector<std::pair<std::string, Json>> schema;
  for (const Table& table : tables()) {
    std::vector<Json> columns;
    for (const Column& column : table.columns) columns.push_back(json_of(column));
    schema.emplace_back(table.file, Json({{"a row for", table.rows}, {"columns", columns}}, "\n    "));
  }
  return Json(schema, "\n  ").text + "\n";
}

const char* event_name(EventKind kind) {
  static const char* const names[] = {"HOVER_BEGIN",   "HOVER_END",   "CONTACT_BEGIN", "CONTACT_END",
                                      "GRASP_BEGIN",   "GRASP_END",   "HAND_LOST",     "HAND_FOUND",
                                      "OUT_OF_BOUNDS", "JOINT_LIMIT", "DETENT",        "LATCH_OPEN"};
  return names[static_cast<std::size_t>(kind)];
}

ResultWriter::ResultWriter(const std::string& folder, const Scene& scene)
    : folder_(made_folder(folder)), scene_(&scene) {
  write_file(folder + "/schema.json", schema_json());
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
  table(kFrames).row(time, frame_, result.stamp, gravity);
  if (scene_is_new_) write_bodies(time);
  write_objects(time, result, state);
  if (!scene_->joints.empty()) write_joints(time, state);
  write_contacts(time, result, state);
  for (const Hand& hand : result.tracked) write_palm(time, hand, state);
  for (const Hand& hand : result.tracked) write_hand(time, hand, nullptr);
  for (const RenderedHand& rendered : result.rendered) write_hand(time, rendered.hand, &rendered);
  write_events(result.events, result);
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
    const Joint* joint = joint_of(*scene_, static_cast<int>(i));
    if (joint == nullptr) bodies.skip(4);
    if (joint != nullptr) bodies << joint->name << joint->kind_name() << joint->lower << joint->upper;
    bodies << frame_;
    bodies.end_row();
  }
}

void ResultWriter::write_objects(double time, const FrameResult& result, const SimulationState& state) {
  for (std::size_t i = 0; i < scene_->bodies.size(); ++i) {
    const Body& body = scene_->bodies[i];
    if (body.fixed) continue;
    const Pose& pose = state.bodies[i].pose;
    const Twist twist = twist_of(body, state.bodies[i]);
    const InteractionLevel level = level_of(i, state);
    const std::optional<GraspSupport> assist = assist_on(i, result);
    table(kObjects).row(time, body.name, pose.position, pose.orientation, twist.linear, twist.angular,
                        static_cast<int>(level), level == InteractionLevel::grasp, assist.has_value(),
                        assist.value_or(GraspSupport{}).force, frame_,
                        assist.value_or(GraspSupport{}).torque);
  }
}

void ResultWriter::write_joints(double time, const SimulationState& state) {
  for (std::size_t i = 0; i < scene_->joints.size(); ++i) {
    const JointState& joint = state.joints[i];
    table(kJoints).row(time, scene_->joints[i].name, joint.position, joint_velocity(*scene_, i, state.bodies),
                       joint.effort, frame_);
  }
}

void ResultWriter::write_contacts(double time, const FrameResult& result, const SimulationState& state) {
  for (const Contact& contact : result.contacts) {
    const Body& body = scene_->bodies[contact.key.body];
    const int capsule = contact.key.capsule;
    const FrictionUse use = friction_use(contact, body.material);
    const double utilisation = use.limit > 0.0 ? use.tangential / use.limit : 0.0;
    table(kContacts).row(time, body.name, hand_id(contact, state), finger_of(capsule), bone_of(capsule),
                         static_cast<int>(phase(contact)), contact.point, contact.normal, contact.depth,
                         contact.impulse, contact.force, finger_name(capsule), bone_name(capsule),
                         phase_name(phase(contact)), use.normal, use.tangential, use.limit, utilisation,
                         contact.touching(), contact.friction != Friction::sticking, contact.patch, frame_,
                         contact.peak_force, contact.torque);
  }
}

void ResultWriter::write_palm(double time, const Hand& hand, const SimulationState& state) {
  table(kPalms).row(time, hand.id, static_cast<int>(hand.side), hand.palm.position, hand.palm.orientation,
                    hand.confidence, is_lost(hand, state), frame_);
}

void ResultWriter::write_hand(double time, const Hand& hand, const RenderedHand* rendered) {
  for (int i = 0; i < kCapsules; ++i) {
    if (!hand.has(i)) continue;
    const Capsule& capsule = hand.capsules[i];
    const bool touching = rendered != nullptr && rendered->touching[i];
    table(kHands).row(time, hand.id, static_cast<int>(hand.side), finger_of(i), bone_of(i),
                      rendered != nullptr, capsule.start, capsule.end, capsule.radius, touching, frame_);
  }
}

void ResultWriter::write_events(const std::vector<Event>& events, const FrameResult& now) {
  for (const Event& event : events) {
    const auto body = static_cast<std::size_t>(event.body);
    const bool has_body = event.body >= 0;
    table(kEvents).row(to_seconds(event.stamp - first_stamp_), event_name(event.kind),
                       has_body ? scene_->bodies[body].name : std::string(), event.hand_id, frame_,
                       has_body && assist_on(body, now).has_value());
  }
}

}  // namespace mrhi
