#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/tracking/hand_merger.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// The joints of a hand by number: the wrist, then finger by finger.
constexpr std::size_t kHandJoints = 1 + 5 * kFingers;
template <typename Joints>
auto& joint(Joints& hand, std::size_t i) {
  return i == 0 ? hand.wrist : hand.joints[(i - 1) / 5][(i - 1) % 5];
}

/// Size of a hand as a factor on the adult's of hand_anatomy.h: the median ratio of all known bones, and of
/// the distances from the wrist to the knuckles. Nothing for fewer than kMinKnownBones of these.
std::optional<double> relative_size(const HandJoints& hand);
constexpr std::size_t kMinKnownBones = 8;

/// Drops joints that are at a placeholder: the origin, and any point at which joints of two fingers are
/// exactly. A tracker writes them for what it does not see. So it may for the palm centre. Keeps the wrist at
/// the origin if `wrist_is_origin` and the fingers are near: some trackers report a hand relative to its
/// wrist. Returns how many points it drops.
std::size_t drop_placeholders(HandJoints& hand, bool wrist_is_origin = false);

/// Drops joints that make a bone impossibly long, at most a third of those known. Returns how many.
std::size_t drop_stray_joints(HandJoints& hand);

std::size_t known_joints(const HandJoints& hand);

/// True if all coordinates of the known joints are finite.
bool is_finite(const HandJoints& hand);

/// Multiplies all lengths by a factor: metres per unit of the tracker.
void scale(HandJoints& hand, double factor);

/// An order in which trackers list the joints of a hand.
struct JointOrder {
  const char* name;
  std::size_t size;   ///< joints of a hand
  std::size_t wrist;  ///< its place in the list
  /// Places of HandJoints::joints[finger]; kNotListed: none.
  std::array<std::array<std::size_t, 5>, kFingers> joints;

  static constexpr std::size_t kNotListed = static_cast<std::size_t>(-1);
};

/// All known orders. The usual one of each size comes first.
const std::vector<JointOrder>& joint_orders();
/// The usual order of that size; null if there is none.
const JointOrder* usual_order(std::size_t size);
/// Throws std::invalid_argument that lists the known names.
const JointOrder& joint_order(const std::string& name);

/// The hand whose joints are `points`, of the order's size; a point with a coordinate that is not finite is
/// missing. Radii are of the points too, from a joint to the skin [m], or none: 0 and NaN mean unknown.
HandJoints hand_in_order(const JointOrder& order, const Vector3* points, const float* radii, Side side);

/// Recognises the order of a stream of hands by the lengths of their bones, which are those of a hand only in
/// the right order. It begins with the usual order of that size and changes to another that fits better by
/// kMargin.
class OrderRecognition {
 public:
  /// The order for this hand, of a size that has one. `changed` is set if it was another one before. Throws
  /// std::invalid_argument if bones of no known order are a hand's.
  const JointOrder& order_of(std::size_t size, const Vector3* points, bool& changed);

 private:
  // A misfit is the mean of |ln(ratio / size)| over a hand's bones: below 0.1 of a hand, 0.3 and more in a
  // wrong order.
  static constexpr double kMargin = 0.08;
  static constexpr double kMaxMisfit = 0.45;  // of a hand in the best order
  static constexpr double kNewWeight = 0.2;   // of a hand in the running means

  std::size_t size_ = 0;
  const JointOrder* chosen_ = nullptr;
  std::vector<std::optional<double>> misfits_;  // running means, as joint_orders() counts
};

/// Removes steps of a tracker's clock from its stamps, by the times of receipt. Two successive frames that
/// are off by the same time, with evenly spaced receipts, prove a step: the second one then continues the
/// stream according to its receipt. The first one is a stray: a simulation that has just been reset would
/// start at its stamp. A frame that is no further ahead of its receipt than earlier frames were only had a
/// shorter delay.
class StampSteps {
 public:
  struct Verdict {
    Nanoseconds stamp;      ///< without steps
    bool is_step = false;   ///< this frame has proved one
    bool is_stray = false;  ///< far from its stream, and single so far
    bool first_was_off =
        false;  ///< the stream's first frame alone was of another clock; nothing is corrected
  };

  Verdict take(Nanoseconds stamp, const std::optional<Nanoseconds>& receipt);

  /// Correction of the stamps, 0 before the first step. Streams of one clock share it.
  Nanoseconds correction() const { return correction_; }
  void share(Nanoseconds correction) { correction_ = correction; }

 private:
  struct Frame {
    Nanoseconds stamp, receipt;
    Nanoseconds lead() const { return stamp - receipt; }
  };
  Verdict accept(const Frame& frame, bool restarts = false);

  std::optional<Frame> last_;  // accepted, with its original stamp
  std::optional<Frame> off_;   // the frame before, if it was off
  Nanoseconds interval_ = 0;   // between the last two accepted
  Nanoseconds lead_ = 0;       // largest of those accepted, fading: clocks drift
  Nanoseconds correction_ = 0;
  std::uint64_t accepted_ = 0;
};

/// One frame of input, or the reason why it cannot be used.
struct SourceFrame {
  std::optional<HandFrame> frame;
  std::optional<Nanoseconds> arrival;  ///< time of receipt by the receiver's clock, if known
  bool waits = false;                  ///< for the frame of the other hand
  bool first_was_off = false;          ///< the frame before the last of its stream was of another clock
  std::string reason;                  ///< kind of refusal, for counting; empty if there is a frame
  std::string detail;                  ///< the particular case
  std::vector<std::string> left_out;   ///< hands of the frame that cannot be used, each with its defect
  /// Corrected faults: kind, and the particular case.
  std::vector<std::pair<std::string, std::string>> corrected;
};

/// The content of one message of a tracker.
struct TrackerFrame {
  std::string stream;                  ///< sender and topic; a stream has one clock
  JointsFrame joints;                  ///< in the tracker's own frame and unit; stamp 0: not set
  std::optional<Side> side;            ///< its only side, if hands of the other side are on another topic
  std::optional<Nanoseconds> receipt;  ///< time of receipt, if known
  bool one_of_a_side = true;           ///< it never has two hands of one side
};

/// Converts trackers' frames to hands in world, for live nodes, bags and recordings: units, stamps, bursts,
/// placeholders, stray joints, gaps, and pairs of hands. Depends only on its input, so that a replay repeats
/// the live node.
class JointsInput {
 public:
  static constexpr const char* kJointsLeftOut = "joints left out";
  static constexpr const char* kNoHand = "hands of placeholders";
  static constexpr const char* kStep = "clock steps taken out";
  static constexpr const char* kOrder = "order of joints recognised";
  static constexpr const char* kUnpaired = "frames of one hand left out";
  static constexpr const char* kUnusable = "unusable hand";
  static constexpr const char* kNoStamp = "stamp out of range";
  static constexpr const char* kBurst = "frames of a burst";
  static constexpr const char* kStray = "stamp far from its stream";
  static const std::vector<const char*>& corrections();

  /// Pose of the tracker in world at a stamp.
  using Device = std::function<Pose(Nanoseconds)>;

  /// `scale`: metres per unit of the tracker's lengths.
  explicit JointsInput(double scale = 1.0) : scale_(scale) {}

  SourceFrame take(TrackerFrame input, const Device& device);
  /// The frame that still waits at the end of a recording.
  std::optional<HandFrame> rest() { return pairs_.rest(); }

 private:
  struct Stream {
    StampSteps steps;
    Nanoseconds newest = 0, taken = 0;  // stamps
    Nanoseconds interval = 0;           // running mean, also of frames that are left out; 0: unknown
    std::array<bool, 2> wrist_moves{}, is_placeholder{};  // by side

    bool is_burst(Nanoseconds stamp);
  };
  Nanoseconds share_correction(Stream& stream);
  void correct(Stream& stream, JointsFrame& joints, SourceFrame& result) const;
  static SourceFrame completed(const JointsFrame& joints, const Device& device, SourceFrame result);

  double scale_;
  std::map<std::string, Stream> streams_;
  JointGaps gaps_;
  HandPairs pairs_;
};

}  // namespace mrhi
