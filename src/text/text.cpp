#include "text.h"

#include <locale.h>
#include <stdlib.h>

#include <array>
#include <cctype>
#include <cstdarg>
#include <cstdio>
#include <locale>
#include <sstream>

#include "mr_hand_interaction/input_error.h"
#include "untrusted_input.h"

namespace mrhi::text {

namespace {

std::string with_digits(double value, int digits) {
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.precision(digits);
  stream << value;
  return stream.str();
}

}  // namespace

std::string number(double value) {
  return with_digits(value, 6);
}

std::string exact(double value) {
  constexpr int kMaxDigits = 17;  // identify every double
  int digits = 6;
  while (digits < kMaxDigits && to_number(with_digits(value, digits)) != value) ++digits;
  return with_digits(value, digits);
}

std::string format(const char* form, ...) {
  std::array<char, 1024> text{};
  va_list values;
  va_start(values, form);
  std::vsnprintf(text.data(), text.size(), form, values);
  va_end(values);
  return text.data();
}

std::optional<double> to_number(const std::string& text) {
  static const locale_t c_locale = newlocale(LC_ALL_MASK, "C", nullptr);
  char* end = nullptr;
  const double value = strtod_l(text.c_str(), &end, c_locale);
  if (text.empty() || end != text.c_str() + text.size()) return std::nullopt;
  return value;
}

std::string exact(const Vector3& value) {
  return "[" + exact(value.x()) + ", " + exact(value.y()) + ", " + exact(value.z()) + "]";
}

std::string vector(const Vector3& value) {
  return "[" + number(value.x()) + ", " + number(value.y()) + ", " + number(value.z()) + "]";
}

std::string quaternion(const Quaternion& value) {
  return "[" + number(value.x()) + ", " + number(value.y()) + ", " + number(value.z()) + ", " +
         number(value.w()) + "]";
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> fields;
  std::size_t begin = 0;
  for (std::size_t comma; (comma = text.find(',', begin)) != std::string::npos; begin = comma + 1)
    fields.push_back(text.substr(begin, comma - begin));
  fields.push_back(text.substr(begin));
  return fields;
}

std::string one_line(const std::string& text, std::size_t max_bytes) {
  std::string line;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    const std::string one = text.substr(at, std::max<std::size_t>(1, length));
    at += one.size();
    if (one.find_first_of("\n\r\t ") == 0) {
      if (!line.empty() && line.back() != ' ') line += ' ';
      continue;
    }
    // A terminal reads control characters as commands; in UTF-8 those from 80 to 9F begin with C2.
    const auto first = static_cast<unsigned char>(one[0]), last = static_cast<unsigned char>(one.back());
    const bool control = first < 0x20 || first == 0x7f || (first == 0xC2 && last < 0xA0);
    line += length == 0 || control ? "?" : one;
  }
  if (!line.empty() && line.back() == ' ') line.pop_back();
  if (line.size() <= max_bytes) return line;
  std::size_t end = max_bytes;
  while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xC0) == 0x80) --end;  // not within a character
  return line.substr(0, end) + "...";
}

std::string quoted(const std::string& name, std::size_t max_bytes) {
  return "'" + one_line(name, max_bytes) + "'";
}

std::string in_lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string with_spaces(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

}  // namespace mrhi::text

namespace mrhi {

InputError::InputError(const std::string& message) : std::runtime_error(text::one_line(message, 4000)) {}

const char* const kNameIs = "1 to 64 letters, digits, '_' and '-', not first '-'";

bool is_name(const std::string& text) {
  const char* const known = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  return !text.empty() && text.size() <= 64 && text.front() != '-' &&
         text.find_first_not_of(known) == std::string::npos;
}

}  // namespace mrhi
