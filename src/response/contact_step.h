#pragma once

#include <array>
#include <memory>
#include <vector>

#include "mr_hand_interaction/collision/body_contact.h"
#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/response/grip.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

struct Event;
struct SimulationState;

/// An impact on one body.
struct BodyImpact {
  int body;         ///< index in Scene::bodies
  Vector3 impulse;  ///< [N s]
  Vector3 arm;      ///< from the centre of mass to where it acts [m]
  double time;      ///< from the start of the step [s]
};

/// Changes of the bodies by a step's response that affect their motion through the step.
class StepChanges {
 public:
  void reset(std::size_t bodies);

  /// The body's momenta are those at the end of the step, gravity included.
  void mark_solved(int body) { solved_[body] = true; }
  bool solved(std::size_t body) const { return solved_[body]; }

  /// Adds impacts whose impulses `bodies` already have.
  void note_impacts(const std::vector<BodyImpact>& impacts, const std::vector<BodyState>& bodies);

  /// Excludes a body whose motion through the step, impacts included, is computed elsewhere.
  void forget(int body);

  /// Time at which springs begin to act on the body, from the start of the step: 0, or the mean time of its
  /// impacts [s].
  double mean_impact_time(std::size_t body) const;

  /// Delays the effect of impacts to their times. Call after free flight has moved the bodies by `step`
  /// seconds. Removes the displacement by an impact's velocity change before the impact, so that an object
  /// does not move ahead of the hand. The springs' response to impacts is delayed with them: a held object
  /// that is hit stays in place.
  void delay_impacts(const std::vector<Body>& scene, const Vector3& gravity, double step,
                     std::vector<BodyState>& bodies);

 private:
  struct Impacted {
    int body;
    Twist before;              // momenta before the impacts
    Quaternion orientation;    // at the start of the step
    Twist sum;                 // of all impulses [N s], [N m s]
    Vector3 moment;            // of each impulse times its time [N s^2]
    double size, size_moment;  // sum of magnitudes, and of each times its time
  };
  struct Turn {
    int body;
    double time;         // from the start of the step [s]
    std::size_t number;  // in the order of being noted
    Vector3 change;      // of the angular momentum [N m s]
  };
  Impacted& impacted(int body, const BodyState& after);

  std::vector<char> solved_;
  std::vector<int> places_;  // by body: index in impacted_, or -1
  std::vector<Impacted> impacted_;
  std::vector<Turn> turns_;
};

/// Input and output of a contact model in one step. Contacts are found at the poses of its start. respond()
/// changes momenta, also by h g where it calls mark_solved(). Free flight then advances the poses, and
/// delay_impacts() removes displacements before impacts.
struct ContactStep {
  const Scene& scene;
  const Vector3& gravity;  ///< [m/s^2]
  double step;             ///< [s]
  const ContactConfiguration& configuration;
  std::vector<Contact>& contacts;           ///< with hands, sorted by key; output: forces and impulses
  std::vector<BodyContact>& body_contacts;  ///< between bodies, sorted by key; likewise
  std::vector<BodyState>& bodies;  ///< the model changes momenta; free flight then advances the poses
  StepChanges& changes;
  std::vector<Grip>& grips;  ///< of the grasp assist, by hand and body; used by `implicit` only
  /// Bodies of the operators on whom the hands react, by hand; null if hands are fixed to the world. If set,
  /// momenta change by exactly the forces of contacts and grips.
  const std::array<int, kMaxHands>* operators = nullptr;
};

/// True if only the hands of the only operator change the body's momenta in the response, from the start of
/// the step on. The operator then receives the opposite of that change, whatever the contacts' forces.
inline bool reacts_by_momentum(const ContactStep& step, std::size_t body) {
  return step.scene.operators.size() == 1 && step.scene.joints.empty() && step.body_contacts.empty() &&
         step.changes.mean_impact_time(body) == 0.0;
}

/// Response of objects to contacts. All state is in the contacts: a model keeps only scratch memory.
class ContactModel {
 public:
  virtual ~ContactModel() = default;
  virtual void respond(ContactStep& step) = 0;
};

/// ContactModelEntry::make of a model that needs no settings.
template <typename Model>
std::unique_ptr<ContactModel> make_model(const ContactConfiguration&) {
  return std::make_unique<Model>();
}

/// Contacts between objects follow the law of `implicit` under every model. Throws std::invalid_argument for
/// an unknown name. The model of a scene with joints keeps references: to `state` for the joints, and to
/// `events`, to which it adds those of joints.
std::unique_ptr<ContactModel> make_contact_model(const Configuration& configuration, const Scene& scene,
                                                 SimulationState& state, std::vector<Event>& events);

}  // namespace mrhi
