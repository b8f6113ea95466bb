#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mrhi {

enum class FieldArray : std::uint8_t { none, fixed, variable };

/// One field as a message definition declares it.
struct FieldLayout {
  std::string name;  ///< "palm_center"
  std::string path;  ///< "leap_motion/Hand.palm_center", for errors
  std::string type;  ///< of one element: "float32", "string" or "package/Type"
  FieldArray array = FieldArray::none;
  std::uint32_t length = 1;                 ///< of a fixed array
  int nested = -1;                          ///< index for MessageLayout::type(), or -1 for a built-in type
  std::optional<std::size_t> element_size;  ///< bytes of one element, if that is always the same
};

struct TypeLayout {
  std::string name;  ///< "leap_motion/Hand"
  std::vector<FieldLayout> fields;
  std::optional<std::size_t> size;  ///< bytes, if always the same
};

/// The types of a full ROS 1 message definition: the main type's text, then "MSG: package/Type" blocks, each
/// after a line of 80 "=". Throws DecodeError for text that is no such definition.
class MessageLayout {
 public:
  MessageLayout(const std::string& definition, const std::string& root_name);

  const TypeLayout& root() const { return types_.front(); }
  const TypeLayout& type(int index) const { return types_[static_cast<std::size_t>(index)]; }

 private:
  void resolve();
  void measure(std::size_t type, std::vector<char>& progress);

  std::vector<TypeLayout> types_;
};

}  // namespace mrhi
