#include "leap_human_record.h"

#include <utility>

#include "mr_hand_interaction/ros/leap_human.h"
#include "wire_reader.h"

namespace mrhi {
namespace {

[[noreturn]] void wrong_count(const std::string& what) {
  throw DecodeError(DecodeError::Kind::wrong_count, what);
}

/// Reads an array of structs into slots by their type number, 0..Size-1, each at most once.
template <class Record, std::size_t Size>
void read_by_type(const StructReader<Record>& element, WireReader& reader, const FieldLayout& field,
                  std::array<std::optional<Record>, Size>& slots) {
  const std::uint32_t count = reader.count(field);
  const std::string limit = std::to_string(Size - 1);
  if (count > Size)
    wrong_count(field.path + " has " + std::to_string(count) + " entries; at most " + std::to_string(Size));
  for (std::uint32_t i = 0; i < count; ++i) {
    Record record;
    element.read(reader, record);
    const std::string type = std::to_string(record.type);
    if (record.type >= Size) wrong_count(field.path + " has type " + type + "; 0 to " + limit + " are known");
    if (slots[record.type]) wrong_count(field.path + " has type " + type + " twice");
    slots[record.type] = record;
  }
}

StructReader<Vector3> point_reader(const TypeLayout& type) {
  StructReader<Vector3> point(type);
  const char* axes[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis)
    point.on(axes[axis], "float64", FieldArray::none,
             [axis](WireReader& reader, const FieldLayout& field, Vector3& p) {
               p[axis] = reader.number<double>(field);
             });
  return point;
}

/// Binds the position of a geometry_msgs/Pose; its orientation is skipped (drivers publish it conjugated).
template <class Target>
void on_position(StructReader<Target>& parent, const MessageLayout& layout, const std::string& name,
                 Vector3 Target::*member) {
  const TypeLayout& pose_type = parent.nested(layout, name, FieldArray::none);
  StructReader<Vector3> pose(pose_type);
  const auto point = point_reader(pose.nested(layout, "position", FieldArray::none));
  pose.on_nested("position",
                 [point](WireReader& reader, const FieldLayout&, Vector3& p) { point.read(reader, p); });
  parent.on_nested(name, [pose, member](WireReader& reader, const FieldLayout&, Target& target) {
    pose.read(reader, target.*member);
  });
}

StructReader<BoneRecord> bone_reader(const MessageLayout& layout, const TypeLayout& type) {
  StructReader<BoneRecord> bone(type);
  bone.store<std::uint8_t>("type", "uint8", &BoneRecord::type);
  on_position(bone, layout, "bone_start", &BoneRecord::start);
  on_position(bone, layout, "bone_end", &BoneRecord::end);
  return bone;
}

StructReader<FingerRecord> finger_reader(const MessageLayout& layout, const TypeLayout& type) {
  StructReader<FingerRecord> finger(type);
  finger.store<std::uint8_t>("type", "uint8", &FingerRecord::type);
  finger.store<float>("width", "float32", &FingerRecord::width);
  const auto bone = bone_reader(layout, finger.nested(layout, "bone_list", FieldArray::variable));
  finger.on_nested("bone_list", [bone](WireReader& reader, const FieldLayout& field, FingerRecord& record) {
    read_by_type(bone, reader, field, record.bones);
  });
  return finger;
}

/// The wrist is arm.wrist in the newest version and wrist_position in the others; one that has neither is
/// taken too.
void on_wrist(StructReader<HandRecord>& hand, const MessageLayout& layout) {
  if (hand.has("arm")) {
    StructReader<HandRecord> arm(hand.nested(layout, "arm", FieldArray::none));
    on_position(arm, layout, "wrist", &HandRecord::wrist);
    hand.on_nested("arm", [arm](WireReader& reader, const FieldLayout&, HandRecord& record) {
      arm.read(reader, record);
    });
  }
  if (!hand.has("wrist_position")) return;
  hand.on("wrist_position", "float32", FieldArray::variable,
          [](WireReader& reader, const FieldLayout& field, HandRecord& record) {
            const std::uint32_t count = reader.count(field);
            if (count != 0 && count != 3)
              wrong_count(field.path + " has " + std::to_string(count) +
                          " numbers; 3, or none if it is not known");
            for (std::uint32_t i = 0; i < count; ++i)
              record.wrist[static_cast<int>(i)] = reader.number<float>(field);
          });
}

StructReader<HandRecord> hand_reader(const MessageLayout& layout, const TypeLayout& type) {
  StructReader<HandRecord> hand(type);
  hand.store<std::int32_t>("lmc_hand_id", "int32", &HandRecord::id);
  hand.on("is_present", "bool", FieldArray::none,
          [](WireReader& reader, const FieldLayout& field, HandRecord& record) {
            record.present = reader.number<std::uint8_t>(field) != 0;
          });
  hand.store<float>("confidence", "float32", &HandRecord::confidence);
  hand.store<float>("grab_strength", "float32", &HandRecord::grab_strength);
  hand.store<float>("pinch_strength", "float32", &HandRecord::pinch_strength);
  hand.store<float>("palm_width", "float32", &HandRecord::palm_width);
  const auto point = point_reader(hand.nested(layout, "palm_center", FieldArray::none));
  hand.on_nested("palm_center", [point](WireReader& reader, const FieldLayout&, HandRecord& record) {
    point.read(reader, record.palm_centre);
  });
  const auto finger = finger_reader(layout, hand.nested(layout, "finger_list", FieldArray::variable));
  hand.on_nested("finger_list", [finger](WireReader& reader, const FieldLayout& field, HandRecord& record) {
    read_by_type(finger, reader, field, record.fingers);
  });
  on_wrist(hand, layout);
  return hand;
}

StructReader<HeaderRecord> header_reader(const TypeLayout& type) {
  StructReader<HeaderRecord> header(type);
  header.store<std::uint32_t>("seq", "uint32", &HeaderRecord::sequence);
  header.store<Stamp>("stamp", "time", &HeaderRecord::stamp);
  header.on("frame_id", "string", FieldArray::none,
            [](WireReader& reader, const FieldLayout& field, HeaderRecord& record) {
              record.frame_id = reader.text(field);
            });
  return header;
}

}  // namespace

StructReader<HumanRecord> human_reader(const MessageLayout& layout) {
  StructReader<HumanRecord> human(layout.root());
  const auto header = header_reader(human.nested(layout, "header", FieldArray::none));
  human.on_nested("header", [header](WireReader& reader, const FieldLayout&, HumanRecord& record) {
    header.read(reader, record.header);
  });
  const std::pair<const char*, HandRecord HumanRecord::*> sides[] = {{"right_hand", &HumanRecord::right},
                                                                     {"left_hand", &HumanRecord::left}};
  for (const auto& [name, member] : sides) {
    const auto hand = hand_reader(layout, human.nested(layout, name, FieldArray::none));
    human.on_nested(name, [hand, side = member](WireReader& reader, const FieldLayout&, HumanRecord& record) {
      hand.read(reader, record.*side);
    });
  }
  return human;
}

}  // namespace mrhi
