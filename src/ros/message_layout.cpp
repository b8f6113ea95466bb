#include "message_layout.h"

#include <array>
#include <sstream>
#include <utility>

#include "mr_hand_interaction/ros/leap_human.h"

namespace mrhi {
namespace {

/// Seventy times what any version has: types nested through all of it fit on the stack.
constexpr std::size_t kLongestDefinition = 256 * 1024;

[[noreturn]] void unknown(const std::string& what) {
  throw DecodeError(DecodeError::Kind::unknown_version, what);
}

std::string stripped(const std::string& text) {
  const char* blanks = " \t\r";
  const auto first = text.find_first_not_of(blanks);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

bool is_separator(const std::string& line) {
  return line.size() >= 80 && line.find_first_not_of('=') == std::string::npos;
}

bool is_name(const std::string& text) {
  const char* allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
  return !text.empty() && text.find_first_not_of(allowed) == std::string::npos;
}

void parse_array(const std::string& brackets, FieldLayout& field) {
  const std::string count = brackets.substr(1, brackets.size() - 2);
  if (brackets.back() != ']' || count.size() > 9 ||
      count.find_first_not_of("0123456789") != std::string::npos)
    unknown("message definition: field " + field.path + " has the array bounds '" + brackets + "'");
  field.array = count.empty() ? FieldArray::variable : FieldArray::fixed;
  if (!count.empty()) field.length = static_cast<std::uint32_t>(std::stoul(count));
  if (field.length == 0) unknown("message definition: field " + field.path + " is an array of no elements");
}

/// Adds the field that a line declares; comments, constants and blank lines declare none.
void parse_line(const std::string& raw, TypeLayout& type) {
  const std::string line = stripped(raw.substr(0, raw.find('#')));
  if (line.empty()) return;
  const auto space = line.find_first_of(" \t");
  const std::string rest = space == std::string::npos ? "" : stripped(line.substr(space));
  if (rest.find('=') != std::string::npos) return;
  if (!is_name(rest)) unknown("message definition: '" + line + "' in " + type.name + " declares no field");
  FieldLayout field;
  field.name = rest;
  field.path = type.name + "." + rest;
  field.type = line.substr(0, space);
  const auto bracket = field.type.find('[');
  if (bracket != std::string::npos) {
    parse_array(field.type.substr(bracket), field);
    field.type.resize(bracket);
  }
  type.fields.push_back(std::move(field));
}

/// Bytes of a built-in type; 0 for a string, nothing for any other name.
std::optional<std::size_t> built_in_size(const std::string& type) {
  static const std::array<std::pair<const char*, std::size_t>, 16> sizes{{{"bool", 1},
                                                                          {"int8", 1},
                                                                          {"uint8", 1},
                                                                          {"byte", 1},
                                                                          {"char", 1},
                                                                          {"int16", 2},
                                                                          {"uint16", 2},
                                                                          {"int32", 4},
                                                                          {"uint32", 4},
                                                                          {"int64", 8},
                                                                          {"uint64", 8},
                                                                          {"float32", 4},
                                                                          {"float64", 8},
                                                                          {"time", 8},
                                                                          {"duration", 8},
                                                                          {"string", 0}}};
  for (const auto& [name, size] : sizes)
    if (type == name) return size;
  return std::nullopt;
}

bool names(const std::string& candidate, const std::string& wanted, const std::string& package) {
  if (wanted.find('/') != std::string::npos) return candidate == wanted;
  if (wanted == "Header") return candidate == "std_msgs/Header";
  return candidate == package + "/" + wanted;
}

}  // namespace

MessageLayout::MessageLayout(const std::string& definition, const std::string& root_name) {
  if (definition.size() > kLongestDefinition)
    unknown("message definition: has " + std::to_string(definition.size()) + " bytes; allowed: at most " +
            std::to_string(kLongestDefinition));
  types_.push_back({root_name, {}, std::nullopt});
  std::istringstream text(definition);
  bool new_block = false;
  for (std::string raw; std::getline(text, raw);) {
    const std::string line = stripped(raw);
    if (is_separator(line)) {
      new_block = true;
    } else if (new_block && line.compare(0, 4, "MSG:") == 0) {
      types_.push_back({stripped(line.substr(4)), {}, std::nullopt});
      new_block = false;
    } else {
      parse_line(line, types_.back());
    }
  }
  resolve();
  std::vector<char> progress(types_.size(), 0);
  for (std::size_t type = 0; type < types_.size(); ++type) measure(type, progress);
}

void MessageLayout::resolve() {
  for (TypeLayout& type : types_) {
    const std::string package = type.name.substr(0, type.name.find('/'));
    for (FieldLayout& field : type.fields) {
      if (built_in_size(field.type)) continue;
      for (std::size_t i = 1; i < types_.size() && field.nested < 0; ++i)
        if (names(types_[i].name, field.type, package)) field.nested = static_cast<int>(i);
      if (field.nested >= 0) {
        field.type = this->type(field.nested).name;
      } else {
        unknown("message definition: type '" + field.type + "' of field " + field.path + " is not defined");
      }
    }
  }
}

void MessageLayout::measure(std::size_t index, std::vector<char>& progress) {
  enum : char { untouched, entered, done };
  TypeLayout& type = types_[index];
  if (progress[index] == done) return;
  if (progress[index] == entered) unknown("message definition: " + type.name + " contains itself");
  progress[index] = entered;
  type.size = 0;
  for (FieldLayout& field : type.fields) {
    if (field.nested >= 0) {
      measure(static_cast<std::size_t>(field.nested), progress);
      field.element_size = this->type(field.nested).size;
    } else if (field.type != "string") {
      field.element_size = built_in_size(field.type);
    }
    const bool fixed = field.element_size && field.array != FieldArray::variable;
    if (!fixed) type.size.reset();
    if (type.size) *type.size += field.length * *field.element_size;
  }
  progress[index] = done;
}

}  // namespace mrhi
