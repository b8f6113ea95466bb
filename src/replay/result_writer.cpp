#include "result_writer.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>

#include "../simulation/contact_phase.h"
#include "../text/files.h"
#include "dictionary.h"

namespace mrhi {
namespace {

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

const char* event_name(EventKind kind) {
  switch (kind) {
    case EventKind::hover_begin:
      return "HOVER_BEGIN";
    case EventKind::hover_end:
      return "HOVER_END";
    case EventKind::contact_begin:
      return "CONTACT_BEGIN";
    case EventKind::contact_end:
      return "CONTACT_END";
    case EventKind::grasp_begin:
      return "GRASP_BEGIN";
    case EventKind::grasp_end:
      return "GRASP_END";
    case EventKind::hand_lost:
      return "HAND_LOST";
    case EventKind::hand_found:
      return "HAND_FOUND";
    case EventKind::out_of_bounds:
      return "OUT_OF_BOUNDS";
    case EventKind::joint_limit:
      return "JOINT_LIMIT";
    case EventKind::detent:
      return "DETENT";
    case EventKind::latch_open:
      return "LATCH_OPEN";
  }
  return "";
}

struct ResultWriter::Tables {
  explicit Tables(const std::string& folder)
      : objects(made_folder(folder) + "/objects.csv", table_of("objects.csv").header()),
        contacts(folder + "/contacts.csv", table_of("contacts.csv").header()),
        hands(folder + "/hands.csv", table_of("hands.csv").header()),
        events(folder + "/events.csv", table_of("events.csv").header()),
        frames(folder + "/frames.csv", table_of("frames.csv").header()),
        palms(folder + "/palms.csv", table_of("palms.csv").header()),
        bodies(folder + "/bodies.csv", table_of("bodies.csv").header()) {}

  CsvFile objects, contacts, hands, events, frames, palms, bodies;
  std::optional<CsvFile> joints;  // once the scene has any
};

ResultWriter::ResultWriter(const std::string& folder, const Scene& scene)
    : folder_(folder), scene_(&scene), tables_(std::make_unique<Tables>(folder)) {
  const std::string path = folder + "/schema.json";
  std::ofstream schema = file_to_write(path);
  schema << schema_json() << std::flush;
  if (!schema) throw std::runtime_error("cannot write " + path);
  follow(scene);
}
ResultWriter::~ResultWriter() = default;

void ResultWriter::follow(const Scene& scene) {
  scene_ = &scene;
  scene_is_new_ = true;
  if (!scene.joints.empty() && !tables_->joints)
    tables_->joints.emplace(folder_ + "/joints.csv", table_of("joints.csv").header());
}

void ResultWriter::write(const FrameResult& result, const SimulationState& state, const Vector3& gravity) {
  frame_ = begun_ ? frame_ + 1 : 0;
  if (!begun_) first_stamp_ = result.stamp;
  begun_ = true;
  const double time = to_seconds(result.stamp - first_stamp_);
  write_frame(time, result.stamp, gravity);
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
  Tables& t = *tables_;
  for (CsvFile* file : {&t.objects, &t.contacts, &t.hands, &t.events, &t.frames, &t.palms, &t.bodies})
    file->flush();
  if (t.joints) t.joints->flush();
}

void ResultWriter::write_frame(double time, Nanoseconds stamp, const Vector3& gravity) {
  tables_->frames << time << frame_ << stamp << gravity;
  tables_->frames.end_row();
}

void ResultWriter::write_bodies(double time) {
  scene_is_new_ = false;
  CsvFile& bodies = tables_->bodies;
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
  for (std::size_t i = 0; i < scene_->bodies.size(); ++i) {
    const Body& body = scene_->bodies[i];
    if (body.fixed) continue;
    const Twist twist = twist_of(body, state.bodies[i]);
    const InteractionLevel level = level_of(i, state);
    const std::optional<Vector3> assist = assist_force(i, result);
    tables_->objects << time << body.name << state.bodies[i].pose.position;
    add_quaternion(tables_->objects, state.bodies[i].pose.orientation);
    tables_->objects << twist.linear << twist.angular << static_cast<int>(level)
                     << (level == InteractionLevel::grasp ? 1 : 0) << (assist ? 1 : 0)
                     << assist.value_or(Vector3::Zero()) << frame_;
    tables_->objects.end_row();
  }
}

void ResultWriter::write_joints(double time, const SimulationState& state) {
  for (std::size_t i = 0; i < scene_->joints.size(); ++i) {
    const JointState& joint = state.joints[i];
    *tables_->joints << time << scene_->joints[i].name << joint.position
                     << joint_velocity(*scene_, i, state.bodies) << joint.effort << frame_;
    tables_->joints->end_row();
  }
}

void ResultWriter::write_contacts(double time, const FrameResult& result, const SimulationState& state) {
  for (const Contact& contact : result.contacts) {
    const Body& body = scene_->bodies[contact.key.body];
    const int capsule = contact.key.capsule;
    const FrictionUse use = friction_use(contact, body.material);
    tables_->contacts << time << body.name << hand_id(contact, state) << finger_of(capsule)
                      << bone_of(capsule) << static_cast<int>(phase(contact)) << contact.point
                      << contact.normal << contact.depth << contact.impulse << contact.force
                      << finger_name(capsule) << bone_name(capsule) << phase_name(phase(contact))
                      << use.normal << use.tangential << use.limit
                      << (use.limit > 0.0 ? use.tangential / use.limit : 0.0) << (contact.touching() ? 1 : 0)
                      << (contact.friction == Friction::slipping ? 1 : 0) << contact.patch << frame_;
    tables_->contacts.end_row();
  }
}

void ResultWriter::write_palm(double time, const Hand& hand, const SimulationState& state) {
  tables_->palms << time << hand.id << static_cast<int>(hand.side) << hand.palm.position;
  add_quaternion(tables_->palms, hand.palm.orientation);
  tables_->palms << hand.confidence << (is_lost(hand, state) ? 1 : 0) << frame_;
  tables_->palms.end_row();
}

void ResultWriter::write_hand(double time, const Hand& hand, const RenderedHand* rendered) {
  for (int i = 0; i < kCapsules; ++i) {
    if (!hand.has(i)) continue;
    const Capsule& capsule = hand.capsules[static_cast<std::size_t>(i)];
    const bool touching = rendered != nullptr && rendered->touching[static_cast<std::size_t>(i)];
    tables_->hands << time << hand.id << static_cast<int>(hand.side) << finger_of(i) << bone_of(i)
                   << (rendered != nullptr ? 1 : 0) << capsule.start << capsule.end << capsule.radius
                   << (touching ? 1 : 0) << frame_;
    tables_->hands.end_row();
  }
}

void ResultWriter::write_events(const FrameResult& result) {
  for (const Event& event : result.events) {
    const bool has_body = event.body >= 0;
    tables_->events << to_seconds(event.stamp - first_stamp_) << event_name(event.kind)
                    << (has_body ? scene_->bodies[static_cast<std::size_t>(event.body)].name : std::string())
                    << event.hand_id << frame_
                    << (has_body && assist_force(static_cast<std::size_t>(event.body), result) ? 1 : 0);
    tables_->events.end_row();
  }
}

}  // namespace mrhi
