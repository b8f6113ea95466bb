#pragma once

#include "islands.h"
#include "spring_contact.h"

namespace mrhi {

/// A contact between the bodies of an island, which are numbered from 0. Where 1 is a hand or a fixture, `a`
/// is kAlone and 1 moves as `drive` says. World axes.
struct IslandContact {
  static constexpr int kAlone = -1;
  IslandContact() {}  // leaves it to make_spring

  Spring<double> spring;
  SpringResponse<double> response;  // of the last iterate
  Vector3 arm_a, arm_b;             // from the bodies' centres [m]
  Vector3 drive;                    // velocity of 1 at the point [m/s]
  double drive_spin;                // of 1 about n [rad/s]
  int a, b;
};

/// Makes `result` the contact that an entry of an island stands for; bodies are numbered later.
void make_spring(const ContactStep& step, const Contact& contact, const ContactConfiguration& configuration,
                 IslandContact& result);
void make_spring(const ContactStep& step, const BodyContact& contact,
                 const ContactConfiguration& configuration, IslandContact& result);

/// Writes what the solution made of it back.
void settle(const ContactStep& step, const IslandContact& solved, Contact& contact);
void settle(const ContactStep& step, const IslandContact& solved, BodyContact& contact);

}  // namespace mrhi
