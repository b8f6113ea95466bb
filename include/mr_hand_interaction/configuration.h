#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/body.h"

namespace mrhi {

/// Name of a contact model in contact_models() (response/contact_model.h). The constants are those that tests
/// and benchmarks use; a new model needs none.
struct ContactModelKind {
  std::string_view name;  ///< with static storage

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

/// Name of a filter in hand_filters() (src/tracking/hand_filter.h), like ContactModelKind.
struct FilterKind {
  std::string_view name;  ///< with static storage

  static const FilterKind none, window, one_euro, constant_velocity;

  friend bool operator==(const FilterKind& a, const FilterKind& b) { return a.name == b.name; }
  friend bool operator!=(const FilterKind& a, const FilterKind& b) { return !(a == b); }
};
inline constexpr FilterKind FilterKind::none{"none"};
inline constexpr FilterKind FilterKind::window{"window"};
inline constexpr FilterKind FilterKind::one_euro{"one_euro"};
inline constexpr FilterKind FilterKind::constant_velocity{"constant_velocity"};

constexpr double kUsualNoise = 0.0004;  ///< sample noise of a good tracker, rms on an axis [m]

/// Filter and the settings of all filters. Each filter's entry names its settings.
struct FilterConfiguration {
  FilterKind type = FilterKind::constant_velocity;
  int window = 3;                   ///< F of Eq. 1, frames
  bool as_printed = false;          ///< window: Eq. 1's F + 1 terms divided by F, see filter_of()
  double min_cutoff = 2.0;          ///< one_euro: cutoff of a hand at rest [Hz]
  double beta = 100.0;              ///< one_euro: increase of the cutoff with speed [Hz per m/s]
  double derivative_cutoff = 10.0;  ///< one_euro: cutoff of the speed in that increase [Hz]
  std::optional<double> noise;      ///< constant_velocity: of a sample, rms on an axis [m]; unset: estimated
  double acceleration = 0.1;        ///< constant_velocity: of a hand at rest, rms [m/s^2]
  double agility = 4.0;             ///< constant_velocity: increase of the acceleration with speed [1/s]
};

struct TrackingConfiguration {
  double hold_time = 0.2;   ///< time for which a lost hand keeps its last pose [s]
  double max_speed = 12.0;  ///< a faster joint has jumped: no contacts until the hand is clear [m/s]
};

/// Limits of a hand under `implicit`. The paper's hand follows the tracker against any force; a person's hand
/// complies. docs/contact.md has the sources of a person's values.
struct HandStrength {
  static constexpr double kUnlimited = std::numeric_limits<double>::infinity();

  double finger = kUnlimited;  ///< maximum normal force of a finger [N]
  double palm = kUnlimited;    ///< maximum normal force of the palm [N]
  double pad = 0.0;            ///< compression at which a pad reaches the material's stiffness; 0: none [m]
  double finger_mass = kUnlimited;    ///< effective mass of a phalanx in an impact [kg]
  double palm_mass = kUnlimited;      ///< effective mass of the palm in an impact [kg]
  std::optional<double> restitution;  ///< of impacts by the hand, 0 to 1; unset: the object's restitution

  static HandStrength of_a_person() { return {16.0, 32.0, 0.002, 0.02, 0.4, 0.0}; }
};

/// The switches are refinements, all on. Each can be turned off to measure its benefit (docs/contact.md).
struct ContactConfiguration {
  bool sweep = true;            ///< phalanges are swept through the step to their first touch
  bool anchors = true;          ///< friction has an anchor where a phalanx sticks; off: damping only
  bool entry_face = true;       ///< the normal is that of the face of entry; off: of the nearest face
  bool two_points = true;       ///< a phalanx flat on a face has two contact points; off: one
  bool swing_back = true;       ///< a deep phalanx acts as if moved back to the surface along its path
  bool impact_friction = true;  ///< impacts may also reduce sliding (`implicit`)
  bool damping = true;          ///< contact springs have a dashpot (`implicit`, `seed`, `penetration`)
  bool release_fade = true;     ///< contact force fades during separation (`implicit`, `seed`, `penetration`)
  bool torsion = true;          ///< a fingertip resists spin about its contact normal (`implicit`)
  bool edge_grip = true;        ///< an edge that indents a fingertip is held by both its faces (`implicit`)
  bool grasp_assist = true;  ///< a hand that closes around a body and past its surface holds it (`implicit`)
  bool sleep = true;         ///< bodies at rest on others cost nothing until something comes near
  bool literal = false;      ///< seed/literal: Eqs. 1 to 20 as printed (`seed`)
  double object_stiffness = 1e7;  ///< between two objects, which are harder than a hand [N/m]
  HandStrength hand = HandStrength::of_a_person();
};

/// All settings, under the names of `parameters.h`. Immutable while a simulation runs.
struct Configuration {
  ContactModelKind contact_model = ContactModelKind::implicit;
  double step = 0.001;             ///< maximum step of the simulation [s]
  std::optional<Vector3> gravity;  ///< overrides the scene's [m/s^2]
  FilterConfiguration filter;
  std::optional<double> stiffness;  ///< gamma of every body without one in the scene [N/m]; unset: the
                                    ///< contact model's default, see default_material()
  Material material;                ///< of every body without one in the scene
  double density = 1000.0;          ///< of bodies without a mass in the scene [kg/m^3]
  double hand_radius_scale = 1.0;
  double hand_joint_speed = HandStrength::kUnlimited;  ///< limit of a finger's bones in the palm [rad/s]
  /// Visual rendering of mass: largest ratio of a tracked hand's displacement to the rendered hand's, while
  /// it accelerates a heavy object; 1: off.
  double control_display_ratio = 1.0;
  TrackingConfiguration tracking;
  ContactConfiguration contact;
};

/// True if the paper's equations are used as printed: seed/literal under `seed`.
inline bool is_literal(const Configuration& configuration) {
  return configuration.contact.literal && configuration.contact_model == ContactModelKind::seed;
}

}  // namespace mrhi
