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
  double time;      ///< from the step's start [s]
};

/// What a step's response has done to the bodies, as far as their motion through the step depends on it.
class StepChanges {
 public:
  void reset(std::size_t bodies);

  /// The body's momenta are those of the step's end, gravity included.
  void mark_solved(int body) { solved_[static_cast<std::size_t>(body)] = true; }
  bool solved(std::size_t body) const { return solved_[body]; }

  /// Impacts whose impulses `bodies` have just been given.
  void note_impacts(const std::vector<BodyImpact>& impacts, const std::vector<BodyState>& bodies);

  /// A body that something else has moved on through the step, impacts and all.
  void forget(int body);

  /// When what springs do to the body begins to act, from the step's start: 0, or the mean time of impacts
  /// [s].
  double mean_impact_time(std::size_t body) const;

  /// Call when free flight has moved the bodies by `step` seconds: takes back what the impacts' changes of
  /// velocity did before their times, so that an object is not pushed ahead of the hand. What springs did
  /// about the impacts counts with them: an object that is held and struck stays where it is held.
  void delay_impacts(const std::vector<Body>& scene, const Vector3& gravity, double step,
                     std::vector<BodyState>& bodies) const;

 private:
  struct Struck {
    int body;
    Vector3 linear_before, angular_before;  // momenta before the impacts
    Vector3 linear, angular;                // of all impulses together [N s], [N m s]
    Vector3 linear_moment, angular_moment;  // each times its time
    double size, size_moment;               // magnitudes, and each times its time
  };
  Struck& struck(int body, const BodyState& after);

  std::vector<char> solved_;
  std::vector<int> places_;  // by body: in struck_, or -1
  std::vector<Struck> struck_;
};

/// What a contact model works on in one step.
/// In a step: contacts are found at the poses of its start; respond() changes momenta, by h g too where it
/// says so (mark_solved); free flight moves the poses on; delay_impacts() takes back what blows moved
/// before their time.
struct ContactStep {
  const Scene& scene;
  const Vector3& gravity;                   ///< [m/s^2]
  double step;                              ///< [s]
  std::vector<Contact>& contacts;           ///< with hands, sorted by key; the model fills what acts
  std::vector<BodyContact>& body_contacts;  ///< of bodies with each other, sorted by key; likewise
  std::vector<BodyState>& bodies;  ///< the model changes momenta; free flight then advances the poses
  StepChanges& changes;
  std::vector<Grip>& grips;  ///< what hands hold, by hand and body; `implicit` alone knows them
  /// The bodies of the operators whom hands push back, by hand; null where hands are of the world. Contacts
  /// and grips then tell the forces that momenta are made of.
  const std::array<int, kMaxHands>* operators = nullptr;
};

/// True if all that changes a body's momenta in the response is the hands of the only operator, from the
/// step's start on: the operator then receives the opposite of that change, whatever the contacts' forces.
inline bool reacts_by_momentum(const ContactStep& step, std::size_t body) {
  return step.scene.operators.size() == 1 && step.scene.joints.empty() && step.body_contacts.empty() &&
         step.changes.mean_impact_time(body) == 0.0;
}

/// How an object responds to contacts. All memory is in the contacts: a model keeps nothing but scratch
/// space.
class ContactModel {
 public:
  virtual ~ContactModel() = default;
  virtual void respond(ContactStep& step) = 0;
};

/// Objects touch each other by the law of `implicit` under every model. Throws std::invalid_argument for a
/// name that is not known.
/// The model of a scene with joints keeps references: to the state for what joints remember, and to the
/// events, to which it adds those of joints.
std::unique_ptr<ContactModel> make_contact_model(const Configuration& configuration, const Scene& scene,
                                                 SimulationState& state, std::vector<Event>& events);

}  // namespace mrhi
