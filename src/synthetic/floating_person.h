#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "motions.h"
#include "mr_hand_interaction/scene/scene.h"
#include "person.h"

namespace mrhi {

/// A hand on something, in a frame of its owner's.
struct Handhold {
  Pose wrist;
  HandPosture open, near, closed;  ///< near: just off the surface
  Vector3 retreat;                 ///< unit: direction in which the open hand leaves
};

/// A cylinder of the surroundings that fits into a hand.
struct Rail {
  Vector3 centre, axis;  ///< axis: unit [world]
  double half_length, radius;

  double distance(const Vector3& from) const;
  /// Power grip at the place nearest to `at`, of a person with this orientation: the palm towards the rail,
  /// the thumb up or to the other hand. In world.
  Handhold hold(Side side, const Vector3& at, const Quaternion& person) const;
};

/// The rails among the scene's fixtures. Throws std::invalid_argument if there is none.
std::vector<Rail> rails_of(const Scene& scene);

/// Holds of an object that is to go to `place`, in its frame: by two upright bars with both hands, or with
/// the right hand by grasp_of(), and throws as that does.
std::vector<std::pair<Side, Handhold>> holds_of(const Body& object, const Vector3& place);

/// What a person who floats does for a goal.
struct FloatingGoal {
  enum class Kind : std::uint8_t {
    bring,  ///< the object to `place`: carries it, or throws it to a place out of reach
    rest,   ///< stops, with the operator's centre of mass at `place` if it is set
    work    ///< a practised motion on a device
  };
  Kind kind = Kind::rest;
  std::optional<Vector3> place;  ///< [m, world]
  Skilled skill = Skilled::open_hatch;
};

/// A program in the role of a person who floats, with two hands. It moves along rails: hands close round the
/// rail, pull until the body glides, let go, and hold on again to stop. While hands hold a rail, they follow
/// the path that the body is to take, so that the body takes it. Everything else is done by what was seen a
/// reaction time ago. The same seed and sights give the same bits.
class FloatingPerson : public Person {
 public:
  /// One goal for each of the task's. Throws std::invalid_argument without an operator, and as rails_of() and
  /// holds_of() do.
  FloatingPerson(const OperatorSkill& skill, std::vector<FloatingGoal> goals, const Scene& surroundings,
                 const Body& object, std::uint64_t seed);

  /// Pose of the right hand in the frame in which hands are tracked.
  HandPlace move(double time, const Sight& sight) override;
  std::optional<HandPlace> left_hand() const override { return shown_[kLeft]; }

 private:
  static constexpr std::size_t kLeft = 0, kRight = 1, kHands = 2;

  /// Frame of a hand's path: the operator's; or world, with the body on its foreseen path, or where that is
  /// corrected by what is seen. A free body does not follow by sight what its hand holds: with a reaction
  /// time's delay it would swing.
  enum class Frame : std::uint8_t { body, path, seen };
  struct Arm {
    Frame frame = Frame::body;
    std::vector<Keyframe> keyframes;
    double began = 0.0;
    HandPlace now;         ///< in the operator's frame
    bool on_rail = false;  ///< closed round it
    // Of what it holds or held last.
    Vector3 retreat = Vector3::Zero();  ///< world
    HandPosture near = HandPosture::Zero(), open = HandPosture::Zero();
  };
  /// Foreseen path of the body, from a pose and velocity to others.
  struct BodyPath {
    double began = 0.0, duration = 1.0;
    Pose from;
    Twist begins, travel, ends;  ///< travel: displacement and rotation [m], [rad]
    Pose at(double time) const;
  };

  void decide(double time);
  bool come_to_rest(double time, const std::optional<Vector3>& place);
  void glide_along(double time, const Vector3& at, const Vector3& ahead);
  void bring(double time, const FloatingGoal& goal);
  void carry(double time, const Vector3& place);
  Twist recoil(const Vector3& moved) const;
  void throw_to(double time, const Vector3& direction);
  void work(double time, const FloatingGoal& goal);

  void take_rail(double time, std::size_t first, std::size_t last, const Vector3& ahead);
  void take(double time, std::size_t hand, Handhold hold);
  void release(double delay);
  void rest_hands(double time);
  void correct(double since);
  void drift(double time);
  void lose(double time);
  void follow(double time, const Vector3& to, const Vector3& velocity, double duration);
  void stop(double time);
  void set_path(double time, double duration, const Twist& travel, const Twist& ends);
  void begin(double time, std::size_t hand, Frame frame);
  static std::size_t arm_of(Side side) { return side == Side::left ? kLeft : kRight; }
  const Rail& nearest_rail(const Vector3& to) const;
  Pose frame(double time, Frame frame) const;
  Pose expected_body(double time) const;
  Pose rest_pose(std::size_t hand) const;
  double take_time() const;

  std::vector<FloatingGoal> goals_;
  Pose link_in_body_;
  double mass_;      ///< of the body [kg]
  Matrix3 inertia_;  ///< of it, body axes
  std::vector<Rail> rails_;
  Body object_;
  std::vector<std::pair<Side, Handhold>> holds_;  ///< of the object, in its frame
  Tremor right_tremor_;                           ///< Person's is of the left hand

  std::array<Arm, kHands> arms_;
  std::array<HandPlace, kHands> shown_;
  BodyPath path_;
  Twist deviation_;       ///< of the body from its path, as far as it is corrected [m], [rad]
  Twist deviation_rate_;  ///< [m/s], [rad/s]
  Pose start_;            ///< of the body at first
  int stops_ = 0;         ///< since hands took the rail
  double last_time_ = 0.0;
  double busy_until_ = 0.0;
  bool in_hand_ = false;  ///< the object, as felt by closed hands
};

}  // namespace mrhi
