#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "collision/mesh_shapes.h"
#include "fuzz/target.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "scene/solid_mesh.h"
#include "support/fixtures.h"
#include "support/posed_hand.h"
#include "support/postures.h"
#include "tracking/hand_filter.h"

namespace mrhi::fuzzing {

/// A scene, a configuration and frames out of bytes: hands that go through one to four bodies, which hang on
/// joints in some, now and then with numbers that are none and stamps from elsewhere. Bodies of some scenes
/// start inside each other, or in the same place.
struct StepCase {
  Scene scene;
  bool overlaps = false;
  Configuration configuration;
  std::vector<JointsFrame> frames;
};

constexpr std::size_t kMostFrames = 40;

/// Kind of a case, from its last byte. The other bytes mean the same in every kind.
struct StepKind {
  bool overlaps = false;  ///< bodies may start inside each other, or in the same place
  bool meshes = false;    ///< in place of boxes and spheres
  bool slender = false;   ///< rods
  bool flush = false;     ///< bodies alike, in a row, each against the next with all sides in one plane

  explicit StepKind(int last)
      : overlaps(last % 8 == 7),
        meshes(last / 8 % 4 == 3),
        slender(last / 32 % 4 == 2),
        flush(last / 32 % 4 == 3) {}
};

inline Mesh mesh_of(TriangleMesh triangles) {
  return {std::make_shared<const TriangleMesh>(std::move(triangles)), {}};
}

inline Shape shape_of(Bytes& bytes, const StepKind& kind) {
  const bool meshes = kind.meshes;
  const auto size = [&] { return 0.003 * std::pow(25.0, bytes.between(0.0, 1.0)); };  // 3 to 75 mm
  double first = size(), second = size(), third = size();
  if (kind.slender) first = third = 0.002, second += 0.05;
  const Vector3 half(first, second, third);
  switch (bytes.below(3)) {
    case 0:
      return meshes ? Shape(mesh_of(box_mesh(half))) : Box{half};
    case 1:
      return Cylinder{first, second};
    default:
      return meshes ? Shape(mesh_of(notched_cube(first))) : Sphere{first};
  }
}

inline Vector3 vector_of(Bytes& bytes, double most) {
  const double x = bytes.between(-most, most), y = bytes.between(-most, most);
  return {x, y, bytes.between(-most, most)};
}

inline Quaternion orientation_of(Bytes& bytes) {
  const Vector3 half = vector_of(bytes, 1.0);
  return Quaternion(1.0, half.x(), half.y(), half.z()).normalized();
}

inline Body body_of(Bytes& bytes, int number, const Material& material, const StepKind& kind) {
  const bool extreme = bytes.one_in(8);
  const double mass = std::pow(10.0, extreme ? bytes.between(-6.0, 6.0) : bytes.between(-2.0, 0.5));
  Body body = testing::box_body(Vector3(0.04, 0.05, 0.06), mass);
  body.name = "body_" + std::to_string(number);
  body.material = material;
  body.fixed = bytes.one_in(4);
  body.shapes = {{shape_of(bytes, kind), {}}};
  if (kind.slender || kind.flush) body.inertia = inertia_of(body.shapes, mass);
  body.start = {vector_of(bytes, 0.15), orientation_of(bytes)};
  if (!body.fixed && bytes.one_in(4)) body.start_twist = {vector_of(bytes, 2.0), vector_of(bytes, 30.0)};
  complete(body);
  return body;
}

inline bool is_clear(const Body& one, const Body& other) {
  return (one.start.position - other.start.position).norm() >= one.bounding_radius + other.bounding_radius;
}

inline bool is_clear(const Scene& scene, const Body& added) {
  return std::all_of(scene.bodies.begin(), scene.bodies.end(),
                     [&](const Body& body) { return is_clear(body, added); });
}

inline double power_of_ten(Bytes& bytes, double least, double most) {
  return std::pow(10.0, bytes.between(least, most));
}

inline Joint joint_of(Bytes& bytes, int parent, int child) {
  Joint joint;
  joint.name = "joint_" + std::to_string(child);
  joint.kind = bytes.one_in(2) ? JointKind::sliding : JointKind::turning;
  joint.parent = parent;
  joint.child = child;
  joint.axis = orientation_of(bytes) * Vector3::UnitX();
  joint.axis.normalize();
  joint.in_parent = {vector_of(bytes, 0.1), orientation_of(bytes)};
  joint.in_child = {vector_of(bytes, 0.05), orientation_of(bytes)};
  if (bytes.one_in(2)) {
    joint.lower = -bytes.between(0.0, 0.5) - 1e-3;
    joint.upper = bytes.between(0.0, 0.5);
    joint.restitution = bytes.one_in(2) ? bytes.between(0.0, 1.0) : 0.0;
  }
  if (bytes.one_in(3)) joint.damping = power_of_ten(bytes, -4.0, 2.0);
  if (bytes.one_in(3)) joint.friction = power_of_ten(bytes, -4.0, 2.0);
  if (bytes.one_in(3)) joint.spring = JointSpring{power_of_ten(bytes, -2.0, 4.0), bytes.between(-0.5, 0.5)};
  if (bytes.one_in(4)) joint.detents = Detents{{-0.2, 0.0, 0.1, 0.15}, power_of_ten(bytes, -3.0, 1.0)};
  if (bytes.one_in(4)) {
    const double at = bytes.between(-0.3, 0.3), force = power_of_ten(bytes, -3.0, 1.0);
    joint.latch = Latch{at, force, power_of_ten(bytes, -4.0, -1.0)};
  }
  return joint;
}

/// Joins bodies to earlier ones or to the world, unless the joined body would overlap another. With
/// `overlaps` it may.
inline void hang(Bytes& bytes, Scene& scene, bool overlaps) {
  Scene hung = scene;
  for (int child = 0; child < static_cast<int>(scene.bodies.size()); ++child) {
    if (scene.bodies[static_cast<std::size_t>(child)].fixed || bytes.one_in(3)) continue;
    const int parent = bytes.below(child + 1) - 1;
    hung.joints.push_back(joint_of(bytes, parent, child));
  }
  for (Body& body : hung.bodies) body.start_twist = Twist();
  arrange_joints(hung);
  for (std::size_t a = 0; a < hung.bodies.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b)
      if (!overlaps && !is_clear(hung.bodies[a], hung.bodies[b])) return;
  }
  scene = hung;
}

inline Scene scene_of(Bytes& bytes, const Configuration& configuration, const StepKind& kind) {
  Scene scene;
  scene.name = "fuzzed";
  if (bytes.one_in(4)) scene.gravity = Vector3(0, 0, -9.81);
  Material material = default_material(configuration);
  if (bytes.one_in(2)) material.restitution = bytes.between(0.0, 1.0);
  const int bodies = 1 + bytes.below(4);
  for (int i = 0; i < bodies; ++i) {
    Body body = body_of(bytes, i, material, kind);
    const bool flush = kind.flush && i > 0;
    if (flush || (kind.overlaps && i > 0 && bytes.one_in(2))) {
      body.shapes = scene.bodies[0].shapes;
      body.start = scene.bodies[0].start;
      if (flush) {
        const Vector3 size = box_around(scene.bodies[0].shapes[0]).sizes();
        body.start.position += body.start.orientation * (i * size.x() * Vector3::UnitX());
        body.start_twist = scene.bodies[0].start_twist = Twist();
      }
      complete(body);
    }
    if (kind.overlaps || flush || is_clear(scene, body)) scene.bodies.push_back(std::move(body));
  }
  if (bytes.one_in(3)) hang(bytes, scene, kind.overlaps);
  return scene;
}

inline Configuration configuration_of(Bytes& bytes) {
  static const double steps[] = {0.001, 0.0005, 0.004, 0.0083, 0.02};
  static const ContactModelKind models[] = {ContactModelKind::implicit,    ContactModelKind::implicit,
                                            ContactModelKind::seed,        ContactModelKind::impulse,
                                            ContactModelKind::penetration, ContactModelKind::virtual_spring,
                                            ContactModelKind::soft_pad,    ContactModelKind::implicit};
  Configuration configuration;
  configuration.step = steps[bytes.below(5)];
  configuration.filter.type = {hand_filters()[bytes.below(4)]->name};
  if (bytes.one_in(4)) configuration.contact_model = models[bytes.below(8)];
  if (bytes.one_in(3)) configuration.contact.hand = HandStrength::of_a_person();
  configuration.contact.grasp_assist = bytes.one_in(2);
  return configuration;
}

inline HandPosture posture_of(Bytes& bytes) {
  static const HandPosture postures[] = {relaxed_posture(), flat_posture(), pointing_posture(),
                                         testing::fist_posture()};
  const HandPosture from = postures[bytes.below(4)];
  return from + bytes.between(0.0, 1.0) * (testing::fist_posture() - from);
}

/// One number of the hand is what none should be.
inline void spoil(Bytes& bytes, HandJoints& hand) {
  static const double numbers[] = {std::numeric_limits<double>::quiet_NaN(),
                                   std::numeric_limits<double>::infinity(),
                                   1e300,
                                   -1e30,
                                   9.9,
                                   0.0};
  const double number = numbers[bytes.below(6)];
  switch (bytes.below(4)) {
    case 0:
      hand.palm_width = static_cast<float>(number);
      break;
    case 1:
      hand.wrist = Vector3(0.0, number, 0.0);
      break;
    case 2:
      hand.finger_width[static_cast<std::size_t>(bytes.below(kFingers))].reset();
      break;
    default:
      hand.joints[static_cast<std::size_t>(bytes.below(kFingers))][static_cast<std::size_t>(bytes.below(5))] =
          Vector3::Constant(number);
  }
}

inline Nanoseconds interval_of(Bytes& bytes) {
  constexpr Nanoseconds kMillisecond = 1'000'000;
  static const Nanoseconds odd[] = {0,
                                    -kMillisecond,
                                    60 * kMillisecond,
                                    900 * kMillisecond,
                                    -5000 * kMillisecond,
                                    3'600'000 * kMillisecond,
                                    std::numeric_limits<Nanoseconds>::max() / 2};
  return bytes.one_in(16) ? odd[bytes.below(7)] : (1 + bytes.below(24)) * kMillisecond;
}

/// A hand about the first body: where its palm is, from there.
struct Walk {
  Vector3 offset;
  Quaternion orientation;
};

inline HandJoints hand_of(Bytes& bytes, Side side, const Vector3& about, Walk& walk) {
  static const Vector3 kPalm(0.1, 0.0, -0.02);  // in the hand's frame
  walk.offset += vector_of(bytes, bytes.one_in(12) ? 0.3 : 0.012);
  walk.offset = walk.offset.cwiseMax(-0.12).cwiseMin(0.12);
  if (bytes.one_in(12)) walk.orientation = orientation_of(bytes);
  const Pose wrist{about + walk.offset - walk.orientation * kPalm, walk.orientation};
  HandJoints hand = hand_joints(human_hand(), side, wrist, posture_of(bytes));
  hand.id = side == Side::left ? 2 : 1;
  if (bytes.one_in(24)) spoil(bytes, hand);
  return hand;
}

/// `model`: instead of the one that the bytes choose.
inline StepCase step_case(const std::uint8_t* data, std::size_t size,
                          const std::optional<ContactModelKind>& model = {}) {
  Bytes bytes(data, size);
  StepCase made;
  made.configuration = configuration_of(bytes);
  if (model) made.configuration.contact_model = *model;
  const StepKind kind(size > 0 ? data[size - 1] : 0);
  made.overlaps = kind.overlaps;
  made.scene = scene_of(bytes, made.configuration, kind);
  const Vector3 about = made.scene.bodies.empty() ? Vector3::Zero() : made.scene.bodies[0].start.position;
  Walk right{vector_of(bytes, 0.08), orientation_of(bytes)},
      left{vector_of(bytes, 0.08), orientation_of(bytes)};
  Nanoseconds stamp = testing::kStart;
  while (bytes.left() && made.frames.size() < kMostFrames) {
    JointsFrame frame{stamp, {}};
    const int who = bytes.below(8);  // mostly the right hand alone
    if (who != 7) frame.hands.push_back(hand_of(bytes, Side::right, about, right));
    if (who >= 6) frame.hands.push_back(hand_of(bytes, Side::left, about, left));
    made.frames.push_back(std::move(frame));
    const Nanoseconds interval = interval_of(bytes);
    const bool stray =
        interval < 0 || interval > 1'000'000'000;  // of one frame: the next goes on from the last
    if (stray) {
      made.frames.back().stamp = stamp + interval;
    } else {
      stamp += interval;
    }
  }
  return made;
}

}  // namespace mrhi::fuzzing
