#include "urdf.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>
#include <cstdint>
#include <mutex>

#include "../text/untrusted_input.h"
#include "limits.h"
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

void append_utf8(std::uint32_t code, std::string& utf8) {
  const int more = code < 0x80 ? 0 : code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;  // continuation bytes
  constexpr std::uint32_t kFirst[] = {0, 0xC0, 0xE0, 0xF0};
  utf8 += static_cast<char>(kFirst[more] | code >> 6 * more);
  for (int i = more - 1; i >= 0; --i) utf8 += static_cast<char>(0x80 | (code >> 6 * i & 0x3F));
}

/// UTF-8 from ISO-8859-1, in which each byte is the character's code point.
std::string from_latin1(const std::string& text) {
  std::string utf8;
  for (const char c : text) append_utf8(static_cast<unsigned char>(c), utf8);
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
    append_utf8(code, utf8);
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

void check_joints(const std::string& file, const urdf::ModelInterface& model) {
  for (const auto& [name, joint] : model.joints_)
    if (joint->type == urdf::Joint::PLANAR)
      throw SceneError(file + ": joint " + text::quoted(name) +
                       " is planar; allowed: floating (a free body), fixed (a fixture, or a part of the body "
                       "that it is on), revolute, continuous, prismatic");
}

/// A link's place in the tree with all joints at 0.
struct LinkPlace {
  urdf::LinkConstSharedPtr first;  ///< of the links that fixed joints connect to it, or the root
  Pose in_first, in_world;
};
using LinkPlaces = std::map<urdf::LinkConstSharedPtr, LinkPlace>;

bool is_fixed(const urdf::Link& link) {
  return link.parent_joint->type == urdf::Joint::FIXED;
}

LinkPlaces places_in(const urdf::ModelInterface& model) {
  LinkPlaces places{{model.getRoot(), {model.getRoot(), Pose{}, Pose{}}}};
  std::vector<urdf::LinkConstSharedPtr> open{model.getRoot()};
  while (!open.empty()) {
    const LinkPlace above = places.at(open.back());
    const std::vector<urdf::LinkSharedPtr> children = open.back()->child_links;
    open.pop_back();
    for (const urdf::LinkSharedPtr& link : children) {
      const Pose origin = to_pose(link->parent_joint->parent_to_joint_origin_transform);
      const Pose in_world = above.in_world * origin;
      places[link] = is_fixed(*link) ? LinkPlace{above.first, above.in_first * origin, in_world}
                                     : LinkPlace{link, Pose{}, in_world};
      open.push_back(link);
    }
  }
  return places;
}

/// True if there are masses and all are 0: other simulators mark fixtures so.
bool is_weightless(const LinkedBody& body) {
  bool has_mass = false;
  for (const LinkPart& part : body.parts) {
    if (!part.link->inertial) continue;
    if (part.link->inertial->mass != 0.0) return false;
    has_mass = true;
  }
  return has_mass;
}

void read_limits(const urdf::Joint& source, Joint& joint) {
  if (source.type != urdf::Joint::CONTINUOUS && source.limits) {
    joint.lower = source.limits->lower;
    joint.upper = source.limits->upper;
  }
  joint.start = std::min(std::max(0.0, joint.lower), joint.upper);
}

/// Indices of bodies by the names of their first links.
using BodyIndices = std::map<std::string, int>;

/// Sets the parent: the nearest body above. Links without geometry on fixed joints are no bodies.
void set_parent(const UrdfDocument& document, const Scene& scene, const BodyIndices& bodies,
                const urdf::Joint& source, Joint& joint) {
  const urdf::ModelInterface& model = *document.model;
  urdf::LinkConstSharedPtr link = model.getLink(source.parent_link_name);
  joint.in_parent = to_pose(source.parent_to_joint_origin_transform);
  for (; link != model.getRoot() && bodies.count(link->name) == 0; link = link->getParent())
    joint.in_parent = to_pose(link->parent_joint->parent_to_joint_origin_transform) * joint.in_parent;
  if (link == model.getRoot()) return;
  joint.parent = bodies.at(link->name);
  joint.in_parent = scene.bodies[joint.parent].link_in_body * joint.in_parent;
}

Joint read_joint(const std::string& file, const UrdfDocument& document, const Scene& scene,
                 const BodyIndices& bodies, const urdf::Joint& source) {
  const std::string what = file + ": joint " + text::quoted(source.name) + ": ";
  if (!is_name(source.name)) throw SceneError(what + "this name is not allowed; allowed: " + kNameIs);
  Joint joint;
  joint.name = source.name;
  joint.kind = source.type == urdf::Joint::PRISMATIC ? JointKind::sliding : JointKind::turning;
  const Vector3 axis{source.axis.x, source.axis.y, source.axis.z};
  const Range& length = joint_ranges::kAxis;  // beyond it, squares would not be finite
  if (!axis.allFinite() || !length.contains(axis.stableNorm()))
    throw SceneError(what + "axis " + text::vector(axis) + "; allowed: a direction, its length " +
                     length.describe());
  joint.axis = axis.normalized();
  joint.child = bodies.at(source.child_link_name);
  joint.in_child = scene.bodies[joint.child].link_in_body;
  read_limits(source, joint);
  set_parent(document, scene, bodies, source, joint);
  if (source.dynamics) {
    joint.damping = source.dynamics->damping;
    joint.friction = source.dynamics->friction;
  }
  return joint;
}

}  // namespace

UrdfDocument parse_urdf(const std::string& source, const std::string& bytes) {
  std::string xml = is_utf8(bytes) ? bytes : from_utf16(bytes).value_or(from_latin1(bytes));
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

bool LinkedBody::has_shape() const {
  return std::any_of(parts.begin(), parts.end(), [](const LinkPart& part) {
    return !part.link->collision_array.empty() || !part.link->visual_array.empty();
  });
}

bool moves(const urdf::Link& link) {
  if (!link.parent_joint) return false;
  const int type = link.parent_joint->type;
  return type == urdf::Joint::REVOLUTE || type == urdf::Joint::CONTINUOUS || type == urdf::Joint::PRISMATIC;
}

Pose to_pose(const urdf::Pose& pose) {
  const urdf::Rotation& q = pose.rotation;
  return {{pose.position.x, pose.position.y, pose.position.z}, Quaternion(q.w, q.x, q.y, q.z).normalized()};
}

std::vector<LinkedBody> linked_bodies(const std::string& urdf_file, UrdfDocument& document) {
  const urdf::ModelInterface& model = *document.model;
  check_joints(urdf_file, model);
  const urdf::LinkConstSharedPtr root = model.getRoot();
  const LinkPlaces places = places_in(model);
  std::vector<LinkedBody> bodies;
  std::map<urdf::LinkConstSharedPtr, std::size_t> body_of;
  for (const urdf::LinkConstSharedPtr& link : document.links) {
    const LinkPlace& place = places.at(link);
    const bool fixture = place.first == root;
    if (link == root || (!fixture && place.first != link)) continue;
    body_of[link] = bodies.size();
    bodies.push_back({{{link, Pose{}}}, fixture, place.in_world});
  }
  for (const urdf::LinkConstSharedPtr& link : document.links) {
    const LinkPlace& place = places.at(link);
    if (place.first != root && place.first != link)
      bodies[body_of.at(place.first)].parts.push_back({link, place.in_first});
  }
  for (LinkedBody& body : bodies) {
    if (body.fixed || moves(body.link()) || !is_weightless(body)) continue;
    body.fixed = true;
    document.warnings.add("links of mass 0 are fixtures; a mass, or no <inertial>, makes them move",
                          "'" + body.link().name + "'");
  }
  return bodies;
}

std::vector<Joint> read_joints(const std::string& urdf_file, const UrdfDocument& document,
                               const Scene& scene) {
  BodyIndices bodies;
  for (const Body& body : scene.bodies) bodies.emplace(body.name, static_cast<int>(bodies.size()));
  std::vector<Joint> joints;
  for (const urdf::LinkConstSharedPtr& link : document.links) {
    if (moves(*link)) joints.push_back(read_joint(urdf_file, document, scene, bodies, *link->parent_joint));
  }
  return joints;
}

}  // namespace mrhi
