#pragma once

#include <tinyxml2.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "../text/text.h"
#include "urdf.h"

/// Helpers of normal_urdf.cpp: elements of XML, and names of links and joints.
namespace mrhi::urdf_xml {

using tinyxml2::XMLElement;
using tinyxml2::XMLNode;
using Attributes = std::vector<std::pair<const char*, std::string>>;

inline std::string attribute(const XMLElement* element, const char* name, const char* otherwise = "") {
  const char* value = element == nullptr ? nullptr : element->Attribute(name);
  return value == nullptr || *value == '\0' ? otherwise : value;
}

inline std::vector<std::string> words_of(std::string text) {
  std::replace(text.begin(), text.end(), ',', ' ');
  return text::words(text);
}

inline std::string trimmed(std::string text) {
  text.erase(text.find_last_not_of(" \t\r\n") + 1);
  return text.erase(0, text.find_first_not_of(" \t\r\n"));
}

/// A value as URDF writes it (attribute) or as SDF does (text).
inline std::string value_of(const XMLElement* element) {
  const char* text = element == nullptr ? nullptr : element->GetText();
  return trimmed(attribute(element, "value", text == nullptr ? "" : text));
}

/// The first descendant of this name; nullptr: none.
inline const XMLElement* find_within(const XMLElement& element, const char* name) {
  for (const XMLElement* e = element.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    const XMLElement* found = std::string(e->Name()) == name ? e : find_within(*e, name);
    if (found != nullptr) return found;
  }
  return nullptr;
}

template <class Visit>
void each(const XMLElement& parent, const char* name, const Visit& visit) {
  for (const XMLElement* e = parent.FirstChildElement(name); e != nullptr; e = e->NextSiblingElement(name))
    visit(*e);
}

inline bool is_hull_comment(const XMLNode& node) {
  return node.ToComment() != nullptr && text::one_line(node.Value()) == "hull";
}

/// Searches for elements and expressions that xacro would have replaced, except left-over properties, which
/// have no effect.
class XacroSearch : public tinyxml2::XMLVisitor {
 public:
  bool VisitEnter(const XMLElement& element, const tinyxml2::XMLAttribute* attribute) override {
    const std::string name = element.Name();
    found = found || (name.compare(0, 6, "xacro:") == 0 && name != "xacro:property");
    for (; attribute != nullptr && !found; attribute = attribute->Next())
      for (const char* mark : {"${", "$("})
        found = found || std::string(attribute->Value()).find(mark) != std::string::npos;
    return !found && name != "xacro:property";
  }
  bool found = false;
};

inline void require_urdf(const tinyxml2::XMLDocument& document) {
  const XMLElement* root = document.RootElement();
  const std::string name = root == nullptr ? "" : root->Name();
  if (name == "sdf")
    throw std::runtime_error("is SDF; allowed: URDF, as the program that made it or 'sdf2urdf' writes it");
  if (name != "robot")
    throw std::runtime_error("bad URDF: has no element 'robot'" +
                             (name.empty() ? std::string() : " but " + text::quoted(name)) +
                             "; allowed: a URDF, a robot of links");
  XacroSearch xacro;
  document.Accept(&xacro);
  if (xacro.found)
    throw std::runtime_error(
        "is xacro; allowed: the URDF that 'rosrun xacro xacro FILE -o OTHER.urdf' makes of it");
}

/// Valid names of the links or joints of a URDF: each keeps its name, or gets a similar one.
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
      if (type == "fixed" || type == "floating") return;  // these joints do not appear in the scene
      warnings.add(std::string(kind) + "s have other names, as topics and frames need " + kNameIs,
                   text::quoted(name) + " is '" + made + "'");
    });
  }

  std::string add(const std::string& name) {
    constexpr std::size_t kMaxLength = 60;  // leaves room for a number
    std::string base;
    for (const char c : name.substr(0, kMaxLength)) base += is_name("a" + std::string(1, c)) ? c : '_';
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

}  // namespace mrhi::urdf_xml
