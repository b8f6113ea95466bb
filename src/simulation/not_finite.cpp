#include <algorithm>
#include <cmath>

#include "frame_report.h"
#include "simulation_impl.h"

namespace mrhi {
namespace {

bool finite(const Vector3& v) {
  return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}
/// Tests the sum of its numbers: opposite infinities give NaN.
bool finite(const Hand& hand) {
  Vector3 sum = hand.palm.position + hand.wrist;
  double radii = hand.palm.orientation.coeffs().sum();
  for (const Capsule& capsule : hand.capsules) {
    sum += capsule.start + capsule.end;
    radii += capsule.radius;
  }
  return std::isfinite(sum.sum() + radii);
}
bool finite(const Contact& contact) {
  return finite(contact.force) && finite(contact.impulse) && finite(contact.point) &&
         finite(contact.normal) && std::isfinite(contact.depth);
}

std::string name_of(const Hand& hand) {
  return "hand " + std::to_string(hand.id);
}

}  // namespace

/// Tests the sum of its numbers: opposite infinities give NaN.
bool is_finite(const BodyState& state) {
  return std::isfinite(state.pose.position.sum() + state.pose.orientation.coeffs().sum() +
                       state.linear_momentum.sum() + state.angular_momentum.sum());
}

void Simulation::Impl::lose_hands_that_are_not_finite(Nanoseconds now) {
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    HandTrack& track = state.hands[slot];
    if (!track.active || finite(track.current)) continue;
    result.not_finite.push_back(name_of(track.current));
    end_interactions(slot, now, state, result.events);
    result.events.push_back({now, EventKind::hand_lost, -1, track.current.id});
    track = HandTrack();
    state.offsets[slot] = HandOffset();
    state.mass_lags[slot] = MassLag();
  }
}

/// Shows the tracked hand if the rendered one is not finite.
void Simulation::Impl::show_hands_that_are_finite() {
  for (std::size_t i = 0; i < result.rendered.size(); ++i) {
    if (finite(result.rendered[i].hand)) continue;
    result.not_finite.push_back("rendered " + name_of(result.tracked[i]));
    result.rendered[i].hand = result.tracked[i];
    std::fill(state.offsets.begin(), state.offsets.end(), HandOffset());
    std::fill(state.mass_lags.begin(), state.mass_lags.end(), MassLag());
  }
}

void Simulation::Impl::leave_out_contacts_that_are_not_finite() {
  const auto end = std::remove_if(result.contacts.begin(), result.contacts.end(), [this](const Contact& c) {
    if (finite(c)) return false;
    result.not_finite.push_back("contact with '" + scene.bodies[c.key.body].name + "'");
    return true;
  });
  result.contacts.erase(end, result.contacts.end());
}

}  // namespace mrhi
