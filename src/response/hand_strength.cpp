#include "finger_limits.h"

#include <algorithm>
#include <array>

#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {
namespace {

constexpr int kParts = kFingers + 1;  // of a hand: its fingers and the palm

bool is_palm(const ContactKey& key) {
  return key.capsule == kPalm;
}
double pressed_by(const Contact& contact) {
  return contact.ignored ? 0.0 : contact.share * std::max(contact.pressed(), 0.0);
}

}  // namespace

// A finger gives way once its contacts together push with its strength: each has the part of it that it has
// of the depths, as equal springs side by side.
void share_strength(const HandStrength& hand, std::vector<Contact>& contacts) {
  std::array<std::array<double, kParts>, kMaxHands> depths{};
  const auto of = [&depths](const ContactKey& key) -> double& {
    return depths[key.hand][static_cast<std::size_t>(finger_of(key.capsule))];
  };
  for (const Contact& contact : contacts) of(contact.key) += pressed_by(contact);
  for (Contact& contact : contacts) {
    const double together = of(contact.key), strength = is_palm(contact.key) ? hand.palm : hand.finger;
    const double part = together > 0.0 ? pressed_by(contact) / together : 1.0;
    contact.strength = part > 0.0 ? part * strength : strength;
    contact.inverse_mass = 1.0 / (is_palm(contact.key) ? hand.palm_mass : hand.finger_mass);
  }
}

}  // namespace mrhi
