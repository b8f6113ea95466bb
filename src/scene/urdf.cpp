#include "urdf.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>
#include <cstdint>
#include <mutex>

#include "../text/text.h"
#include "../text/untrusted_input.h"
#include "limits.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "shape_kinds.h"

namespace mrhi {
namespace {

/// Collects the messages of urdfdom during its lifetime, instead of printing them.
class Complaints : public console_bridge::OutputHandler {
 public:
  Complaints() : lock_(mutex()), previous_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~Complaints() override { console_bridge::useOutputHandler(previous_); }

  void log(const std::string& message, console_bridge::LogLevel level, const char*, int) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR) return;
    text_ += (text_.empty() ? "" : "; ") + message;
  }

  const std::string& text() const { return text_; }

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }

  std::lock_guard<std::mutex> lock_;
  console_bridge::OutputHandler* previous_;
  std::string text_;
};

/// UTF-8 from ISO-8859-1, in which each byte is the character's code point.
std::string from_latin1(const std::string& text) {
  std::string utf8;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80) utf8 += static_cast<char>(0xC0 | (byte >> 6));
    utf8 += static_cast<char>(byte < 0x80 ? byte : 0x80 | (byte & 0x3F));
  }
  return utf8;
}

/// UTF-8 from UTF-16 with a byte order mark, which Windows programs may write; empty for other text.
std::optional<std::string> from_utf16(const std::string& text) {
  const bool little = text.compare(0, 2, "\xFF\xFE") == 0;
  if ((!little && text.compare(0, 2, "\xFE\xFF") != 0) || text.size() % 2 != 0) return std::nullopt;
  const auto unit = [&](std::size_t at) -> std::uint32_t {
    const auto first = static_cast<unsigned char>(text[at]),
               second = static_cast<unsigned char>(text[at + 1]);
    return little ? first | second << 8 : first << 8 | second;
  };
  std::string utf8;
  for (std::size_t at = 2; at < text.size(); at += 2) {
    std::uint32_t code = unit(at);
    if (code >= 0xD800 && code < 0xDC00 && at + 3 < text.size())
      code = 0x10000 + ((code & 0x3FF) << 10 | (unit(at += 2) & 0x3FF));
    const int more = code < 0x80 ? 0 : code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;  // continuation bytes
    constexpr std::uint32_t kFirst[] = {0, 0xC0, 0xE0, 0xF0};
    utf8 += static_cast<char>(kFirst[more] | code >> 6 * more);
    for (int i = more - 1; i >= 0; --i) utf8 += static_cast<char>(0x80 | (code >> 6 * i & 0x3F));
  }
  return utf8;
}

urdf::ModelInterfaceSharedPtr parsed(const std::string& xml) {
  const Complaints complaints;
  urdf::ModelInterfaceSharedPtr model;
  std::string problem;
  try {
    model = urdf::parseURDF(xml);
    problem = complaints.text();  // after some errors urdfdom returns an incomplete model
    if (!model && problem.empty()) problem = "urdfdom refuses it";
  } catch (const std::exception& error) {
    problem = error.what();
  }
  if (!problem.empty())
    throw std::runtime_error("bad URDF: " + text::one_line(problem, 400) + "; allowed: a robot of links (" +
                             shape_kind_names() +
                             ", mesh) joined to one root link by joints that are fixed, floating, revolute, "
                             "continuous or prismatic");
  return model;
}

class Tree {
 public:
  Tree(const std::string& file, const UrdfDocument& document)
      : file_(file), model_(*document.model), root_(*model_.getRoot()) {
    for (const auto& entry : model_.joints_) check_joint(*entry.second);
  }

  bool is_fixed(const urdf::Link& link) const {
    return &link != &root_ && link.parent_joint->type == urdf::Joint::FIXED;
  }
  /// The first link to which fixed joints connect this one, or the root, and the pose relative to it.
  LinkPart held_to(const urdf::LinkConstSharedPtr& link) const {
    LinkPart at{link, Pose{}};
    while (is_fixed(*at.link)) step_up(at);
    return at;
  }
  Pose in_world(const urdf::LinkConstSharedPtr& link) const {
    LinkPart at{link, Pose{}};
    while (at.link.get() != &root_) step_up(at);
    return at.pose;
  }

 private:
  void step_up(LinkPart& at) const {
    at.pose = to_pose(at.link->parent_joint->parent_to_joint_origin_transform) * at.pose;
    at.link = model_.getLink(at.link->parent_joint->parent_link_name);
  }

  void check_joint(const urdf::Joint& joint) const {
    const std::string what = file_ + ": joint '" + text::one_line(joint.name, 60) + "' ";
    const bool known = joint.type == urdf::Joint::FIXED || joint.type == urdf::Joint::FLOATING;
    if (!known && !moves(joint))  // urdfdom refuses all other types
      throw SceneError(what +
                       "is planar; allowed: floating (a free body), fixed (a fixture, or a part of the body "
                       "that it is on), revolute, continuous, prismatic");
  }

  const std::string& file_;
  const urdf::ModelInterface& model_;
  const urdf::Link& root_;
};

/// True if all given masses are 0: other simulators mark fixtures so.
bool is_weightless(const PlacedLink& placed) {
  const auto given = [](const urdf::Link& link) { return link.inertial != nullptr; };
  const auto none = [](const urdf::Link& link) { return !link.inertial || link.inertial->mass == 0.0; };
  const auto& merged = placed.merged;
  return none(*placed.link) &&
         std::all_of(merged.begin(), merged.end(), [&](const LinkPart& part) { return none(*part.link); }) &&
         (given(*placed.link) ||
          std::any_of(merged.begin(), merged.end(), [&](const LinkPart& part) { return given(*part.link); }));
}

bool has_shape(const urdf::Link& link) {
  return !link.collision_array.empty() || !link.visual_array.empty();
}

void read_limits(const urdf::Joint& given, Joint& joint) {
  if (given.type != urdf::Joint::CONTINUOUS && given.limits) {
    joint.lower = given.limits->lower;
    joint.upper = given.limits->upper;
  }
  joint.start = std::min(std::max(0.0, joint.lower), joint.upper);
}

/// Sets the parent: the nearest body above. Links without geometry on fixed joints are no bodies.
void set_parent(const UrdfDocument& document, const Scene& scene, const urdf::Joint& given, Joint& joint) {
  joint.in_parent = to_pose(given.parent_to_joint_origin_transform);
  urdf::LinkConstSharedPtr link = document.model->getLink(given.parent_link_name);
  while (link != document.model->getRoot()) {
    const std::optional<int> body = find_body(scene, link->name);
    if (body) {
      joint.parent = *body;
      joint.in_parent = scene.bodies[*body].link_in_body * joint.in_parent;
      return;
    }
    joint.in_parent = to_pose(link->parent_joint->parent_to_joint_origin_transform) * joint.in_parent;
    link = document.model->getLink(link->parent_joint->parent_link_name);
  }
}

Joint read_joint(const std::string& file, const UrdfDocument& document, const Scene& scene,
                 const urdf::Joint& given) {
  const std::string what = file + ": joint '" + text::one_line(given.name, 60) + "': ";
  if (!is_name(given.name)) throw SceneError(what + "this name is not allowed; allowed: " + kNameIs);
  Joint joint;
  joint.name = given.name;
  joint.kind = given.type == urdf::Joint::PRISMATIC ? JointKind::sliding : JointKind::turning;
  const Vector3 axis{given.axis.x, given.axis.y, given.axis.z};
  const Range& length = joint_ranges::kAxis;  // beyond it, squares would not be finite
  if (!axis.allFinite() || !length.contains(axis.stableNorm()))
    throw SceneError(what + "axis " + text::vector(axis) + "; allowed: a direction, its length " +
                     length.describe());
  joint.axis = axis.normalized();
  joint.child = *find_body(scene, given.child_link_name);
  joint.in_child = scene.bodies[joint.child].link_in_body;
  read_limits(given, joint);
  set_parent(document, scene, given, joint);
  if (given.dynamics) {
    joint.damping = given.dynamics->damping;
    joint.friction = given.dynamics->friction;
  }
  return joint;
}

}  // namespace

UrdfDocument parse_urdf(const std::string& source, const std::string& given) {
  std::string xml = is_utf8(given) ? given : from_utf16(given).value_or(from_latin1(given));
  xml.erase(xml.find_last_not_of('\0') + 1);  // C programs may write the terminating zero
  if (const auto wrong = xml_danger(xml)) throw SceneError(source + ": bad URDF: " + *wrong);
  UrdfDocument document;
  try {
    NormalUrdf normal = normal_urdf(xml, document.warnings);
    document.model = parsed(normal.xml);
    document.friction = std::move(normal.friction);
    for (const std::string& name : normal.links) document.links.push_back(document.model->getLink(name));
  } catch (const std::runtime_error& error) {
    throw SceneError(source + ": " + error.what());
  }
  return document;
}

bool has_shape(const PlacedLink& placed) {
  return has_shape(*placed.link) || std::any_of(placed.merged.begin(), placed.merged.end(),
                                                [](const LinkPart& part) { return has_shape(*part.link); });
}

bool moves(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS ||
         joint.type == urdf::Joint::PRISMATIC;
}

Pose to_pose(const urdf::Pose& pose) {
  const urdf::Rotation& q = pose.rotation;
  return {{pose.position.x, pose.position.y, pose.position.z}, Quaternion(q.w, q.x, q.y, q.z).normalized()};
}

std::vector<PlacedLink> place_links(const std::string& urdf_file, UrdfDocument& document) {
  const Tree tree(urdf_file, document);
  const urdf::LinkConstSharedPtr root = document.model->getRoot();
  std::vector<PlacedLink> placed;
  std::map<const urdf::Link*, std::size_t> bodies;
  for (const urdf::LinkConstSharedPtr& link : document.links) {
    const bool fixture = link != root && tree.held_to(link).link == root;
    if (link == root || (tree.is_fixed(*link) && !fixture)) continue;
    bodies[link.get()] = placed.size();
    placed.push_back({link, fixture, tree.in_world(link), {}});
  }
  for (const urdf::LinkConstSharedPtr& link : document.links) {
    const LinkPart held = tree.held_to(link);
    if (held.link == root || held.link == link) continue;
    placed[bodies.at(held.link.get())].merged.push_back({link, held.pose});
  }
  for (PlacedLink& body : placed) {
    if (body.fixed || moves(*body.link->parent_joint) || !is_weightless(body)) continue;
    body.fixed = true;
    document.warnings.add("links of mass 0 are fixtures; a mass, or no <inertial>, makes them move",
                          "'" + body.link->name + "'");
  }
  return placed;
}

std::vector<Joint> read_joints(const std::string& urdf_file, const UrdfDocument& document,
                               const Scene& scene) {
  std::vector<Joint> joints;
  for (const urdf::LinkConstSharedPtr& link : document.links) {
    if (link->parent_joint && moves(*link->parent_joint))
      joints.push_back(read_joint(urdf_file, document, scene, *link->parent_joint));
  }
  return joints;
}

}  // namespace mrhi
