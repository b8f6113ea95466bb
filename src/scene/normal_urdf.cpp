#include "urdf.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include "limits.h"
#include "shape_kinds.h"

namespace mrhi {
namespace {

using tinyxml2::XMLElement;
using tinyxml2::XMLNode;
using Attributes = std::vector<std::pair<const char*, std::string>>;

std::string attribute(const XMLElement* element, const char* name, const char* otherwise = "") {
  const char* value = element == nullptr ? nullptr : element->Attribute(name);
  return value == nullptr || *value == '\0' ? otherwise : value;
}

std::string in_quotes(const std::string& name) {
  return "'" + text::one_line(name, 60) + "'";
}

/// Commas between numbers are blanks.
std::string numbers(const XMLElement* element, const char* name) {
  std::string value = attribute(element, name);
  std::replace(value.begin(), value.end(), ',', ' ');
  return value;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::string trimmed(std::string text) {
  text.erase(text.find_last_not_of(" \t\r\n") + 1);
  return text.erase(0, text.find_first_not_of(" \t\r\n"));
}

/// As URDF gives a value, or as SDF does.
std::string value_of(const XMLElement* element) {
  const char* text = element == nullptr ? nullptr : element->GetText();
  return trimmed(attribute(element, "value", text == nullptr ? "" : text));
}

/// The first element of this name within another one, however deep; nullptr: none.
const XMLElement* find_within(const XMLElement& element, const char* name) {
  for (const XMLElement* e = element.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    const XMLElement* found = std::string(e->Name()) == name ? e : find_within(*e, name);
    if (found != nullptr) return found;
  }
  return nullptr;
}

template <class See>
void each(const XMLElement& parent, const char* name, const See& see) {
  for (const XMLElement* e = parent.FirstChildElement(name); e != nullptr; e = e->NextSiblingElement(name))
    see(*e);
}

bool is(const XMLNode* node, const char* name) {
  return node != nullptr && node->ToElement() != nullptr && std::string(node->Value()) == name;
}

bool says_hull(const XMLNode& node) {
  return node.ToComment() != nullptr && text::one_line(node.Value()) == "hull";
}

/// Finds what xacro should have replaced.
class XacroSearch : public tinyxml2::XMLVisitor {
 public:
  bool VisitEnter(const XMLElement& element, const tinyxml2::XMLAttribute* attribute) override {
    found = found || std::string(element.Name()).compare(0, 6, "xacro:") == 0;
    for (; attribute != nullptr && !found; attribute = attribute->Next())
      for (const char* mark : {"${", "$("})
        found = found || std::string(attribute->Value()).find(mark) != std::string::npos;
    return !found;
  }
  bool found = false;
};

void require_urdf(const XMLElement* root, const tinyxml2::XMLDocument& document) {
  const std::string name = root == nullptr ? "" : root->Name();
  if (name == "sdf")
    throw std::runtime_error("is SDF; allowed: URDF, as the program that made it or 'sdf2urdf' writes it");
  if (name != "robot")
    throw std::runtime_error("bad URDF: has no element 'robot'" +
                             (name.empty() ? std::string() : " but " + in_quotes(name)) +
                             "; allowed: a URDF, a robot of links");
  XacroSearch xacro;
  document.Accept(&xacro);
  if (xacro.found)
    throw std::runtime_error(
        "is xacro; allowed: the URDF that 'rosrun xacro xacro FILE -o OTHER.urdf' makes of it");
}

/// Names that links and joints may have.
class Names {
 public:
  explicit Names(const XMLElement& robot, const char* kind, Warnings& warnings) {
    each(robot, kind, [&](const XMLElement& element) {
      const std::string name = attribute(&element, "name");
      if (is_name(name)) made_[name] = name, taken_.insert(name);
    });
    each(robot, kind, [&](const XMLElement& element) {
      const std::string name = attribute(&element, "name");
      if (name.empty() || made_.count(name) > 0) return;
      const std::string type = attribute(&element, "type"), made = add(name);
      if (type == "fixed" || type == "floating") return;  // joints that nobody names
      warnings.add(std::string(kind) + "s have other names, as topics and frames need " + kNameIs,
                   in_quotes(name) + " is '" + made + "'");
    });
  }

  std::string add(const std::string& name) {
    constexpr std::size_t kLongest = 60;  // with a number behind it still a name
    std::string base;
    for (const char c : name.substr(0, kLongest)) base += is_name("a" + std::string(1, c)) ? c : '_';
    if (base.empty() || base.front() == '-') base = "_" + base;
    std::string made = base;
    for (int i = 2; !taken_.insert(made).second; ++i) made = base + "_" + std::to_string(i);
    return made_[name] = made;
  }

  std::string of(const std::string& name) const {
    const auto found = made_.find(name);
    return found == made_.end() ? name : found->second;
  }

 private:
  std::map<std::string, std::string> made_;
  std::set<std::string> taken_;
};

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
    find_colors(robot_);
    open("robot", {{"name", "scene"}});
    each(robot_, "link", [&](const XMLElement& link) { write_link(link); });
    add_world();
    each(robot_, "joint", [&](const XMLElement& joint) { write_joint(joint); });
    hang_root_on_world();
    out_.CloseElement();
    result_.xml = out_.CStr();
    return std::move(result_);
  }

 private:
  void open(const char* name, const Attributes& attributes) {
    out_.OpenElement(name);
    for (const auto& [key, value] : attributes) out_.PushAttribute(key, value.c_str());
  }
  void tag(const char* name, const Attributes& attributes) {
    open(name, attributes);
    out_.CloseElement();
  }

  std::string parent_of(const XMLElement& joint) const {
    return links_.of(attribute(joint.FirstChildElement("parent"), "link"));
  }
  std::string child_of(const XMLElement& joint) const {
    return links_.of(attribute(joint.FirstChildElement("child"), "link"));
  }

  /// Links of urdfdom's that hang on each other in a loop are never freed. What is left once all that hangs
  /// on nothing is taken away, again and again, is in a loop or hangs on one.
  void check_tree() {
    std::multimap<std::string, std::string> children;
    std::map<std::string, int> held;  // by how many joints
    each(robot_, "joint", [&](const XMLElement& joint) {
      const std::string parent = parent_of(joint), child = child_of(joint);
      if (parent.empty() || child.empty()) return;
      children.emplace(parent, child);
      held.emplace(parent, 0), ++held[child];
    });
    std::vector<std::string> free;
    for (const auto& [link, joints] : held)
      if (joints == 0) free.push_back(link);
    while (!free.empty()) {
      const auto [first, last] = children.equal_range(free.back());
      free.pop_back();
      for (auto it = first; it != last; ++it)
        if (--held[it->second] == 0) free.push_back(it->second);
    }
    for (const auto& [link, joints] : held)
      if (joints > 0)
        throw std::runtime_error("bad URDF: link '" + link +
                                 "' is in a loop of joints, or hangs on one; allowed: a tree of links");
  }

  /// Of Gazebo's <gazebo reference="link">, and in a link of PyBullet's <contact> and Drake's properties.
  void read_friction() {
    const auto read = [&](const XMLElement& of, const char* name, const char* link) {
      if (const auto value = text::to_number(value_of(find_within(of, name))))
        result_.friction[links_.of(attribute(&of, link))] = *value;
    };
    each(robot_, "gazebo", [&](const XMLElement& gazebo) {
      for (const char* name : {"mu", "mu1"}) read(gazebo, name, "reference");
    });
    each(robot_, "link", [&](const XMLElement& link) {
      for (const char* name : {"drake:mu_static", "lateral_friction"}) read(link, name, "name");
    });
  }

  /// A material that has a name means the same wherever it is written.
  void find_colors(const XMLElement& in) {
    each(in, "material", [&](const XMLElement& material) {
      const XMLElement* color = material.FirstChildElement("color");
      if (color == nullptr && material.FirstChildElement("texture") == nullptr) return;
      materials_.emplace(attribute(&material, "name"), &material);
    });
    each(in, "link", [&](const XMLElement& link) {
      each(link, "visual", [&](const XMLElement& visual) { find_colors(visual); });
    });
  }

  /// The world that joints name need not be a link of the file.
  void add_world() {
    bool named = false, is_link = false;
    each(robot_, "joint", [&](const XMLElement& joint) { named = named || parent_of(joint) == "world"; });
    each(robot_, "link", [&](const XMLElement& link) {
      is_link = is_link || attribute(&link, "name") == std::string("world");
    });
    if (named && !is_link) tag("link", {{"name", "world"}});
    has_world_ = named && !is_link;
  }

  void write_link(const XMLElement& link) {
    const std::string name = attribute(&link, "name");
    result_.links.push_back(links_.of(name));
    open("link", {{"name", links_.of(name)}});
    write_inertial(link, name);
    each(link, "visual", [&](const XMLElement& visual) {
      open("visual", {});
      write_origin(visual, "link " + in_quotes(name) + " visual");
      write_geometry(visual);
      write_material(visual, name);
      out_.CloseElement();
    });
    each(link, "collision", [&](const XMLElement& collision) {
      open("collision", {});
      write_origin(collision, "link " + in_quotes(name) + " collision");
      write_geometry(collision);
      out_.CloseElement();
    });
    out_.CloseElement();
  }

  /// An inertia of zeros, which urdfdom takes, stands for that of the shapes.
  void write_inertial(const XMLElement& link, const std::string& name) {
    const XMLElement* inertial = link.FirstChildElement("inertial");
    const XMLElement* mass = inertial == nullptr ? nullptr : inertial->FirstChildElement("mass");
    if (mass == nullptr) return;
    open("inertial", {});
    write_origin(*inertial, "link " + in_quotes(name) + " inertial");
    const std::string given = value_of(mass);
    tag("mass", {{"value", given.empty() ? "0" : given}});
    const XMLElement* inertia = inertial->FirstChildElement("inertia");
    Attributes moments;
    for (const char* moment : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"})
      moments.emplace_back(moment, attribute(inertia, moment, "0"));
    tag("inertia", moments);
    out_.CloseElement();
  }

  void write_origin(const XMLElement& of, const std::string& where) {
    const XMLElement* origin = of.FirstChildElement("origin");
    if (origin == nullptr) return;
    Attributes given;
    for (const char* part : {"xyz", "rpy"})
      if (const std::string value = numbers(origin, part); !value.empty()) given.emplace_back(part, value);
    for (const std::string& word : words_of(numbers(origin, "rpy"))) {
      constexpr double kTurn = 6.2832;
      const double angle = std::abs(text::to_number(word).value_or(0.0));
      if (!(angle <= joint_ranges::kCoordinate.max))
        throw std::runtime_error(where + ": rpy " + in_quotes(attribute(origin, "rpy")) +
                                 " is not allowed; allowed: three angles, each " +
                                 joint_ranges::kCoordinate.describe() + " rad");
      if (angle > kTurn)
        warnings_.add("angles of more than a turn, which URDF takes in radians",
                      where + " rpy " + in_quotes(attribute(origin, "rpy")));
    }
    tag("origin", given);
  }

  /// What is known of shapes goes past urdfdom as meshes.
  void write_geometry(const XMLElement& of) {
    const XMLElement* geometry = of.FirstChildElement("geometry");
    const XMLElement* shape = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    if (shape == nullptr) return;
    open("geometry", {});
    if (is(shape, "mesh")) {
      write_mesh(*shape, is_followed_by_hull(*geometry, *shape));
    } else if (is(shape, "box")) {
      tag("box", {{"size", numbers(shape, "size")}});
      require_no_hull(*geometry);
    } else if (find_shape_kind(shape->Name()) == nullptr || is(shape, "sphere") || is(shape, "cylinder")) {
      shape->Accept(&out_);
      require_no_hull(*geometry);
    } else {
      std::string name = ":shape:" + std::string(shape->Name());
      for (const std::string& size : find_shape_kind(shape->Name())->sizes) {
        const std::string value = attribute(shape, size.c_str(), "?");
        name += " " + (words_of(value).size() == 1 ? value : "?");
      }
      tag("mesh", {{"filename", name}});
    }
    out_.CloseElement();
  }

  static void require_no_hull(const XMLElement& geometry) {
    for (const XMLNode* node = geometry.FirstChild(); node != nullptr; node = node->NextSibling())
      if (says_hull(*node)) throw std::runtime_error("bad URDF: <!-- hull --> stands behind no mesh");
  }

  /// <mesh/><!-- hull -->, in the geometry or right behind it.
  static bool is_followed_by_hull(const XMLElement& geometry, const XMLElement& mesh) {
    for (const XMLNode* node : {mesh.NextSibling(), mesh.FirstChild(), geometry.NextSibling()})
      if (node != nullptr && says_hull(*node)) return true;
    require_no_hull(geometry);
    return false;
  }

  void write_mesh(const XMLElement& mesh, bool hull) {
    Attributes given{{"filename", (hull ? kHullPrefix : "") + trimmed(attribute(&mesh, "filename"))}};
    std::string scale = numbers(&mesh, "scale");
    if (words_of(scale).size() == 1) {
      warnings_.add("a scale of one number is that of all axes", in_quotes(scale));
      scale += " " + scale + " " + scale;
    }
    if (!scale.empty()) given.emplace_back("scale", scale);
    tag("mesh", given);
  }

  /// Each visual has a material of its own, so that none is defined twice.
  void write_material(const XMLElement& visual, const std::string& link) {
    const XMLElement* material = visual.FirstChildElement("material");
    if (material == nullptr) return;
    const std::string name = attribute(material, "name");
    if (material->FirstChildElement("color") == nullptr &&
        material->FirstChildElement("texture") == nullptr) {
      if (name.empty()) return;
      const auto found = materials_.find(name);
      if (found == materials_.end())
        return warnings_.add("materials without a color in this file are drawn grey",
                             in_quotes(name) + " of link " + in_quotes(link));
      material = found->second;
    }
    open("material", {{"name", "material_" + std::to_string(++written_)}});
    if (const XMLElement* color = material->FirstChildElement("color"))
      tag("color", {{"rgba", rgba(numbers(color, "rgba"), link)}});
    if (const XMLElement* texture = material->FirstChildElement("texture")) texture->Accept(&out_);
    out_.CloseElement();
  }

  /// Whole numbers of 0 to 255 are divided by that. Rounding beyond 1 is cut off.
  std::string rgba(const std::string& given, const std::string& link) {
    constexpr double kRounding = 1e-3;
    std::vector<double> parts;
    for (const std::string& word : words_of(given)) parts.push_back(text::to_number(word).value_or(-1.0));
    const auto is_byte = [](double part) { return part >= 0.0 && part <= 255.0 && part == std::floor(part); };
    const auto is_rounded = [](double part) { return part >= 0.0 && part <= 1.0 + kRounding; };
    const bool rounded = std::all_of(parts.begin(), parts.end(), is_rounded), has_opacity = parts.size() == 4;
    const bool bytes = !rounded && std::all_of(parts.begin(), parts.end() - has_opacity, is_byte) &&
                       (!has_opacity || is_byte(parts[3]) || is_rounded(parts[3]));
    if (!rounded && !bytes) return given;
    if (bytes)
      warnings_.add("colors of 0 to 255 are divided by 255",
                    in_quotes(given) + " of link " + in_quotes(link));
    std::string scaled;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const bool is_share = !bytes || (i == 3 && parts[3] <= 1.0);
      scaled += (i == 0 ? "" : " ") + text::exact(std::min(1.0, is_share ? parts[i] : parts[i] / 255.0));
    }
    return scaled;
  }

  void write_joint(const XMLElement& joint) {
    const std::string name = attribute(&joint, "name"), what = in_quotes(name);
    std::string type = attribute(&joint, "type");
    Attributes limit;
    if (type == "revolute" || type == "prismatic") read_limit(joint, what, type, limit);
    open("joint", {{"name", joints_.of(name)}, {"type", type}});
    for (const char* end : {"parent", "child"})
      if (const XMLElement* element = joint.FirstChildElement(end))
        tag(end, {{"link", links_.of(attribute(element, "link"))}});
    write_origin(joint, "joint " + what);
    if (const std::string axis = numbers(joint.FirstChildElement("axis"), "xyz"); !axis.empty())
      tag("axis", {{"xyz", axis}});
    if (!limit.empty()) tag("limit", limit);
    if (const XMLElement* dynamics = joint.FirstChildElement("dynamics"))
      tag("dynamics", {{"damping", attribute(dynamics, "damping", "0")},
                       {"friction", attribute(dynamics, "friction", "0")}});
    if (joint.FirstChildElement("mimic") != nullptr)
      warnings_.add("joints move freely, as <mimic> is not followed", what);
    out_.CloseElement();
  }

  /// Effort and velocity, which urdfdom wants and nothing here uses, are 0. No joint moves further than
  /// kCoordinate.
  void read_limit(const XMLElement& joint, const std::string& what, std::string& type, Attributes& limit) {
    const XMLElement* given = joint.FirstChildElement("limit");
    std::string lower = attribute(given, "lower"), upper = attribute(given, "upper");
    const bool none = lower.empty() && upper.empty();
    if (lower.empty()) lower = "0";
    if (upper.empty()) upper = "0";
    const auto held = [](std::string& text) {
      std::optional<double> number = mrhi::text::to_number(text);
      if (number && !joint_ranges::kCoordinate.contains(*number) && !std::isnan(*number)) {
        number = *number > 0.0 ? joint_ranges::kCoordinate.max : joint_ranges::kCoordinate.min;
        text = mrhi::text::exact(*number);
      }
      return number;
    };
    const std::optional<double> least = held(lower), most = held(upper);
    const bool crossed = least && most && *least > *most;
    if (none || crossed) {
      warnings_.add("joints move without limits",
                    what + (none ? ", which has none" : ", lower " + lower + " above upper " + upper));
      if (type == "revolute") type = "continuous";
      lower = text::exact(joint_ranges::kCoordinate.min), upper = text::exact(joint_ranges::kCoordinate.max);
    } else if (least && most && *least == *most) {
      warnings_.add("joints with equal limits are fixed", what);
      if (*least == 0.0) type = "fixed";
      upper = text::exact(*least + 1e-6 * std::max(1.0, std::abs(*least)));
    }
    if (type != "fixed") limit = {{"lower", lower}, {"upper", upper}, {"effort", "0"}, {"velocity", "0"}};
  }

  /// A root that has a shape or a mass is a body, and so are links that all hang fixed on an empty root of
  /// another name than "world"; "world" is a fixture.
  void hang_root_on_world() {
    std::set<std::string> children;
    each(robot_, "joint", [&](const XMLElement& joint) { children.insert(child_of(joint)); });
    const XMLElement* root = nullptr;
    int roots = 0;
    bool all_fixed = true;
    each(robot_, "joint",
         [&](const XMLElement& joint) { all_fixed = all_fixed && attribute(&joint, "type") == "fixed"; });
    each(robot_, "link", [&](const XMLElement& link) {
      if (children.count(links_.of(attribute(&link, "name"))) == 0) root = &link, ++roots;
    });
    if (roots != 1 || has_world_) return;  // urdfdom says if it is no tree
    const XMLElement* inertial = root->FirstChildElement("inertial");
    const XMLElement* mass = inertial == nullptr ? nullptr : inertial->FirstChildElement("mass");
    const bool has_mass = text::to_number(attribute(mass, "value")).value_or(0.0) > 0.0;
    const std::string child = links_.of(attribute(root, "name"));
    if (root->FirstChildElement("visual") == nullptr && root->FirstChildElement("collision") == nullptr &&
        !has_mass) {
      if (child == "world" || children.empty() || !all_fixed) return;
      warnings_.add(
          "links on fixed joints are one free body; a root that is named 'world' makes them fixtures",
          in_quotes(attribute(root, "name")));
    }
    const std::string world = links_.add("world ");
    tag("link", {{"name", world}});
    open("joint",
         {{"name", joints_.add("world_to_root")}, {"type", child == "world" ? "fixed" : "floating"}});
    tag("parent", {{"link", world}});
    tag("child", {{"link", child}});
    out_.CloseElement();
  }

  const XMLElement& robot_;
  Warnings& warnings_;
  Names links_, joints_;
  tinyxml2::XMLPrinter out_;
  std::map<std::string, const XMLElement*> materials_;
  int written_ = 0;         // materials
  bool has_world_ = false;  // that the file has not
  NormalUrdf result_;
};

}  // namespace

NormalUrdf normal_urdf(const std::string& xml, Warnings& warnings) {
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS)
    throw std::runtime_error("bad URDF: no XML: " + text::one_line(document.ErrorStr(), 120) +
                             "; allowed: a robot of links (" + shape_kind_names() +
                             ", mesh) joined to one root link");
  require_urdf(document.RootElement(), document);
  return Normaliser(*document.RootElement(), warnings).make();
}

}  // namespace mrhi
