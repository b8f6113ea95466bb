#include "mr_hand_interaction/scene/save_scene.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "../text/files.h"
#include "../text/text.h"
#include "../text/yaml.h"
#include "limits.h"
#include "shape_kinds.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

std::string numbers(const Vector3& v) {
  return text::exact(v.x()) + " " + text::exact(v.y()) + " " + text::exact(v.z());
}

/// Roll, pitch and yaw of a URDF: successive rotations about the fixed axes x, y and z [rad].
Vector3 roll_pitch_yaw(const Quaternion& q) {
  const Matrix3 r = q.toRotationMatrix();
  const double level = std::hypot(r(0, 0), r(1, 0)), pitch = std::atan2(-r(2, 0), level);
  if (level < 1e-9) return {std::atan2(-r(1, 2), r(1, 1)), pitch, 0.0};
  return {std::atan2(r(2, 1), r(2, 2)), pitch, std::atan2(r(1, 0), r(0, 0))};
}

std::string origin(const Pose& pose) {
  return "<origin xyz=\"" + numbers(pose.position) + "\" rpy=\"" + numbers(roll_pitch_yaw(pose.orientation)) +
         "\"/>";
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text)
    result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  return result;
}

/// The shape's XML element. A box has its sizes in one attribute, other shapes in one each.
std::string element(const ShapeKind& kind, const std::vector<double>& sizes) {
  if (kind.name == "box") return "<box size=\"" + numbers(Vector3(sizes[0], sizes[1], sizes[2])) + "\"/>";
  std::string text = "<" + kind.name;
  for (std::size_t i = 0; i < sizes.size(); ++i)
    text += " " + kind.sizes[i] + "=\"" + text::exact(sizes[i]) + "\"";
  return text + "/>";
}

class Writer {
 public:
  Writer(const Scene& scene, const fs::path& file) : scene_(scene), file_(file) {}

  void write() {
    write_urdf();
    texts_.emplace_back(fs::path(file_).replace_extension(".yaml"), yaml());
    texts_.emplace_back(file_, out_.str());  // last: a program that waits for it finds the other files, too
    for (const auto& [file, text] : texts_) {
      std::error_code ignored;
      if (fs::symlink_status(file, ignored).type() != fs::file_type::not_found)
        throw std::invalid_argument(text::quoted(file.string(), 300) +
                                    " is there already; allowed: a file that is not");
    }
    for (const auto& [file, text] : texts_) save(file, text);
  }

 private:
  void write_urdf() {
    out_ << "<?xml version=\"1.0\"?>\n<robot name=\"" << escaped(scene_.name) << "\">\n  <link name=\""
         << root() << "\"/>\n";
    for (const Body& body : scene_.bodies) {
      if (!body.is_operator) write_link(body);
    }
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      const Body& body = scene_.bodies[b];
      if (joint_of(scene_, static_cast<int>(b)) == nullptr && !body.is_operator)
        write_joint(root() + "_to_" + body.name, body.fixed ? "fixed" : "floating", root(), body,
                    body.start * body.link_in_body, "");
    }
    for (const Joint& joint : scene_.joints) write_joint(joint);
    out_ << "</robot>\n";
  }

  /// Name of the root link, which no body has.
  std::string root() const {
    std::string name = "world";
    while (find_body(scene_, name)) name += "_";
    return name;
  }

  void write_link(const Body& body) {
    out_ << "  <link name=\"" << body.name << "\">\n";
    if (!body.fixed) write_inertial(body);
    const Pose to_link = body.link_in_body.inverse();
    for (std::size_t i = 0; i < body.visuals.size(); ++i) {
      const Visual& visual = body.visuals[i];
      out_ << "    <visual>\n      " << origin(to_link * visual.pose) << "\n      <geometry>"
           << geometry(visual.shape, false) << "</geometry>\n";
      if (visual.has_color || !std::holds_alternative<Mesh>(visual.shape)) {
        out_ << "      <material name=\"" << body.name << "_" << i << "\"><color rgba=\"";
        for (std::size_t c = 0; c < 4; ++c) out_ << (c > 0 ? " " : "") << text::exact(double(visual.rgba[c]));
        out_ << "\"/></material>\n";
      }
      out_ << "    </visual>\n";
    }
    for (const PlacedShape& placed : body.shapes) {
      out_ << "    <collision>\n      " << origin(to_link * placed.pose) << "\n      <geometry>"
           << geometry(placed.shape, true) << "</geometry>\n    </collision>\n";
    }
    out_ << "  </link>\n";
  }

  void write_inertial(const Body& body) {
    const Matrix3& i = body.inertia;
    const auto entry = [&](const char* name, double value) {
      out_ << " " << name << "=\"" << text::exact(value) << "\"";
    };
    out_ << "    <inertial>\n      " << origin(body.link_in_body.inverse()) << "\n      <mass value=\""
         << text::exact(body.mass) << "\"/>\n      <inertia";
    entry("ixx", i(0, 0)), entry("ixy", i(0, 1)), entry("ixz", i(0, 2));
    entry("iyy", i(1, 1)), entry("iyz", i(1, 2)), entry("izz", i(2, 2));
    out_ << "/>\n    </inertial>\n";
  }

  std::string geometry(const Shape& shape, bool solid) {
    for (const ShapeKind& kind : shape_kinds())
      if (const auto sizes = kind.sizes_of(shape)) return element(kind, *sizes);
    const Mesh& mesh = std::get<Mesh>(shape);
    if (solid) return "<mesh filename=\"" + mesh_file(mesh) + "\"/>";
    return "<mesh filename=\"" + escaped(mesh.uri) + "\" scale=\"" + numbers(mesh.scale) + "\"/>";
  }

  /// Adds an OBJ file beside the scene with a collision mesh (scaled, or a hull), and returns its name.
  std::string mesh_file(const Mesh& mesh) {
    const std::string name = file_.stem().string() + "_" + std::to_string(++meshes_) + ".obj";
    std::ostringstream obj;
    for (const Vector3& vertex : mesh.triangles->vertices) obj << "v " << numbers(vertex) << "\n";
    for (const auto& t : mesh.triangles->triangles)
      obj << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
    texts_.emplace_back(file_.parent_path() / name, obj.str());
    return name;
  }

  void write_joint(const std::string& name, const char* type, const std::string& parent, const Body& child,
                   const Pose& place, const std::string& more) {
    out_ << "  <joint name=\"" << name << "\" type=\"" << type << "\">\n    <parent link=\"" << parent
         << "\"/>\n    <child link=\"" << child.name << "\"/>\n    " << origin(place) << "\n"
         << more << "  </joint>\n";
  }

  void write_joint(const Joint& joint) {
    const Body& child = scene_.bodies[joint.child];
    const char* type = !joint.turns() ? "prismatic" : joint.is_limited() ? "revolute" : "continuous";
    std::string more = "    <axis xyz=\"" + numbers(joint.axis) + "\"/>\n";
    const auto finite = [](double limit) {
      return text::exact(
          std::min(std::max(limit, joint_ranges::kCoordinate.min), joint_ranges::kCoordinate.max));
    };
    if (joint.is_limited() || !joint.turns())
      more += "    <limit lower=\"" + finite(joint.lower) + "\" upper=\"" + finite(joint.upper) +
              "\" effort=\"0\" velocity=\"0\"/>\n";
    more += "    <dynamics damping=\"" + text::exact(joint.damping) + "\" friction=\"" +
            text::exact(joint.friction) + "\"/>\n";
    if (joint.parent == Joint::kWorld) {
      write_joint(joint.name, type, root(), child, joint.in_parent, more);
    } else {
      const Body& parent = scene_.bodies[joint.parent];
      write_joint(joint.name, type, parent.name, child, parent.link_in_body.inverse() * joint.in_parent,
                  more);
    }
  }

  static YAML::Node vector_list(const Vector3& v) {
    return yaml_list(std::vector<double>{v.x(), v.y(), v.z()});
  }

  std::string yaml() const {
    YAML::Node root;
    root["gravity"] = vector_list(scene_.gravity);
    root["bounds"]["min"] = vector_list(scene_.bounds.min);
    root["bounds"]["max"] = vector_list(scene_.bounds.max);
    for (const Body& body : scene_.bodies) {
      for (const MaterialField& field : material_fields()) {
        if (body.own_material.*field.own)
          root["materials"][body.name][field.name] = text::exact(body.material.*field.value);
      }
      if (body.grasp != GraspMode::parameter) root["grasp"][body.name] = mrhi::name_of(body.grasp);
      const Vector3 &v = body.start_twist.linear, &w = body.start_twist.angular;
      if (!body.fixed && !body.is_operator && !(v.isZero(0.0) && w.isZero(0.0)))
        root["twists"][body.name] = six(v, w);
    }
    for (const Joint& joint : scene_.joints) root["joints"][joint.name] = settings(joint);
    for (const Operator& op : scene_.operators) {
      const YAML::Node node = settings(op);
      if (scene_.operators.size() == 1 && name_of(op.body) == "operator") {
        root["operator"] = node;
      } else {
        root["operators"][name_of(op.body)] = node;
      }
    }
    for (const Tether& tether : scene_.tethers) root["tethers"].push_back(settings(tether));
    return YAML::Dump(root) + "\n";
  }

  static YAML::Node six(const Vector3& a, const Vector3& b) {
    return yaml_list(std::vector<double>{a.x(), a.y(), a.z(), b.x(), b.y(), b.z()});
  }
  const std::string& name_of(int body) const { return scene_.bodies[body].name; }

  YAML::Node settings(const Operator& op) const {
    const Body& body = scene_.bodies[op.body];
    const Pose start = body.start * body.link_in_body;
    YAML::Node node(YAML::NodeType::Map);
    node["mass"] = text::exact(body.mass);
    node["inertia"] = vector_list(body.inertia.diagonal());
    node["centre"] = vector_list(-body.link_in_body.position);
    node["start"] = six(start.position, roll_pitch_yaw(start.orientation));
    node["twist"] = six(body.start_twist.linear, body.start_twist.angular);
    if (op.restraint) node["restraint"] = name_of(*op.restraint);
    node["reach"] = text::exact(op.reach);
    return node;
  }

  YAML::Node settings(const Tether& tether) const {
    const auto in_link = [&](int body, const Vector3& point) {
      return vector_list(scene_.bodies[body].link_in_body.to_local(point));
    };
    YAML::Node node(YAML::NodeType::Map);
    node["body"] = name_of(tether.body);
    node["at"] = in_link(tether.body, tether.at);
    node["fixture"] = name_of(tether.fixture);
    node["anchor"] = in_link(tether.fixture, tether.anchor);
    node["length"] = text::exact(tether.length);
    return node;
  }

  static YAML::Node settings(const Joint& joint) {
    YAML::Node node(YAML::NodeType::Map);
    node["start"] = text::exact(joint.start);
    node["restitution"] = text::exact(joint.restitution);
    if (joint.spring) {
      node["spring"]["stiffness"] = text::exact(joint.spring->stiffness);
      node["spring"]["rest"] = text::exact(joint.spring->rest);
    }
    if (joint.detents) {
      node["detents"]["at"] = yaml_list(joint.detents->at);
      node["detents"]["force"] = text::exact(joint.detents->force);
    }
    if (joint.latch) {
      node["latch"]["at"] = text::exact(joint.latch->at);
      node["latch"]["force"] = text::exact(joint.latch->force);
      node["latch"]["reach"] = text::exact(joint.latch->reach);
    }
    return node;
  }

  /// Writes a file. If that fails, removes all files written so far.
  void save(const fs::path& file, const std::string& text) {
    errno = 0;
    std::ofstream out = file_to_write(file.string());
    out << text << std::flush;
    if (out) return;
    const std::string why = std::strerror(errno);
    out.close();
    std::error_code ignored;
    for (const auto& written : texts_) {
      if (fs::is_regular_file(written.first, ignored)) fs::remove(written.first, ignored);
      if (written.first == file) break;
    }
    throw std::runtime_error("cannot write " + text::quoted(file_.string(), 300) + ": " + why);
  }

  const Scene& scene_;
  const fs::path file_;
  std::ostringstream out_;
  std::vector<std::pair<fs::path, std::string>> texts_;
  int meshes_ = 0;
};

/// Refuses names that are too long for a file system, or have control characters.
void check_path(const fs::path& file, const std::string& shown) {
  constexpr std::size_t kMaxNameBytes = 255, kMaxPathBytes = 4095;
  const std::string& whole = file.native();
  const bool plain = std::none_of(whole.begin(), whole.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) == 0x7f;
  });
  const bool fits = std::all_of(file.begin(), file.end(),
                                [](const fs::path& name) { return name.native().size() <= kMaxNameBytes; });
  if (!plain || !fits || whole.size() > kMaxPathBytes || file.extension() != ".urdf")
    throw std::invalid_argument("file " + shown +
                                " is not allowed; allowed: one that ends in .urdf, each name in it at most " +
                                std::to_string(kMaxNameBytes) + " bytes, without control characters");
  std::error_code ignored;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored))
    throw std::runtime_error("cannot write " + shown + ": its folder is not there; allowed: one that is");
}

}  // namespace

void save_scene(const Scene& scene, const std::string& urdf_file) {
  const fs::path file = urdf_file;
  const std::string shown = text::quoted(urdf_file, 200);
  check_path(file, shown);
  Writer(scene, file).write();
}

}  // namespace mrhi
