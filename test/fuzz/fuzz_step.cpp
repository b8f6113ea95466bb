// The step itself: whatever hands do, what the laws say holds.
#include <chrono>
#include <cmath>
#include <optional>

#include "fuzz/step_case.h"
#include "text/text.h"

namespace {

using namespace mrhi;
using fuzzing::require;

/// Beyond any step of these scenes, with sanitizers, on a busy machine.
constexpr double kLongestStep = 2.0;  // [s]

/// Of what has flowed: where the solvers of a step end.
constexpr double kRounding = 1e-5;
/// Part of its energy by which a body that is struck may be wrong, as it turns on within the step [1/s].
constexpr double kTurning = 20.0;

double potential(const Scene& scene, const BodyState& state, std::size_t body) {
  return -scene.bodies[body].mass * scene.gravity.dot(state.pose.position);
}

/// Energy and momentum of the free bodies, and what the hands have done to them since nothing was touched: a
/// spring that is pressed has taken work that it gives back later.
class Ledger {
 public:
  explicit Ledger(const Simulation& simulation)
      : simulation_(simulation), before_(now()), largest_(before_.size) {}

  /// After a step of `seconds`.
  void note(double seconds) {
    bool struck = false;
    pressed_.swap(pressed_before_);
    pressed_.clear();
    for (const Contact& contact : simulation_.state().contacts) {
      const Material& material = simulation_.scene().bodies[contact.key.body].material;
      const Vector3 impulse = contact.force * seconds + contact.impulse;
      impulse_ += impulse;
      flow_ += impulse.norm() * (1.0 + contact.hand_velocity.norm());
      // A fingertip that turns does work by torsion, which Coulomb's law bounds.
      work_ += impulse.dot(contact.hand_velocity) +
               material.static_friction * contact.patch * impulse.norm() * std::abs(contact.hand_spin);
      struck = struck || !contact.impulse.isZero(0.0);
      if (contact.touching()) note_pressed(contact, material.stiffness);
    }
    for (const BodyContact& contact : simulation_.state().body_contacts)
      struck = struck || !contact.impulse.isZero(0.0);
    if (struck) work_ += kTurning * seconds * now().size;
    for (const Body& body : simulation_.scene().bodies)
      if (!body.fixed) impulse_ += body.mass * seconds * simulation_.scene().gravity;
    largest_ = std::max(largest_, now().size);
  }

  void check(bool momentum) const {
    const Sum after = now();
    const double rounding = kRounding * (largest_ + flow_);
    require(after.energy <= before_.energy + work_ + rounding,
            "energy " + text::number(after.energy) + " J is at most " + text::number(before_.energy) +
                " J and the hands' work, " + text::number(work_) + " J");
    if (!momentum) return;
    const double off = (after.momentum - before_.momentum - impulse_).norm();
    require(off <= rounding, "momentum is what the hands gave, but for " + text::number(off) + " of " +
                                 text::number(largest_ + flow_) + " N s");
  }

 private:
  struct Sum {
    double energy = 0.0, size = 0.0;
    Vector3 momentum = Vector3::Zero();
  };
  /// What a finger is in the body already when the touch begins, its spring has without having been seen to
  /// take it.
  void note_pressed(const Contact& contact, double stiffness) {
    const std::uint64_t key = contact.key.order();
    pressed_.push_back(key);
    if (std::find(pressed_before_.begin(), pressed_before_.end(), key) == pressed_before_.end())
      work_ += 0.5 * stiffness * contact.depth * contact.depth;
  }
  Sum now() const {
    Sum sum;
    for (std::size_t b = 0; b < simulation_.scene().bodies.size(); ++b) {
      const Body& body = simulation_.scene().bodies[b];
      const BodyState& state = simulation_.state().bodies[b];
      if (body.fixed) continue;
      const double kinetic = kinetic_energy(body, state), height = potential(simulation_.scene(), state, b);
      sum.energy += kinetic + height;
      sum.size += kinetic + std::abs(height) + state.linear_momentum.norm();
      sum.momentum += state.linear_momentum;
    }
    return sum;
  }

  const Simulation& simulation_;
  const Sum before_;
  double work_ = 0.0, flow_ = 0.0, largest_;
  Vector3 impulse_ = Vector3::Zero();
  std::vector<std::uint64_t> pressed_, pressed_before_;
};

bool finite(const Hand& hand) {
  return std::all_of(hand.capsules.begin(), hand.capsules.end(), [](const Capsule& capsule) {
    return capsule.start.allFinite() && capsule.end.allFinite() && std::isfinite(capsule.radius);
  });
}

void check_result(const Simulation& simulation) {
  const FrameResult& result = simulation.result();
  require(result.not_finite.empty(),
          "nothing is put right: " + (result.not_finite.empty() ? "" : result.not_finite[0]));
  for (const Hand& hand : result.tracked) require(finite(hand), "tracked hands are finite");
  for (const RenderedHand& hand : result.rendered) require(finite(hand.hand), "drawn hands are finite");
  for (const Contact& contact : result.contacts)
    require(contact.force.allFinite() && contact.impulse.allFinite(), "forces are finite");
  const Scene& scene = simulation.scene();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyState& state = simulation.state().bodies[b];
    require(state.linear_momentum.allFinite() && state.angular_momentum.allFinite() &&
                state.pose.position.allFinite() && state.pose.orientation.coeffs().allFinite(),
            "bodies are finite");
    require(scene.bodies[b].fixed || ((state.pose.position.array() >= scene.bounds.min.array()).all() &&
                                      (state.pose.position.array() <= scene.bounds.max.array()).all()),
            "bodies are inside the bounds");
  }
}

/// Where nothing is put back, and no help pushes whose forces are no contact's.
bool keeps_books(const Simulation& simulation) {
  const FrameResult& result = simulation.result();
  return !result.restarted && simulation.configuration().contact_model == ContactModelKind::implicit &&
         simulation.state().grips.empty() &&
         std::none_of(result.events.begin(), result.events.end(),
                      [](const Event& event) { return event.kind == EventKind::out_of_bounds; });
}

bool has_fixtures(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) { return body.fixed; });
}

bool touches(const Simulation& simulation) {
  const SimulationState& state = simulation.state();
  return !state.body_contacts.empty() || !state.grips.empty() ||
         std::any_of(state.contacts.begin(), state.contacts.end(),
                     [](const Contact& contact) { return contact.touching(); });
}

/// `ledger`: there while books are kept.
void advance(Simulation& simulation, const HandFrame& frame, std::optional<Ledger>& ledger) {
  using Clock = std::chrono::steady_clock;
  // What is simulated of a silence before a frame is not seen step by step.
  if (simulation.state().started && frame.stamp - simulation.time() > 100'000'000) ledger.reset();
  const Rejection rejection = simulation.begin(frame);
  if (rejection != Rejection::none) return;
  const Clock::time_point began = Clock::now();
  int steps = 0;
  for (Nanoseconds before = simulation.time(); simulation.step(); before = simulation.time(), ++steps) {
    if (ledger) ledger->note(to_seconds(simulation.time() - before));
    if (!simulation.state().grips.empty()) ledger.reset();
  }
  simulation.end();
  require(std::chrono::duration<double>(Clock::now() - began).count() < kLongestStep * (1 + steps),
          "a step takes a bounded time");
  check_result(simulation);
  if (!keeps_books(simulation)) ledger.reset();
  if (ledger) ledger->check(!has_fixtures(simulation.scene()));
  if (!touches(simulation)) ledger.emplace(simulation);
}

std::uint64_t play(const fuzzing::StepCase& played) {
  Simulation simulation(played.scene, played.configuration);
  Nanoseconds last = testing::kStart;
  std::optional<Ledger> ledger;
  for (const JointsFrame& joints : played.frames) {
    std::vector<std::string> defects;
    const auto frame = complete_frame(joints, Pose(), defects);
    if (!frame) continue;
    advance(simulation, *frame, ledger);
    last = std::max(last, simulation.time());
  }
  // The next good frames work.
  int taken = 0;
  for (int i = 1; i <= 4; ++i) {
    const Hand hand = testing::posed_hand(relaxed_posture(), {});
    taken += simulation.advance({last + i * 10'000'000, {hand}}) == Rejection::none;
  }
  require(taken >= 2, "good frames are taken");
  require(simulation.result().tracked.size() >= 1, "a good hand is followed");
  check_result(simulation);
  return hash(simulation.state());
}

}  // namespace

FUZZ_TARGET(step) {
  const fuzzing::StepCase made = fuzzing::step_case(data, size);
  require(play(made) == play(made), "equal input gives equal bits");
}
