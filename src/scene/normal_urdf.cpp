#include "urdf.h"

#include <cmath>
#include <set>
#include <stdexcept>

#include "limits.h"
#include "shape_kinds.h"
#include "urdf_xml.h"

namespace mrhi {
namespace {

using namespace urdf_xml;

/// Writes a URDF again, element by element, in the form that urdfdom reads.
class Normaliser {
 public:
  Normaliser(const XMLElement& robot, Warnings& warnings)
      : robot_(robot),
        warnings_(warnings),
        links_(robot, "link", warnings),
        joints_(robot, "joint", warnings),
        out_(nullptr, true) {}

  NormalUrdf make() {
    check_tree();
    read_friction();
    find_materials(robot_);
    open("robot", {{"name", "scene"}});
    each(robot_, "link", [&](const XMLElement& link) { write_link(link); });
    write_world();
    each(robot_, "joint", [&](const XMLElement& joint) { write_joint(joint); });
    out_.CloseElement();
    result_.xml = out_.CStr();
    return std::move(result_);
  }

 private:
  void open(const char* name, const Attributes& attributes) {
    out_.OpenElement(name);
    for (const auto& [key, value] : attributes) out_.PushAttribute(key, value.c_str());
  }
  void write(const char* name, const Attributes& attributes) {
    open(name, attributes);
    out_.CloseElement();
  }

  /// Name of a joint's "parent" or "child"; empty: the joint has none.
  std::string link_of(const XMLElement& joint, const char* end) const {
    return links_.of(attribute(joint.FirstChildElement(end), "link"));
  }

  /// Refuses loops and second parents: urdfdom never frees the links of a loop.
  void check_tree() {
    each(robot_, "joint", [&](const XMLElement& joint) {
      const std::string parent = link_of(joint, "parent"), child = link_of(joint, "child");
      if (parent.empty() || child.empty() || parents_.emplace(child, parent).second) return;
      throw std::runtime_error("joint " + text::quoted(attribute(&joint, "name")) +
                               " is a second parent of link " + text::quoted(child) +
                               "; allowed: one joint to each link");
    });
    std::set<std::string> checked;
    for (const auto& entry : parents_) {
      std::set<std::string> path;
      for (auto link = parents_.find(entry.first); link != parents_.end() && checked.count(link->first) == 0;
           link = parents_.find(link->second))
        if (!path.insert(link->first).second)
          throw std::runtime_error("bad URDF: link " + text::quoted(link->first) +
                                   " is in a loop of joints; allowed: a tree of links");
      checked.merge(path);
    }
  }

  /// From <gazebo reference="LINK">, <contact_coefficients mu="">, SDF's <surface>, PyBullet's <contact> and
  /// Drake's proximity properties; the last one wins.
  void read_friction() {
    const auto read = [&](const XMLElement& element, const char* name, const char* link) {
      const XMLElement* found = find_within(element, name);
      const std::string mu = attribute(found, "mu");  // URDF's tutorial has 0, which no program reads
      if (const auto value = text::to_number(mu.empty() ? value_of(found) : mu);
          value && (mu.empty() || *value > 0.0))
        result_.friction[links_.of(attribute(&element, link))] = *value;
    };
    each(robot_, "gazebo", [&](const XMLElement& gazebo) {
      for (const char* name : {"mu", "mu1"}) read(gazebo, name, "reference");
    });
    each(robot_, "link", [&](const XMLElement& link) {
      for (const char* name : {"contact_coefficients", "mu", "drake:mu_static", "lateral_friction"})
        read(link, name, "name");
    });
  }

  static bool is_defined(const XMLElement& material) {
    return material.FirstChildElement("color") != nullptr || material.FirstChildElement("texture") != nullptr;
  }

  /// A named material may be defined in any place of the file.
  void find_materials(const XMLElement& element) {
    each(element, "material", [&](const XMLElement& material) {
      if (is_defined(material)) materials_.emplace(attribute(&material, "name"), &material);
    });
    each(element, "link", [&](const XMLElement& link) {
      each(link, "visual", [&](const XMLElement& visual) { find_materials(visual); });
    });
  }

  void write_link(const XMLElement& link) {
    const std::string name = links_.of(attribute(&link, "name")),
                      where = "link " + text::quoted(attribute(&link, "name"));
    result_.links.push_back(name);
    open("link", {{"name", name}});
    write_inertial(link, where + " inertial");
    for (const std::string kind : {"visual", "collision"})
      each(link, kind.c_str(), [&](const XMLElement& element) {
        const XMLElement* geometry = element.FirstChildElement("geometry");
        if (geometry == nullptr || geometry->FirstChildElement() == nullptr)
          return warnings_.add("visuals and collisions without a shape are left out", where + " " + kind);
        if (geometry->FirstChildElement()->NextSiblingElement() != nullptr ||
            geometry->NextSiblingElement("geometry") != nullptr)
          warnings_.add("a visual or collision has one shape: its others are left out", where + " " + kind);
        open(kind.c_str(), {});
        write_origin(element, where + " " + kind);
        write_geometry(*geometry, where + " " + kind);
        if (const XMLElement* material = element.FirstChildElement("material"))
          if (kind == "visual") write_material(*material, where);
        out_.CloseElement();
      });
    out_.CloseElement();
  }

  static const XMLElement* mass_of(const XMLElement& link) {
    const XMLElement* inertial = link.FirstChildElement("inertial");
    return inertial == nullptr ? nullptr : inertial->FirstChildElement("mass");
  }

  /// An inertia of zeros means that of the shapes; urdfdom requires the element.
  void write_inertial(const XMLElement& link, const std::string& where) {
    const XMLElement *inertial = link.FirstChildElement("inertial"), *mass = mass_of(link);
    if (mass == nullptr) return;
    open("inertial", {});
    write_origin(*inertial, where);
    const std::string value = value_of(mass);
    if (value.empty())
      throw std::runtime_error(where +
                               ": mass has no value; allowed: a number of kg, or no <mass> for that of "
                               "the volume");
    write("mass", {{"value", value}});
    const XMLElement* inertia = inertial->FirstChildElement("inertia");
    Attributes moments;
    for (const char* moment : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"})
      moments.emplace_back(moment, attribute(inertia, moment, "0"));
    write("inertia", moments);
    out_.CloseElement();
  }

  /// The three numbers of an attribute, as urdfdom separates them; fewer if there are fewer.
  std::string vector(const XMLElement* element, const char* name, const std::string& where) {
    std::vector<std::string> words = words_of(attribute(element, name));
    if (words.size() > 3) {
      warnings_.add("vectors of more than three numbers: the first three are taken",
                    where + " " + name + " " + text::quoted(attribute(element, name)));
      words.resize(3);
    }
    return text::joined(words, " ");
  }

  void write_origin(const XMLElement& element, const std::string& where) {
    const XMLElement* origin = element.FirstChildElement("origin");
    if (origin == nullptr) return;
    Attributes attributes;
    for (const char* part : {"xyz", "rpy"})
      if (const std::string value = vector(origin, part, where); !value.empty())
        attributes.emplace_back(part, value);
    for (const std::string& word : words_of(attribute(origin, "rpy"))) {
      constexpr double kTurn = 6.2832;
      const double angle = std::abs(text::to_number(word).value_or(0.0));
      if (!(angle <= joint_ranges::kCoordinate.max))
        throw std::runtime_error(where + ": rpy " + text::quoted(attribute(origin, "rpy")) +
                                 " is not allowed; allowed: three angles, each " +
                                 joint_ranges::kCoordinate.describe() + " rad");
      if (angle > kTurn)
        warnings_.add("angles of more than a turn, which URDF takes in radians",
                      where + " rpy " + text::quoted(attribute(origin, "rpy")));
    }
    write("origin", attributes);
  }

  /// Shapes that urdfdom does not know pass it as the file name of a mesh.
  void write_geometry(const XMLElement& geometry, const std::string& where) {
    const XMLElement* shape = geometry.FirstChildElement();
    const std::string kind = shape->Name();
    const ShapeKind* known = find_shape_kind(kind);
    const bool hull = kind == "mesh" && is_followed_by_hull(geometry, *shape);
    for (const XMLNode* node = geometry.FirstChild(); node != nullptr && !hull; node = node->NextSibling())
      if (is_hull_comment(*node)) throw std::runtime_error("bad URDF: <!-- hull --> stands behind no mesh");
    open("geometry", {});
    if (kind == "mesh") {
      write_mesh(*shape, hull, where);
    } else if (kind == "box") {
      write("box", {{"size", vector(shape, "size", where)}});
    } else if (known == nullptr || kind == "sphere" || kind == "cylinder") {
      shape->Accept(&out_);
    } else {
      std::string name = ":shape:" + kind;
      for (const std::string& size : known->sizes) {
        const std::string value = attribute(shape, size.c_str(), "?");
        name += " " + (words_of(value).size() == 1 ? value : "?");
      }
      write("mesh", {{"filename", name}});
    }
    out_.CloseElement();
  }

  /// <mesh/><!-- hull -->, in the geometry or directly behind it.
  static bool is_followed_by_hull(const XMLElement& geometry, const XMLElement& mesh) {
    const auto candidates = {mesh.NextSibling(), mesh.FirstChild(), geometry.NextSibling()};
    return std::any_of(candidates.begin(), candidates.end(),
                       [](const XMLNode* node) { return node != nullptr && is_hull_comment(*node); });
  }

  void write_mesh(const XMLElement& mesh, bool hull, const std::string& where) {
    Attributes attributes{{"filename", (hull ? kHullPrefix : "") + trimmed(attribute(&mesh, "filename"))}};
    std::string scale = vector(&mesh, "scale", where);
    if (words_of(scale).size() == 1) {
      warnings_.add("a scale of one number is that of all axes", text::quoted(scale));
      scale += " " + scale + " " + scale;
    }
    if (!scale.empty()) attributes.emplace_back("scale", scale);
    write("mesh", attributes);
  }

  /// Each visual has a material of its own, so that none is defined twice.
  void write_material(const XMLElement& element, const std::string& where) {
    const std::string name = attribute(&element, "name");
    const auto named = materials_.find(name);
    if (!is_defined(element) && named == materials_.end()) {
      if (!name.empty())
        warnings_.add("materials without a color in this file are drawn grey",
                      text::quoted(name) + " of " + where);
      return;
    }
    const XMLElement& material = is_defined(element) ? element : *named->second;
    open("material", {{"name", "material_" + std::to_string(++materials_written_)}});
    if (const XMLElement* color = material.FirstChildElement("color"))
      write("color", {{"rgba", rgba(attribute(color, "rgba"), where)}});
    if (const XMLElement* texture = material.FirstChildElement("texture")) texture->Accept(&out_);
    out_.CloseElement();
  }

  /// Divides whole numbers of 0 to 255 by 255, and cuts off what rounding has above 1. A text that is no
  /// numbers, like #ff0000, is grey. Other numbers stay as they are, and are refused later.
  std::string rgba(const std::string& color, const std::string& where) {
    constexpr double kRounding = 1e-3;
    const std::vector<std::string> words = words_of(color);
    std::vector<double> parts;
    for (const std::string& word : words) {
      const std::optional<double> number = text::to_number(word);
      if (!number) {
        warnings_.add("colors that are no numbers are drawn grey", text::quoted(color) + " of " + where);
        return "0.7 0.7 0.7 1";
      }
      parts.push_back(*number);
    }
    const auto is_byte = [](double part) { return part >= 0.0 && part <= 255.0 && part == std::floor(part); };
    const auto is_ratio = [](double part) { return part >= 0.0 && part <= 1.0 + kRounding; };
    const bool has_opacity = parts.size() == 4, ratios = std::all_of(parts.begin(), parts.end(), is_ratio);
    const bool bytes = !ratios && std::all_of(parts.begin(), parts.end() - has_opacity, is_byte) &&
                       (!has_opacity || is_byte(parts[3]) || is_ratio(parts[3]));
    if (!ratios && !bytes) return text::joined(words, " ");
    if (bytes) warnings_.add("colors of 0 to 255 are divided by 255", text::quoted(color) + " of " + where);
    std::vector<std::string> scaled;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const double full = bytes && (i < 3 || parts[i] > 1.0) ? 255.0 : 1.0;
      scaled.push_back(text::exact(std::min(1.0, parts[i] / full)));
    }
    return text::joined(scaled, " ");
  }

  void write_joint(const XMLElement& joint) {
    const std::string name = attribute(&joint, "name"), what = text::quoted(name);
    std::string type = attribute(&joint, "type");
    const Attributes limit =
        type == "revolute" || type == "prismatic" ? read_limit(joint, what, type) : Attributes();
    open("joint", {{"name", joints_.of(name)}, {"type", type}});
    for (const char* end : {"parent", "child"})
      if (joint.FirstChildElement(end) != nullptr) write(end, {{"link", link_of(joint, end)}});
    write_origin(joint, "joint " + what);
    const std::string axis = vector(joint.FirstChildElement("axis"), "xyz", "joint " + what + " axis");
    if (!axis.empty()) write("axis", {{"xyz", axis}});
    if (!limit.empty()) write("limit", limit);
    if (const XMLElement* dynamics = joint.FirstChildElement("dynamics"))
      write("dynamics", {{"damping", attribute(dynamics, "damping", "0")},
                         {"friction", attribute(dynamics, "friction", "0")}});
    if (joint.FirstChildElement("mimic") != nullptr)
      warnings_.add("joints move freely, as <mimic> is not followed", what);
    out_.CloseElement();
  }

  /// Limits within kCoordinate, and the joint's type that fits them. Effort and velocity are 0: urdfdom
  /// requires them, and nothing uses them.
  Attributes read_limit(const XMLElement& joint, const std::string& what, std::string& type) {
    const XMLElement* limit = joint.FirstChildElement("limit");
    std::string lower = attribute(limit, "lower", "0"), upper = attribute(limit, "upper", "0");
    const auto number = [](const std::string& text) {  // nan if it is no number, which urdfdom refuses
      const double value = mrhi::text::to_number(text).value_or(NAN);
      return std::min(std::max(value, joint_ranges::kCoordinate.min), joint_ranges::kCoordinate.max);
    };
    double low = number(lower), high = number(upper);
    const bool none = attribute(limit, "lower").empty() && attribute(limit, "upper").empty();
    if (none || low > high) {
      warnings_.add("joints move without limits",
                    what + (none ? ", which has none" : ", lower " + lower + " above upper " + upper));
      if (type == "revolute") type = "continuous";
      low = joint_ranges::kCoordinate.min, high = joint_ranges::kCoordinate.max;
    } else if (low == high) {
      warnings_.add("joints with equal limits are fixed", what);
      if (low == 0.0) {
        type = "fixed";
        return {};
      }
      high += 1e-6 * std::max(1.0, std::abs(low));
    }
    if (!std::isnan(low)) lower = text::exact(low);
    if (!std::isnan(high)) upper = text::exact(high);
    return {{"lower", lower}, {"upper", upper}, {"effort", "0"}, {"velocity", "0"}};
  }

  static bool is_empty(const XMLElement& link) {
    return link.FirstChildElement("visual") == nullptr && link.FirstChildElement("collision") == nullptr &&
           !(text::to_number(attribute(mass_of(link), "value")).value_or(0.0) > 0.0);
  }

  /// Adds the world that joints name, if it is no link of the file; otherwise a world above a root that is a
  /// body. A root with a shape or a mass is a free body, and so are links that are all fixed on an empty
  /// root. The name "world" makes them fixtures.
  void write_world() {
    bool has_world = false, all_fixed = true;
    each(robot_, "joint",
         [&](const XMLElement& joint) { all_fixed = all_fixed && attribute(&joint, "type") == "fixed"; });
    std::vector<const XMLElement*> roots;
    each(robot_, "link", [&](const XMLElement& link) {
      has_world = has_world || attribute(&link, "name") == "world";
      if (parents_.count(links_.of(attribute(&link, "name"))) == 0) roots.push_back(&link);
    });
    const bool needs_world = std::any_of(parents_.begin(), parents_.end(),
                                         [](const auto& entry) { return entry.second == "world"; });
    if (needs_world && !has_world) return write("link", {{"name", "world"}});
    if (roots.size() != 1) return;  // urdfdom refuses it
    const std::string root = links_.of(attribute(roots[0], "name"));
    if (is_empty(*roots[0])) {
      if (root == "world" || parents_.empty() || !all_fixed) return;
      warnings_.add(
          "links on fixed joints are one free body; a root that is named 'world' makes them fixtures",
          text::quoted(attribute(roots[0], "name")));
    }
    const std::string world = links_.add("world ");
    write("link", {{"name", world}});
    open("joint", {{"name", joints_.add("world_to_root")}, {"type", root == "world" ? "fixed" : "floating"}});
    write("parent", {{"link", world}});
    write("child", {{"link", root}});
    out_.CloseElement();
  }

  const XMLElement& robot_;
  Warnings& warnings_;
  Names links_, joints_;
  tinyxml2::XMLPrinter out_;
  std::map<std::string, std::string> parents_;          // of links that have one
  std::map<std::string, const XMLElement*> materials_;  // that have a colour or texture, by name
  int materials_written_ = 0;
  NormalUrdf result_;
};

}  // namespace

NormalUrdf normal_urdf(const std::string& original, Warnings& warnings) {
  std::string xml = original;  // without its declaration, which people also write below a comment
  if (const std::size_t at = xml.find("<?xml"), end = xml.find("?>"); at < end && end != std::string::npos)
    xml.erase(at, end + 2 - at);
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS)
    throw std::runtime_error("bad URDF: no XML: " + text::one_line(document.ErrorStr(), 120) +
                             "; allowed: a robot of links (" + shape_kind_names() +
                             ", mesh) joined to one root link");
  require_urdf(document);
  return Normaliser(*document.RootElement(), warnings).make();
}

}  // namespace mrhi
