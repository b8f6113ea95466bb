#pragma once

#include <vector>

#include "clearance_finder.h"
#include "finger_chain.h"
#include "hand_renderer.h"
#include "offset_solver.h"

namespace mrhi {

/// How far the joints of a shown hand may go in a frame.
class Pace {
 public:
  /// From where they were in `before`, `way` at the most [m]. Keeps a reference.
  Pace(const Hand& before, double way) : before_(before), way_(way) {}

  /// By how much the joint goes too far that goes the farthest [m]; < 0: none does.
  double beyond(const Hand& placed) const;

  /// Each joint that goes too far, and each in `clearances` already, must keep off the plane that touches the
  /// ball it may be in. Returns the least gap [m], at most 0.
  double keep(const Hand& placed, std::vector<Clearance>& clearances) const;

  /// Takes the joints out of `clearances` again.
  static void forget(std::vector<Clearance>& clearances);

 private:
  const Hand& before_;
  double way_;
};

constexpr double kClear = 2e-5;      ///< gaps of more than -this are clear [m]
constexpr double kTolerated = 1e-4;  ///< a gap of less than -this is too deep once all is done [m]
constexpr double kDeepest = 1.8e-4;  ///< what is promised is 0.2 mm: where only that keeps pace [m]
constexpr double kAhead = 0.0015;    ///< surfaces nearer than this are kept off before they are met [m]

/// What a hand was shown like. Placing it anew gives the same bits: it is kept to be quick.
struct Shown {
  bool known = false;
  Hand tracked, hand;
  HandOffset offset;
};

/// What one hand's frame is made with. `setting` is the frame's, `offset` what is looked for, `placed` the
/// hand with it, `last` the offset of the frame before and `reference` the same on its way home.
struct HandRenderer::Impl {
  Impl(const Scene& scene, const ContactFinder& contact_finder) : finder(scene, contact_finder) {
    clearances.reserve(256);
  }

  bool begin(const ClearanceFinder::Setting& setting, const HandTrack& track, const HandOffset& last);
  HandOffset keep_outside(ClearanceFinder::Setting& setting, const HandTrack& track, Nanoseconds stamp,
                          const HandOffset& offset, bool near, Hand& placed);
  bool show_in(bool fixtures, Interaction* interactions) const;
  void look_back(const HandTrack& track, Nanoseconds stamp, const HandOffset& last,
                 ClearanceFinder::Setting& setting);
  void place_before();
  FingerChain& finger_before(int index);
  void push_out(const ClearanceFinder::Setting& setting, const HandOffset& last, double least,
                HandOffset& offset, Hand& placed);
  void keep_pace(const ClearanceFinder::Setting& setting, const HandOffset& last, const HandOffset& reference,
                 HandOffset& offset, Hand& placed);
  void keep_out(const ClearanceFinder::Setting& setting, const HandOffset& reference,
                const OffsetBounds& bounds, HandOffset& offset, Hand& placed);
  double settle(const ClearanceFinder::Setting& setting, const HandOffset& reference,
                const OffsetBounds& bounds, HandOffset& offset, Hand& placed, const Pace* pace = nullptr,
                double tolerated = kTolerated);
  void begin_anew(const ClearanceFinder::Setting& setting, const HandOffset& reference, HandOffset& offset,
                  Hand& placed);
  double pushed_way(const ClearanceFinder::Setting& setting, const Hand& placed) const;
  HandOffset staying(const ClearanceFinder::Setting& setting, const PalmLag& lag);
  Quaternion frame_staying(const ClearanceFinder::Setting& setting, const Quaternion& whole) const;
  PalmLag lag_staying(const ClearanceFinder::Setting& setting);
  double held_by_limits(const ClearanceFinder::Setting& setting, const PalmLag& lag);
  void linearise(const Hand& placed);
  void shift_out(const ClearanceFinder::Setting& setting, HandOffset& offset, Hand& placed);
  void lead_out(const ClearanceFinder::Setting& setting, HandOffset& offset, Hand& placed);
  double way(const HandOffset& from, const HandOffset& to);
  bool left_behind(const ClearanceFinder::Setting& setting, Nanoseconds stamp, HandOffset& offset);

  ClearanceFinder finder;
  HandChain chain;
  HandChain chain_before;         // set to the frame before once it is asked for
  bool chain_before_set = false;  // for this hand and frame
  std::vector<Clearance> clearances;
  Hand before;               // as it was shown at the frame before
  Hand tracked_before;       // and as it was tracked
  HandOffset offset_before;  // and its offset
  std::array<Shown, kMaxHands> kept;
  bool pushed = false;  // bodies are in the way
  double leap = 0.0;    // of a joint beyond what hand and bodies have moved, if there is no other way [m]
  double tracked_way = 0.0;  // of the farthest joint since then [m]
  double elapsed = 0.0;      // since then [s]
};

/// The offset on its way back to none, from where it was at the frame before to `stamp`: it decays, and no
/// joint goes farther in one frame than a person would see as a jump. Within the joints' limits of now.
/// `chain` has the palm so (lag_returning).
HandOffset returning(const HandOffset& offset, Nanoseconds stamp, HandChain& chain);

/// HandOffset::lag likewise.
PalmLag lag_returning(const HandOffset& offset, Nanoseconds stamp);

}  // namespace mrhi
