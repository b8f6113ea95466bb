#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/body.h"

namespace mrhi {

/// Names one of contact_models() (response/contact_model.h). Those that tests and benchmarks speak of have a
/// name here too; a new one needs none.
struct ContactModelKind {
  std::string_view name;  ///< of static storage

  static const ContactModelKind implicit, seed, penetration, impulse, virtual_spring, soft_pad;

  friend bool operator==(const ContactModelKind& a, const ContactModelKind& b) { return a.name == b.name; }
  friend bool operator!=(const ContactModelKind& a, const ContactModelKind& b) { return !(a == b); }
};
inline constexpr ContactModelKind ContactModelKind::implicit{"implicit"};
inline constexpr ContactModelKind ContactModelKind::seed{"seed"};
inline constexpr ContactModelKind ContactModelKind::penetration{"penetration"};
inline constexpr ContactModelKind ContactModelKind::impulse{"impulse"};
inline constexpr ContactModelKind ContactModelKind::virtual_spring{"virtual_spring"};
inline constexpr ContactModelKind ContactModelKind::soft_pad{"soft_pad"};

/// Names one of hand_filters() (src/tracking/hand_filter.h), as a ContactModelKind does a contact model.
struct FilterKind {
  std::string_view name;  ///< of static storage

  static const FilterKind none, window, one_euro, constant_velocity;

  friend bool operator==(const FilterKind& a, const FilterKind& b) { return a.name == b.name; }
  friend bool operator!=(const FilterKind& a, const FilterKind& b) { return !(a == b); }
};
inline constexpr FilterKind FilterKind::none{"none"};
inline constexpr FilterKind FilterKind::window{"window"};
inline constexpr FilterKind FilterKind::one_euro{"one_euro"};
inline constexpr FilterKind FilterKind::constant_velocity{"constant_velocity"};

constexpr double kUsualNoise = 0.0004;  ///< of a good tracker's sample, rms on an axis [m]

/// The kind of filter, and the settings of all. A setting is one when its filter's entry names it.
struct FilterConfiguration {
  FilterKind type = FilterKind::constant_velocity;
  int window = 3;                   ///< F of Eq. 1, frames
  bool as_printed = false;          ///< window: Eq. 1's F + 1 terms over F, see filter_of()
  double min_cutoff = 2.0;          ///< one_euro: cutoff of a hand at rest [Hz]
  double beta = 100.0;              ///< one_euro: what the cutoff gains with speed [Hz per m/s]
  double derivative_cutoff = 10.0;  ///< one_euro: cutoff of the speed that beta multiplies [Hz]
  std::optional<double> noise;      ///< constant_velocity: of a sample, rms on an axis [m]; unset: estimated
  double acceleration = 0.1;        ///< constant_velocity: of a hand at rest, rms [m/s^2]
  double agility = 4.0;             ///< constant_velocity: what the acceleration gains with speed [1/s]
};

struct TrackingConfiguration {
  double hold_time = 0.2;  ///< a lost hand keeps its last pose this long [s]
  double max_speed =
      12.0;  ///< a joint faster than this has jumped: the hand touches nothing until clear [m/s]
};

/// Limits of a hand under `implicit`. The paper's hand follows the tracker whatever stands against it; a
/// person's hand complies. docs/contact.md has the sources of a person's values.
struct HandStrength {
  static constexpr double kUnlimited = std::numeric_limits<double>::infinity();

  double finger = kUnlimited;  ///< most that a finger pushes with [N]
  double palm = kUnlimited;    ///< most that the palm pushes with [N]
  double pad = 0.0;            ///< depth over which pulp stiffens to the material's stiffness; 0: none [m]
  double finger_mass = kUnlimited;    ///< effective mass of a phalanx in an impact [kg]
  double palm_mass = kUnlimited;      ///< effective mass of the palm in an impact [kg]
  std::optional<double> restitution;  ///< of impacts by the hand, 0 to 1; unset: the object's restitution

  static HandStrength of_a_person() { return {16.0, 32.0, 0.002, 0.02, 0.4, 0.0}; }
};

/// The switches are refinements: on, unless one is turned off to see what it is worth (docs/contact.md).
struct ContactConfiguration {
  bool sweep = true;            ///< a phalanx is followed through the step to where it first touches
  bool anchors = true;          ///< friction remembers where a phalanx sticks; off: it only damps
  bool entry_face = true;       ///< a phalanx pushes from the face by which it entered; off: by the nearest
  bool two_points = true;       ///< a phalanx that lies flat touches at two points; off: at one
  bool swing_back = true;       ///< a phalanx pressed in deep holds as if pushed back the way it came
  bool impact_friction = true;  ///< a blow may also stop the sliding (`implicit`)
  bool damping = true;       ///< a pressed spring has a dashpot beside it (`implicit`, `seed`, `penetration`)
  bool release_fade = true;  ///< it gives back ever less as the two part (`implicit`, `seed`, `penetration`)
  bool torsion = true;       ///< a fingertip resists twisting about its contact normal (`implicit`)
  bool edge_grip = true;     ///< an edge that digs into a fingertip is held by both its faces (`implicit`)
  bool grasp_assist = true;  ///< a hand that closes round a body and through it holds it (`implicit`)
  bool sleep = true;         ///< bodies that lie still on others cost nothing until something comes near
  bool literal = false;      ///< seed/literal: Eqs. 1 to 20 as printed (`seed`)
  double object_stiffness = 1e7;  ///< of a touch between two objects, which are harder than a hand [N/m]
  HandStrength hand = HandStrength::of_a_person();
};

/// Everything that is set from outside, under the names of `parameters.h`. Immutable while a simulation runs.
struct Configuration {
  ContactModelKind contact_model = ContactModelKind::implicit;
  double step = 0.001;             ///< longest step of the simulation [s]
  std::optional<Vector3> gravity;  ///< overrides the scene's [m/s^2]
  FilterConfiguration filter;
  std::optional<double> stiffness;  ///< gamma of every body that the scene says nothing else about [N/m];
                                    ///< unset: the contact model's own, see default_material()
  Material material;                ///< of every body that the scene says nothing else about
  double density = 1000.0;          ///< of bodies whose scene file gives no mass [kg/m^3]
  double hand_radius_scale = 1.0;
  double hand_joint_speed = HandStrength::kUnlimited;  ///< of a finger's bones in the palm [rad/s]
  /// Mass that is seen: largest ratio of a tracked hand's displacement to the rendered hand's, while it
  /// accelerates a heavy object; 1: off.
  double control_display_ratio = 1.0;
  TrackingConfiguration tracking;
  ContactConfiguration contact;
};

/// True if the paper's equations act as printed: seed/literal under `seed`.
inline bool is_literal(const Configuration& configuration) {
  return configuration.contact.literal && configuration.contact_model == ContactModelKind::seed;
}

}  // namespace mrhi
