#include "urdf.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>

#include "../text/file_text.h"
#include "../text/text.h"
#include "../text/xml_danger.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "shape_kinds.h"

namespace mrhi {
namespace {

/// Collects what urdfdom would print, for as long as it lives.
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

std::string read_file(const std::string& file) {
  const std::optional<std::string> xml = file_text(file, kMostXmlBytes + 1);
  if (!xml || xml->empty()) throw SceneError(file + ": cannot be read; allowed: a readable URDF file");
  return *xml;
}

/// Notes <!-- hull --> in the tag of the mesh that it stands behind.
void note_hull(std::string& xml, std::size_t comment) {
  const std::size_t mesh = xml.rfind("<mesh", comment), geometry = xml.rfind("<geometry", comment);
  const std::size_t name = mesh == std::string::npos ? mesh : xml.find("filename", mesh);
  const std::size_t quote = name == std::string::npos ? name : xml.find_first_of("\"'", name);
  if (quote >= comment || geometry == std::string::npos || geometry > mesh)
    throw std::runtime_error("<!-- hull --> stands behind no mesh");
  xml.insert(quote + 1, kHullPrefix);
}

std::string without_comments(std::string xml) {
  for (std::size_t begin = xml.find("<!--"); begin != std::string::npos; begin = xml.find("<!--", begin)) {
    std::size_t end = xml.find("-->", begin);
    if (end != std::string::npos && text::one_line(xml.substr(begin + 4, end - begin - 4)) == "hull") {
      const std::size_t length = xml.size();
      note_hull(xml, begin);
      begin += xml.size() - length, end += xml.size() - length;
    }
    xml.erase(begin, end == std::string::npos ? end : end + 3 - begin);
  }
  return xml;
}

/// A mass without an inertia gets one of zeros, which urdfdom does not refuse: the shapes' own is meant.
std::string with_inertias(std::string plain) {
  for (std::size_t at = plain.find("<inertial>"); at != std::string::npos;
       at = plain.find("<inertial>", at + 1)) {
    const std::size_t end = plain.find("</inertial>", at);
    if (end == std::string::npos) break;
    const std::size_t inertia = plain.find("<inertia", at + 1);
    if (inertia > end) plain.insert(end, R"(<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>)");
  }
  return plain;
}

/// The value of an attribute of a tag, or "".
std::string attribute(const std::string& tag, const std::string& name) {
  const std::size_t at = tag.find(name);
  const std::size_t quote = at == std::string::npos ? at : tag.find_first_of("\"'", at);
  return quote == std::string::npos ? "" : tag.substr(quote + 1, tag.find(tag[quote], quote + 1) - quote - 1);
}

bool urdfdom_knows(const ShapeKind& kind) {
  return kind.name == "box" || kind.name == "sphere" || kind.name == "cylinder";
}

/// A tag <NAME SIZE="..."/> of a kind of shape as that of a mesh. What is no number there becomes none that
/// is.
std::string as_mesh(const std::string& tag, const ShapeKind& kind) {
  std::string mesh = "<mesh filename=\":shape:" + kind.name;
  for (const std::string& size : kind.sizes) {
    std::string value = attribute(tag, size);
    for (char& c : value)
      if (std::string("+-.0123456789eE").find(c) == std::string::npos) c = '?';
    mesh += " " + (value.empty() ? "?" : value);
  }
  return mesh + (tag[tag.size() - 2] == '/' ? "\"/>" : "\">");
}

/// Shapes that urdfdom does not know go past it as meshes.
std::string with_known_shapes(std::string xml) {
  for (const ShapeKind& kind : shape_kinds()) {
    if (urdfdom_knows(kind)) continue;
    const std::string open = "<" + kind.name, close = "</" + kind.name + ">";
    for (std::size_t at = xml.find(open); at != std::string::npos; at = xml.find(open, at + 1)) {
      const std::size_t end = xml.find('>', at);
      if (end == std::string::npos ||
          std::string(" \t\r\n/>").find(xml[at + open.size()]) == std::string::npos)
        continue;
      xml.replace(at, end + 1 - at, as_mesh(xml.substr(at, end + 1 - at), kind));
    }
    for (std::size_t at = xml.find(close); at != std::string::npos; at = xml.find(close, at))
      xml.replace(at, close.size(), "</mesh>");
  }
  return xml;
}

std::vector<urdf::LinkConstSharedPtr> links_in_order(const urdf::ModelInterface& model,
                                                     const std::string& plain) {
  std::map<std::string, std::size_t> place;
  for (std::size_t at = plain.find("<link"); at != std::string::npos; at = plain.find("<link", at + 1)) {
    place.emplace(attribute(plain.substr(at, plain.find('>', at) - at), "name"), at);
  }
  std::vector<urdf::LinkConstSharedPtr> links;
  for (const auto& entry : model.links_) links.push_back(entry.second);
  std::stable_sort(links.begin(), links.end(),
                   [&](const auto& a, const auto& b) { return place[a->name] < place[b->name]; });
  return links;
}

/// What the first tag of that name says of `link`, or "".
std::string link_of(const std::string& text, const std::string& tag) {
  const std::size_t at = text.find(tag);
  return at == std::string::npos ? "" : attribute(text.substr(at, text.find('>', at) - at), "link");
}

/// Parents and children by the joints' tags; a joint ends where the next begins.
std::multimap<std::string, std::string> children_of_links(const std::string& plain) {
  std::multimap<std::string, std::string> children;
  for (std::size_t at = plain.find("<joint"), next = at; at != std::string::npos; at = next) {
    next = plain.find("<joint", at + 1);
    const std::string joint = plain.substr(at, next - at);
    const std::string parent = link_of(joint, "<parent"), child = link_of(joint, "<child");
    if (!parent.empty() && !child.empty()) children.emplace(parent, child);
  }
  return children;
}

/// Links of urdfdom's that hang on each other in a loop are never freed, and it may take them. What is left
/// once all that hangs on nothing is taken away, again and again, is in a loop or hangs on one.
std::optional<std::string> link_of_a_loop(const std::string& plain) {
  const auto children = children_of_links(plain);
  std::map<std::string, int> held;  // by how many joints
  for (const auto& [parent, child] : children) held.emplace(parent, 0), ++held[child];
  std::vector<std::string> free;
  for (const auto& [link, joints] : held)
    if (joints == 0) free.push_back(link);
  while (!free.empty()) {
    const auto [first, last] = children.equal_range(free.back());
    free.pop_back();
    for (auto it = first; it != last; ++it)
      if (--held[it->second] == 0) free.push_back(it->second);
  }
  const auto left = std::find_if(held.begin(), held.end(), [](const auto& link) { return link.second > 0; });
  return left == held.end() ? std::nullopt : std::optional(left->first);
}

}  // namespace

UrdfDocument parse_urdf_file(const std::string& file) {
  return parse_urdf(file, read_file(file));
}

UrdfDocument parse_urdf(const std::string& source, const std::string& xml) {
  if (const auto wrong = xml_danger(xml)) throw SceneError(source + ": bad URDF: " + *wrong);
  const Complaints complaints;
  UrdfDocument document;
  std::string problem, plain;
  try {
    plain = without_comments(xml);
    if (const auto link = link_of_a_loop(plain))
      throw std::runtime_error("link '" + *link + "' is in a loop of joints, or hangs on one");
    document.model = urdf::parseURDF(with_known_shapes(with_inertias(plain)));
    problem = complaints.text();  // urdfdom goes on with half a link after some errors
    if (!document.model && problem.empty()) problem = "urdfdom refuses it";
  } catch (const std::exception& error) {
    problem = error.what();
  }
  if (!problem.empty()) {
    throw SceneError(source + ": bad URDF: " + text::one_line(problem) + "; allowed: a robot of links (" +
                     shape_kind_names() + ", mesh) joined to one root link");
  }
  document.links = links_in_order(*document.model, plain);
  return document;
}

}  // namespace mrhi
