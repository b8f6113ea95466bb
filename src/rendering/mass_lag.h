#pragma once

#include "mr_hand_interaction/rendering/rendered_hand.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// Longest displacement of a rendered hand by its MassLag [m]: the hand stays at what it holds.
constexpr double kMaxMassLag = 0.05;

/// Acceleration that a hand gives to what it moves, and the mass of that.
struct MovedMass {
  double mass = 0.0;                       ///< of all free bodies that it moves [kg]; 0: none
  Vector3 acceleration = Vector3::Zero();  ///< mean over the frame, by the hand alone [m/s^2]
};

/// By the forces and impulses that the result reports of the hand in `slot` over a frame of `seconds`. Bodies
/// on joints count with all of their linkage. Weight that the hand carries is no acceleration.
MovedMass moved_mass(int slot, double seconds, const Scene& scene, const Vector3& gravity,
                     const FrameResult& result);

/// Ratio of the tracked hand's displacement to that of the rendered hand, while it accelerates `mass` from
/// rest faster than the lag returns: from 1 without mass to `largest` for an infinite one.
double control_display_ratio(double largest, double mass);

/// The lag at `stamp`, after a frame in which the hand moved `moved`. In the frame the lag d obeys
///     d'' + 2 w d' + w^2 d = -(1 - 1 / r) a
/// with r the mass's control-to-display ratio, a its acceleration, and w the rate of the return.
void advance_mass_lag(double largest, const MovedMass& moved, Nanoseconds stamp, MassLag& lag);

/// The hand of a track as it lags: its poses in world at the frame's start and end, by the lags of then.
void lag_behind(const MassLag& before, const MassLag& now, const HandTrack& track, HandTrack& lagging);

}  // namespace mrhi
