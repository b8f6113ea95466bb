#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "message_layout.h"
#include "mr_hand_interaction/ros/leap_human.h"
#include "wire_reader.h"

namespace mrhi {

/// Reads one message type field by field into a Target: fields with an action are handed to it, all others
/// skipped. Naming a field that is not there, or is of another type, throws DecodeError.
template <class Target>
class StructReader {
 public:
  using Action = std::function<void(WireReader&, const FieldLayout&, Target&)>;

  explicit StructReader(const TypeLayout& type) : type_(&type), actions_(type.fields.size()) {}

  bool has(const std::string& name) const { return find(name) < type_->fields.size(); }

  /// A field of a built-in type.
  void on(const std::string& name, const std::string& type, FieldArray array, Action action) {
    const std::size_t index = require(name);
    const FieldLayout& field = type_->fields[index];
    if (field.type != type || field.array != array) refuse(field, type, array);
    actions_[index] = std::move(action);
  }
  template <class Number, class Value>
  void store(const std::string& name, const std::string& type, Value Target::*member) {
    on(name, type, FieldArray::none, [member](WireReader& reader, const FieldLayout& field, Target& target) {
      target.*member = static_cast<Value>(reader.number<Number>(field));
    });
  }

  /// The type of a nested field.
  const TypeLayout& nested(const MessageLayout& layout, const std::string& name, FieldArray array) const {
    const FieldLayout& field = type_->fields[require(name)];
    if (field.nested < 0 || field.array != array) refuse(field, "message", array);
    return layout.type(field.nested);
  }
  void on_nested(const std::string& name, Action action) { actions_[require(name)] = std::move(action); }

  void read(WireReader& reader, Target& target) const {
    for (std::size_t i = 0; i < actions_.size(); ++i) {
      if (actions_[i])
        actions_[i](reader, type_->fields[i], target);
      else
        reader.skip(type_->fields[i]);
    }
  }

 private:
  std::size_t find(const std::string& name) const {
    std::size_t index = 0;
    while (index < type_->fields.size() && type_->fields[index].name != name) ++index;
    return index;
  }

  std::size_t require(const std::string& name) const {
    const std::size_t index = find(name);
    if (index == type_->fields.size()) unknown("no field " + type_->name + "." + name);
    return index;
  }

  static std::string suffix(FieldArray array) {
    return array == FieldArray::none ? "" : array == FieldArray::fixed ? "[N]" : "[]";
  }

  [[noreturn]] static void refuse(const FieldLayout& field, const std::string& type, FieldArray array) {
    unknown("field " + field.path + " is " + field.type + suffix(field.array) + "; " + type + suffix(array) +
            " is needed");
  }

  [[noreturn]] static void unknown(const std::string& what) {
    throw DecodeError(DecodeError::Kind::unknown_version, "unknown version of leap_motion/Human: " + what);
  }

  const TypeLayout* type_;
  std::vector<Action> actions_;
};

}  // namespace mrhi
