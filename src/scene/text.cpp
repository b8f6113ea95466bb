#include "text.h"

#include <locale>
#include <sstream>

namespace mrhi::text {

std::string number(double value) {
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream << value;
  return stream.str();
}

std::string vector(const Vector3& value) {
  return "[" + number(value.x()) + ", " + number(value.y()) + ", " + number(value.z()) + "]";
}

std::string joined(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

std::string one_line(const std::string& text, std::size_t longest) {
  std::string line;
  for (const char c : text) {
    const bool blank = c == '\n' || c == '\r' || c == '\t' || c == ' ';
    if (!blank) line += c;
    if (blank && !line.empty() && line.back() != ' ') line += ' ';
  }
  if (!line.empty() && line.back() == ' ') line.pop_back();
  return line.size() <= longest ? line : line.substr(0, longest) + "...";
}

}  // namespace mrhi::text
