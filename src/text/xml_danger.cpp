#include "xml_danger.h"

#include <algorithm>

namespace mrhi {
namespace {

constexpr int kDeepest = 32;
constexpr std::size_t kMostElements = 100'000;

/// Bytes of the UTF-8 character that begins with `lead`; 0: none does.
std::size_t length_of(unsigned char lead) {
  if (lead < 0x80) return 1;
  if (lead < 0xC2) return 0;
  if (lead < 0xE0) return 2;
  if (lead < 0xF0) return 3;
  return lead < 0xF5 ? 4 : 0;
}

bool is_text(const std::string& xml) {
  for (std::size_t at = 0; at < xml.size();) {
    const auto lead = static_cast<unsigned char>(xml[at]);
    const std::size_t length = length_of(lead);
    const bool blank = lead == '\n' || lead == '\r' || lead == '\t';
    if (length == 0 || at + length > xml.size() || (lead < 0x20 && !blank)) return false;
    for (std::size_t i = 1; i < length; ++i)
      if ((static_cast<unsigned char>(xml[at + i]) & 0xC0) != 0x80) return false;
    at += length;
  }
  return true;
}

/// Follows tags without building anything.
class Tags {
 public:
  explicit Tags(const std::string& xml) : xml_(xml) {}

  void follow() {
    while ((at_ = xml_.find('<', at_)) != std::string::npos) {
      if (begins("<!--")) {
        skip_to("-->");
      } else if (begins("<![CDATA[")) {
        skip_to("]]>");
      } else if (begins("<?")) {
        skip_to("?>");
      } else if (begins("<!")) {
        declares_ = true;
        skip_to(">");
      } else {
        tag();
      }
    }
  }

  int deepest() const { return deepest_; }
  std::size_t elements() const { return elements_; }
  bool declares() const { return declares_; }

 private:
  bool begins(const char* text) const { return xml_.compare(at_, std::string(text).size(), text) == 0; }

  void skip_to(const char* end) {
    const std::size_t found = xml_.find(end, at_);
    at_ = found == std::string::npos ? xml_.size() : found + 1;
  }

  /// A '>' in quotes does not end a tag.
  void tag() {
    const bool closes = begins("</");
    char quote = 0;
    for (++at_; at_ < xml_.size() && (quote || xml_[at_] != '>'); ++at_) {
      if (quote ? xml_[at_] == quote : xml_[at_] == '"' || xml_[at_] == '\'') quote = quote ? 0 : xml_[at_];
    }
    if (closes) {
      depth_ = std::max(0, depth_ - 1);
      return;
    }
    ++elements_;
    deepest_ = std::max(deepest_, depth_ + 1);
    if (xml_[at_ - 1] != '/') ++depth_;
  }

  const std::string& xml_;
  std::size_t at_ = 0, elements_ = 0;
  int depth_ = 0, deepest_ = 0;
  bool declares_ = false;
};

}  // namespace

std::optional<std::string> xml_danger(const std::string& xml) {
  if (xml.size() > kMostXmlBytes)
    return "is longer than " + std::to_string(kMostXmlBytes) + " bytes; allowed: at most that";
  if (!is_text(xml)) return "is no text; allowed: UTF-8 without control characters";
  Tags tags(xml);
  tags.follow();
  if (tags.declares()) return "has a document type; allowed: none";
  if (tags.deepest() > kDeepest)
    return "elements are nested deeper than " + std::to_string(kDeepest) + " levels; allowed: at most that";
  if (tags.elements() > kMostElements)
    return std::to_string(tags.elements()) + " elements; allowed: at most " + std::to_string(kMostElements);
  return {};
}

}  // namespace mrhi
