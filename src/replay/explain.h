#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "../simulation/contact_phase.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// What one finger, or the palm, does to an object in a frame: of all its contacts together.
struct FingerTouch {
  std::uint32_t hand_id = 0;
  int finger = 0;                     ///< 0 thumb to 4 little, 5 palm
  double normal = 0.0;                ///< push [N]
  double tangential = 0.0;            ///< force along the surface [N]
  double limit = 0.0;                 ///< of that by friction [N]
  double depth = 0.0;                 ///< of the deepest [m]
  bool slips = false;                 ///< all of it
  Vector3 outward = Vector3::Zero();  ///< from the object to the finger, world, unit
  std::string face;                   ///< axis of the object that this is nearest to: "+x"

  double share() const { return limit > 0.0 ? tangential / limit : 0.0; }
};
std::string finger_text(int finger);  ///< "the thumb", "the palm"

enum class Course : std::uint8_t { free, contact, hold, slip, drop };
const char* to_string(Course course);

struct ObjectSample {
  double time = 0.0;  ///< since the first frame [s]
  Course course = Course::free;
  InteractionLevel level = InteractionLevel::none;  ///< the highest of any hand
  std::vector<FingerTouch> fingers;
  std::vector<int> struck;      ///< fingers that struck it since the frame before, and touch it no more
  std::uint32_t struck_by = 0;  ///< the hand
  Vector3 position = Vector3::Zero();  ///< of the centre of mass [m]
  Quaternion orientation = Quaternion::Identity();
  Vector3 velocity = Vector3::Zero();  ///< [m/s]
  double torque = 0.0;                 ///< of the hands' forces about the line through the grip [N m]
  double margin = 0.0;  ///< what friction could bear along the surfaces beyond what it bears [N]
  double bearable =
      0.0;  ///< how many times the load, force and torque together, friction could bear; see grip_margin.h
  bool helped = false;  ///< contact/grasp_assist bears it
};

struct HandSample {
  double time = 0.0;
  std::uint32_t id = 0;
  double speed = 0.0;       ///< of the palm [m/s]
  double confidence = 1.0;  ///< as the tracker has it
  bool lost = false;        ///< not in this frame: keeps its pose
  Hand hand;                ///< filtered
};

enum class LossCause : std::uint8_t {
  tracking_lost,
  blow,
  hand_opened,
  help_gave_way,
  wrong_faces,
  too_little_friction,
  too_little_force,
  not_known
};
const char* to_string(LossCause cause);

/// An object that a hand had, or tried to have, and has no longer.
struct Loss {
  std::string object;
  std::uint32_t hand_id = 0;
  bool grasped = true;             ///< false: the fingers pressed, and it never was a grasp
  double from = 0.0, until = 0.0;  ///< [s]
  LossCause cause = LossCause::not_known;
  std::string by;                ///< of a blow: what struck
  double opened = 0.0;           ///< of a hand that opened: since when [s]
  double push = 0.0;             ///< of all fingers together as it began to go [N]
  double load = 0.0;             ///< most that had to be borne along the surfaces [N]
  double friction = 0.0;         ///< of the object, static
  double friction_needed = 0.0;  ///< with that push
  double push_needed = 0.0;      ///< with that friction, more than there was [N]
  double bearable = 0.0;         ///< least, while it was held, of ObjectSample::bearable
  std::string text;              ///< one paragraph
};

/// An object that was touched, never held, and left: swept away, or struck.
struct Touch {
  std::string object;
  std::uint32_t hand_id = 0;
  double from = 0.0, until = 0.0;  ///< [s]
  std::vector<int> fingers;        ///< in the order in which they came
  double speed = 0.0;              ///< that it had more of afterwards [m/s]
};

struct ObjectStory {
  double mass = 0.0;
  std::string joint;  ///< by which it hangs on another, or empty
  Material material;
  double radius = 0.0;             ///< bounding [m]
  Vector3 half = Vector3::Zero();  ///< of a box; else 0
  std::vector<ObjectSample> samples;
};

struct JointSample {
  double time = 0.0, position = 0.0;  ///< [s], [rad] or [m]
};

struct JointStory {
  std::string body;  ///< that hangs on it
  bool turns = true;
  double lower = 0.0, upper = 0.0;  ///< infinite where there is none
  std::vector<JointSample> samples;
};

struct ToldEvent {
  double time = 0.0;
  EventKind kind = EventKind::hover_begin;
  std::string object;  ///< empty for events of hands
  std::uint32_t hand_id = 0;
};

/// Where a picture tells most.
struct PictureMoment {
  enum class What : std::uint8_t { grasp, before_loss, loss } what = What::grasp;
  std::string object;
  double time = 0.0;                 ///< [s]
  std::optional<std::size_t> loss;   ///< of the losses, the one that it is about
  Vector3 place, palm;               ///< of the object and of the hand [m]
  Vector3 across = Vector3::Zero();  ///< between thumb and fingers, unit; 0 where nothing is known
  double radius = 0.0;               ///< of the object [m]
};
const char* to_string(PictureMoment::What what);

struct Explanation {
  std::string input;
  std::vector<std::string> facts;  ///< of the run as a whole, a sentence each
  Vector3 gravity = Vector3::Zero();
  std::map<std::string, ObjectStory> objects;  ///< that move
  std::map<std::string, JointStory> joints;
  std::map<std::uint32_t, std::vector<HandSample>> hands;
  std::vector<ToldEvent> events;
  std::vector<double> times;  ///< of all frames [s]
  std::vector<Loss> losses;
  std::vector<Touch> touches;
  std::vector<PictureMoment> moments;
};

/// Watches a run, frame by frame, and says in the end why what was lost was lost.
class Explainer {
 public:
  /// After each frame.
  void watch(const Simulation& simulation);
  Explanation explain(const std::string& input);

 private:
  void watch_object(const Simulation& simulation, std::size_t body, double time);
  void watch_joint(const Simulation& simulation, std::size_t joint, double time);

  bool begun_ = false;
  Nanoseconds first_ = 0;
  Explanation story_;
};

/// Finds the losses in what has been watched, and the touches that were none.
void find_losses(Explanation& story);
/// At each grasp, shortly before each loss, and at it, in the order of time.
std::vector<PictureMoment> picture_moments(const Explanation& story);

std::string to_json(const Explanation& explanation);
/// One page that needs nothing else.
std::string to_html(const Explanation& explanation);

}  // namespace mrhi
