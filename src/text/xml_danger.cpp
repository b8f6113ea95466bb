#include "xml_danger.h"

#include <algorithm>

namespace mrhi {
namespace {

constexpr int kDeepest = 32;
constexpr std::size_t kMostElements = 100'000;
constexpr std::size_t kMostAttributes = 64;  // of an element: libraries look each up among those before it

/// Bytes of the UTF-8 character that begins with `lead`; 0: none does.
std::size_t length_of(unsigned char lead) {
  if (lead < 0x80) return 1;
  if (lead < 0xC2) return 0;
  if (lead < 0xE0) return 2;
  if (lead < 0xF0) return 3;
  return lead < 0xF5 ? 4 : 0;
}

bool has_control_characters(const std::string& xml) {
  return std::any_of(xml.begin(), xml.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\r' && c != '\t';
  });
}

/// Follows tags without building anything.
class Tags {
 public:
  explicit Tags(const std::string& xml) : xml_(xml) {}

  void follow() {
    while ((at_ = xml_.find('<', at_)) != std::string::npos) {
      if (begins("<!--")) {
        skip_to("-->", 4);
      } else if (begins("<![CDATA[")) {
        skip_to("]]>", 9);
      } else if (begins("<?xml")) {
        instruction();
      } else if (begins("<!")) {
        declares_ = true;
        skip_to(">", 2);
      } else if (at_ + 1 < xml_.size() && begins_name(xml_[at_ + 1])) {
        tag();
      } else {
        strange_ = true;
        ++at_;
      }
    }
  }

  int deepest() const { return deepest_; }
  std::size_t elements() const { return elements_; }
  std::size_t attributes() const { return attributes_; }
  bool declares() const { return declares_; }
  bool strange() const { return strange_; }

 private:
  bool begins(const char* text) const { return xml_.compare(at_, std::string(text).size(), text) == 0; }

  /// Of an element's tag, or of one that closes it.
  static bool begins_name(char c) {
    return c == '/' || c == '_' || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           static_cast<unsigned char>(c) >= 0x80;
  }

  /// The end is looked for behind the opening: "<!-->" does not close itself.
  void skip_to(const char* end, std::size_t opening) {
    const std::size_t found = xml_.find(end, at_ + opening);
    at_ = found == std::string::npos ? xml_.size() : found + 1;
  }

  /// TinyXML ends one at its first '>', other libraries at the first "?>": allowed is what both end there.
  void instruction() {
    skip_to(">", 5);
    if (at_ < 2 || xml_[at_ - 2] != '?') strange_ = true;
  }

  /// A '>' in quotes does not end a tag.
  void tag() {
    const bool closes = begins("</");
    char quote = 0;
    std::size_t attributes = 0;
    for (++at_; at_ < xml_.size() && (quote || xml_[at_] != '>'); ++at_) {
      if (!quote && xml_[at_] == '=') ++attributes;
      if (quote ? xml_[at_] == quote : xml_[at_] == '"' || xml_[at_] == '\'') quote = quote ? 0 : xml_[at_];
    }
    attributes_ = std::max(attributes_, attributes);
    if (closes) {
      depth_ = std::max(0, depth_ - 1);
      return;
    }
    ++elements_;
    deepest_ = std::max(deepest_, depth_ + 1);
    if (xml_[at_ - 1] != '/') ++depth_;
  }

  const std::string& xml_;
  std::size_t at_ = 0, elements_ = 0, attributes_ = 0;
  int depth_ = 0, deepest_ = 0;
  bool declares_ = false, strange_ = false;
};

}  // namespace

bool is_utf8(const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = length_of(static_cast<unsigned char>(text[at]));
    if (length == 0 || at + length > text.size()) return false;
    for (std::size_t i = 1; i < length; ++i)
      if ((static_cast<unsigned char>(text[at + i]) & 0xC0) != 0x80) return false;
    at += length;
  }
  return true;
}

std::optional<std::string> xml_danger(const std::string& xml) {
  if (xml.size() > kMostXmlBytes)
    return "is longer than " + std::to_string(kMostXmlBytes) + " bytes; allowed: at most that";
  if (has_control_characters(xml) || !is_utf8(xml))
    return "is no text; allowed: UTF-8 or ISO-8859-1 without control characters";
  Tags tags(xml);
  tags.follow();
  if (tags.declares()) return "has a document type; allowed: none";
  if (tags.strange())
    return "has a '<' that begins nothing known; allowed: elements, comments, CDATA and <?xml ...?>";
  if (tags.deepest() > kDeepest)
    return "elements are nested deeper than " + std::to_string(kDeepest) + " levels; allowed: at most that";
  if (tags.elements() > kMostElements)
    return std::to_string(tags.elements()) + " elements; allowed: at most " + std::to_string(kMostElements);
  if (tags.attributes() > kMostAttributes)
    return "an element has " + std::to_string(tags.attributes()) + " attributes; allowed: at most " +
           std::to_string(kMostAttributes);
  return {};
}

}  // namespace mrhi
