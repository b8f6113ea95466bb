#pragma once

#include <array>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// An adult's hand, the palm's own frame: origin at its centre, x to the fingers, y to the thumb of a right
/// hand, z out of the back. A left hand is its mirror image in y. Proportions of the hand skeleton by
/// Buryanov & Kotiuk (Proportions of hand segments, Int. J. Morphol. 28, 2010), rounded to half a millimetre
/// [m].
namespace anatomy {
/// Index to little.
inline const std::array<Vector3, 4> kMetacarpalBases{{{-0.0435, 0.012, 0.012},
                                                      {-0.0405, 0.001, 0.0135},
                                                      {-0.0395, -0.0105, 0.0125},
                                                      {-0.042, -0.0215, 0.0055}}};
inline const std::array<Vector3, 4> kKnuckles{
    {{0.023, 0.023, 0.002}, {0.0235, 0.003, 0.004}, {0.0175, -0.0175, 0.004}, {0.0095, -0.0355, 0.0}}};
inline const Vector3 kWrist{-0.068, -0.008, 0.003};
/// Metacarpal to distal [mm]. The thumb has no metacarpal in the palm: its own counts as proximal.
constexpr double kBoneLengths[kFingers][kBonesPerFinger] = {{0.0, 46.22, 31.57, 21.67},
                                                            {68.12, 39.78, 22.38, 15.82},
                                                            {64.60, 44.63, 26.33, 17.40},
                                                            {58.00, 41.37, 25.65, 17.30},
                                                            {53.69, 32.74, 18.11, 15.96}};
constexpr double kFingerRadii[kFingers] = {9.4, 9.0, 8.8, 8.4, 7.4};  // [mm]
constexpr double kPalmWidth = 0.0842;
}  // namespace anatomy

/// Limits of a hand's size, as a factor on the adult's. Beyond them the unit or the joints are wrong.
constexpr double kSmallestHand = 0.3, kLargestHand = 2.5;

}  // namespace mrhi
