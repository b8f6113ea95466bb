#pragma once

#include "islands.h"
#include "spring_contact.h"

namespace mrhi {

/// A contact between the bodies of an island, which are numbered from 0. Where 1 is a hand or a fixture, `a`
/// is kAlone and 1 moves as `drive` says.
struct IslandContact {
  static constexpr int kAlone = -1;

  SpringContact spring;
  int a = kAlone, b = 0;
  Vector3 arm_a = Vector3::Zero(), arm_b;  // from the bodies' centres [m]
  Vector3 drive = Vector3::Zero();         // velocity of 1 at the point [m/s]
  double drive_spin = 0.0;                 // of 1 about n [rad/s]
};

/// The contact that an entry of an island stands for; bodies are numbered later.
IslandContact hand_spring(const ContactStep& step, const Contact& contact, bool torsion);
IslandContact body_spring(const ContactStep& step, const BodyContact& contact, double stiffness);

/// Writes what the solution made of it back; u and spin are the relative velocities of 1.
void settle(const ContactStep& step, const IslandContact& solved, const Vector3& u, double spin,
            Contact& contact);
void settle(const ContactStep& step, const IslandContact& solved, const Vector3& u, double spin,
            BodyContact& contact);

}  // namespace mrhi
