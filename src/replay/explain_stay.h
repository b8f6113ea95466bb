#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "explain.h"

namespace mrhi {

// What an object's stay with a hand shows: the evidence from which explain_losses.cpp tells why it ended.

/// One stay of an object with a hand: samples [first, last], the last in which they touch being `touched`.
struct Stay {
  const std::string& name;
  const ObjectStory& object;
  std::uint32_t hand_id;
  bool grasped;
  std::size_t first, touched, last;

  double time(std::size_t i) const { return object.samples[i].time; }
  /// Where the search for its cause begins.
  std::size_t window() const;
};

std::vector<FingerTouch> touches_of(const ObjectSample& sample, std::uint32_t hand_id);
/// Sum of the normal forces [N].
double push_of(const std::vector<FingerTouch>& touches);

bool tracking_was_lost(const Stay& stay, const std::vector<HandSample>& hand);

/// Another free object that no hand touches changed its way near this one.
struct Blow {
  std::string by;
  double time = 0.0, speed = 0.0;
};
/// The one worth most, if any counts.
std::optional<Blow> worst_blow(const Stay& stay, const Explanation& story);

struct Opening {
  double begun = 0.0;  ///< when the hand was closed most [s]
  double clear = 0.0;  ///< since when it is open by a tenth of `by`, and more [s]
  double by = 0.0;     ///< in the first frame without touch [m]
};
/// Of a hand that had begun to open as it touched last, and went on.
std::optional<Opening> opening_of(const Stay& stay, const std::vector<HandSample>& hand);

/// Whether in most frames no two fingers could hold a body between them.
bool faces_were_wrong(const Stay& stay);
/// First of the samples from which on all fingers slide to the end, a catch of some frames left out; the end
/// if they do not.
std::size_t slides_from(const Stay& stay);

/// The most that fingers bore along the surfaces [N]: what hangs on a joint is not carried.
double borne_in(const Stay& stay, std::size_t from);
/// The most that the fingers had to bear along the surfaces from a little before they slid [N]: weight, and
/// what it takes to carry the object along.
double load_of(const Stay& stay, const std::vector<HandSample>& hand, const Vector3& gravity,
               std::size_t from);
/// From when to when help bore the object, if it did [s].
std::optional<std::pair<double, double>> helped_in(const Stay& stay);

}  // namespace mrhi
