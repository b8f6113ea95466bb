#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <vector>

#include "collision/body_contact_finder.h"
#include "collision/neighbours.h"
#include "collision/scene_geometry.h"
#include "integration/free_flight.h"
#include "mr_hand_interaction/interaction.h"
#include "mr_hand_interaction/simulation_state.h"
#include "response/contact_step.h"
#include "response/gauss_seidel_solver.h"
#include "response/impact_solver.h"
#include "response/islands.h"
#include "scenes.h"
#include "support/fixtures.h"

namespace mrhi::crowds {
namespace {

constexpr double kStep = 0.001;       // [s]
constexpr int kReference = 200;       // budgets of the reference solution
constexpr std::size_t kMaxExact = 4;  // maximum bodies of an island that is not large

double cpu_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

struct Figures {
  std::vector<double> relative, absolute, cost;
};
/// By the number of bodies, rounded up to a power of two.
using Sizes = std::map<std::size_t, Figures>;

std::size_t rounded_up(std::size_t bodies) {
  std::size_t size = 8;
  while (size < bodies) size *= 2;
  return size;
}

double part_of(std::vector<double> values, double part) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

Scene completed(Scene scene) {
  for (Body& body : scene.bodies) complete(body);
  return scene;
}

/// Bodies that fall, without hands.
class Falling {
 public:
  explicit Falling(const Scene& scene)
      : scene_(completed(scene)),
        configuration_(testing::unfiltered(ContactModelKind::implicit)),
        geometry_(scene_),
        neighbours_(scene_),
        finder_(scene_, geometry_, scene_.gravity),
        model_(make_contact_model(configuration_, scene_, state_, events_)),
        asleep_(scene_.bodies.size(), 0) {
    for (const Body& body : scene_.bodies) bodies_.push_back(start_state(body));
    neighbours_.begin_frame({}, bodies_);
  }

  void advance(Sizes* sizes) {
    neighbours_.begin_step(bodies_, kStep);
    finder_.find(neighbours_, bodies_, asleep_, kStep, 0.0, touches_);
    if (sizes != nullptr) compare(*sizes);
    changes_.reset(bodies_.size());
    ContactStep step = at(touches_, bodies_);
    model_->respond(step);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      free_flight(scene_.bodies[b], changes_.solved(b) ? Vector3::Zero() : scene_.gravity, kStep, bodies_[b]);
    changes_.delay_impacts(scene_.bodies, scene_.gravity, kStep, bodies_);
  }

 private:
  ContactStep at(std::vector<BodyContact>& touches, std::vector<BodyState>& bodies) {
    return {scene_, scene_.gravity, kStep,    configuration_.contact, no_hands_, touches,
            bodies, changes_,       no_grips_};
  }

  void compare(Sizes& sizes) {
    std::vector<Vector3> carried;
    for (const BodyContact& touch : touches_) carried.push_back(touch.force);
    std::vector<BodyContact> touches = touches_;
    std::vector<BodyState> bodies = bodies_;
    changes_.reset(bodies.size());
    ContactStep step = at(touches, bodies);
    Islands islands;
    islands.build(step);
    ImpactSolver().resolve(step, islands, ImpactFriction::coulomb);
    for (const Island& island : islands.all()) {
      if (island.bodies.size() > kMaxExact)
        compare(step, island, carried, sizes[rounded_up(island.bodies.size())]);
    }
  }

  std::vector<BodyState> solved(ContactStep& step, const Island& island, const std::vector<Vector3>& carried,
                                int budgets) {
    std::vector<BodyState> bodies = step.bodies;
    std::vector<BodyContact> touches = step.body_contacts;
    ContactStep copy = at(touches, bodies);
    problem_.begin(copy, island, carried);
    for (int i = 0; i < budgets; ++i) problem_.solve(copy);
    problem_.finish(copy, island);
    return bodies;
  }

  void compare(ContactStep& step, const Island& island, const std::vector<Vector3>& carried,
               Figures& figures) {
    const double from = cpu_time();
    const std::vector<BodyState> cut = solved(step, island, carried, 1);
    const double cost = cpu_time() - from;
    const std::vector<BodyState> exact = solved(step, island, carried, kReference);
    double made = 0.0, off = 0.0;
    for (const IslandBody& body : island.bodies) {
      const double mass = scene_.bodies[body.body].mass;
      const Vector3 free = step.bodies[body.body].linear_momentum + (kStep * mass) * scene_.gravity;
      made = std::max(made, (exact[body.body].linear_momentum - free).norm() / mass);
      off = std::max(off, (exact[body.body].linear_momentum - cut[body.body].linear_momentum).norm() / mass);
    }
    if (made <= 0.0) return;
    figures.relative.push_back(off / made);
    figures.absolute.push_back(off);
    figures.cost.push_back(cost);
  }

  const Scene scene_;
  const Configuration configuration_;
  const SceneGeometry geometry_;
  Neighbours neighbours_;
  BodyContactFinder finder_;
  SimulationState state_;
  std::vector<Event> events_;
  const std::unique_ptr<ContactModel> model_;
  GaussSeidelSolver problem_;
  StepChanges changes_;
  std::vector<char> asleep_;
  std::vector<BodyState> bodies_;
  std::vector<BodyContact> touches_;
  std::vector<Contact> no_hands_;
  std::vector<Grip> no_grips_;
};

/// Compares large islands every `looks` steps.
void play(const Scene& scene, double seconds, int looks, Sizes& sizes) {
  Falling falling(scene);
  for (int i = 1; i <= std::lround(seconds / kStep); ++i) falling.advance(i % looks == 0 ? &sizes : nullptr);
}

void print(const char* scene, const Sizes& sizes) {
  for (const auto& [size, figures] : sizes) {
    std::printf("%s,%zu,%zu,%zu,%.1f,%.1f,%.2e,%.2e,%.2e,%.2e\n", scene, size / 2 + 1, size,
                figures.cost.size(), part_of(figures.cost, 0.5), part_of(figures.cost, 0.99),
                part_of(figures.relative, 0.5), part_of(figures.relative, 0.9),
                part_of(figures.absolute, 0.5), part_of(figures.absolute, 0.9));
  }
}

}  // namespace

void print_cut_short() {
  std::printf("scene,bodies_from,bodies_to,crowds,us,us_p99,relative,relative_p90,off_m_s,off_m_s_p90\n");
  Sizes heaps;
  for (const int count : {8, 16, 32, 64, 125, 250, 500, 1000})
    play(dropped(count, 0.04, "").scene, 1.0, 10, heaps);
  print("heap", heaps);
  Sizes blocks;
  for (const int count : {6, 12, 24, 48, 96, 192, 384, 700, 1000})
    play(block(count, 1e-6).scene, 0.05, 5, blocks);
  print("block", blocks);
}

}  // namespace mrhi::crowds
