#pragma once

#include <functional>
#include <vector>

#include "contact_step.h"
#include "impact.h"
#include "islands.h"
#include "strike.h"

namespace mrhi {

enum class ImpactFriction { none, coulomb };

/// The impulse phase: Newton's impact law along the normal, once per approach. Strikes of one pair of bodies,
/// and all on an island that a hand strikes, are one blow: each one's relative velocity becomes at least
/// -restitution times what it was on impact, with impulses that only push. Blows between other pairs follow
/// each other in time, each as the ones before it have left the bodies, up to several of one pair in a step.
/// In a crowd, an island of many contacts, all strikes of a step are one blow, found to what can be seen, and
/// only those that are faster than gravity makes things in a step: springs do the rest.
/// Where that together with friction would give the bodies more energy than they had, they part by less.
/// With ImpactFriction::coulomb, sliding at the point is stopped as far as static friction times the normal
/// impulse goes.
class ImpactSolver {
 public:
  ImpactSolver();
  /// Gives where its springs alone take the body of an island of one: its velocity at the step's end.
  using SpringMotion = std::function<Twist(const Island&)>;
  /// With `springs`, what a hand holds is struck only by what its springs do not carry it away from: by its
  /// velocity at the step's start alone, every phalanx beside a grip that speeds up would strike.
  void resolve(ContactStep& step, const Islands& islands, ImpactFriction friction,
               const SpringMotion& springs = {});

 private:
  void collect(ContactStep& step, const Island& island);
  void add(ContactStep& step, Contact& contact);
  void add(ContactStep& step, BodyContact& contact);
  void add(Strike strike, const Material& material);
  void note_twists(const ContactStep& step, const Island& island);
  bool is_slow(const ContactStep& step, const BodyContact& contact) const;
  void spare_carried(const ContactStep& step, const Twist& carried);
  void spare_slow(const ContactStep& step);
  void deal_at_once(ContactStep& step);
  void deal_in_turn(ContactStep& step, const Island& island);
  bool find_blow(double end);
  bool deal(ContactStep& step);
  bool solve(double most);
  double gain() const;
  void keep_to_energy(double most);
  void report(ContactStep& step);

  ImpactFriction friction_ = ImpactFriction::none;
  std::vector<Strike> strikes_;   // those of an island
  std::vector<double> meetings_;  // when each of them will collide, as the bodies move now [s]
  std::vector<Strike*> blow_;     // those dealt together
  std::vector<BodyImpact> impacts_;
  std::vector<Twist> twists_;  // by body, of a crowd's
  std::vector<TwoBlows> both_;
  bool by_hand_ = false;  // a hand takes part in this island's strikes
  /// How exactly a blow is solved.
  struct Care {
    int sweeps;
    double converged;  // of the approach velocity
  };
  static const Care kExact, kVisible;
  Care care_ = kExact;
  std::size_t work_ = 0;  // strikes relaxed for this island
};

}  // namespace mrhi
