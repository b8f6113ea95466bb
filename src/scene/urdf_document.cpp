#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <mutex>
#include <optional>

#include "../text/file_text.h"
#include "../text/text.h"
#include "../text/xml_danger.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "normal_urdf.h"
#include "shape_kinds.h"
#include "urdf.h"

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

/// Each byte of ISO-8859-1 is the character of that number.
std::string from_latin1(const std::string& text) {
  std::string utf8;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80) utf8 += static_cast<char>(0xC0 | (byte >> 6));
    utf8 += static_cast<char>(byte < 0x80 ? byte : 0x80 | (byte & 0x3F));
  }
  return utf8;
}

urdf::ModelInterfaceSharedPtr parsed(const std::string& xml) {
  const Complaints complaints;
  urdf::ModelInterfaceSharedPtr model;
  std::string problem;
  try {
    model = urdf::parseURDF(xml);
    problem = complaints.text();  // urdfdom goes on with half a link after some errors
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

}  // namespace

UrdfDocument parse_urdf_file(const std::string& file) {
  return parse_urdf(file, read_file(file));
}

UrdfDocument parse_urdf(const std::string& source, const std::string& given) {
  const std::string xml = is_utf8(given) ? given : from_latin1(given);
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

}  // namespace mrhi
