#include <gtest/gtest.h>

#include <sstream>

#include "support/grips.h"

namespace mrhi {
namespace {

using testing::at;
using testing::smooth;

constexpr double kMasses[] = {0.001, 0.03, 1.0, 100.0};           // [kg]
constexpr double kSteps[] = {0.00025, 0.001, 0.004, 1.0 / 60.0};  // [s]
constexpr double kStiffnesses[] = {50.0, 2000.0, 1e5};            // [N/m]
constexpr int kContacts[] = {1, 2, 5, 10, 20};                    // phalanges
constexpr double kRestitutions[] = {0.0, 0.5, 1.0};
constexpr double kDuration = 0.8;  // [s]
constexpr double kHalf = 0.03;     // of the cube [m]

struct Cell {
  double mass, step, stiffness;
  int contacts;
  double restitution;
};

std::ostream& operator<<(std::ostream& out, const Cell& cell) {
  return out << cell.mass << " kg, " << 1e3 * cell.step << " ms, " << cell.stiffness << " N/m, "
             << cell.contacts << " contacts, restitution " << cell.restitution;
}

/// Fingertips in two grids on opposite sides of the cube, the odd ones on the left.
Hand hand_of(int contacts, double gap, const Vector3& sway) {
  Hand hand = testing::empty_hand();
  for (int i = 0; i < contacts; ++i) {
    const Vector3 outward(i % 2 == 0 ? 1.0 : -1.0, 0, 0);
    const int place = i / 2, count = (contacts + 1 - i % 2) / 2;
    const int columns = count > 4 ? 4 : count, rows = (count + columns - 1) / columns;
    const Vector3 across(0, 0.012 * (place % columns - 0.5 * (columns - 1)),
                         0.016 * (place / columns - 0.5 * (rows - 1)));
    testing::add_fingertip(hand, i, (kHalf + gap) * outward + across + sway, outward, 0.3, Vector3::UnitY());
  }
  return hand;
}

Vector3 sway_at(double t) {
  return smooth(t - 0.3, 0.1) * testing::swing(t - 0.3, 0.01, 3.0);
}

/// Largest speed of any of the cube's points against the hand [m/s]; infinite if anything is not a number.
double largest_speed(const Cell& cell) {
  Body cube = testing::stiff_box(Vector3::Constant(2.0 * kHalf), cell.mass, cell.stiffness);
  cube.material.restitution = cell.restitution;
  Scene scene = testing::scene_of(cube);
  scene.bounds = {Vector3::Constant(-100.0), Vector3::Constant(100.0)};
  Configuration configuration = testing::implicit_configuration();
  configuration.step = cell.step;
  Simulation simulation(scene, configuration);
  const double frame = std::max(1.0 / 120.0, cell.step);
  double largest = 0.0;
  Vector3 last = Vector3::Zero();
  for (int i = 0; i * frame < kDuration; ++i) {
    const double t = i * frame;
    const double gap = 0.005 - 0.007 * smooth(t, 0.2);
    simulation.advance({at(t), {hand_of(cell.contacts, gap, sway_at(t))}});
    if (!testing::finite(simulation.state().bodies[0])) return std::numeric_limits<double>::infinity();
    const Twist twist = testing::object_twist(simulation);
    const Vector3 hand_velocity = (sway_at(t) - last) / frame;
    last = sway_at(t);
    largest = std::max(largest, (twist.linear - hand_velocity).norm() + twist.angular.norm() * kHalf);
  }
  return largest;
}

template <class F>
void for_every_cell(F visit) {
  for (const double mass : kMasses)
    for (const double step : kSteps)
      for (const double stiffness : kStiffnesses)
        for (const int contacts : kContacts)
          for (const double restitution : kRestitutions)
            visit(Cell{mass, step, stiffness, contacts, restitution});
}

/// The fingers close at up to 0.066 m/s and sway at up to 0.19 m/s; an elastic blow doubles that, and a cube
/// thrown to and fro between two closing fingers gains at each. Nothing else may drive it faster.
constexpr double kEjected = 1.0;  // [m/s]

TEST(ImplicitStability, no_mass_step_stiffness_number_of_contacts_or_restitution_diverges_or_ejects) {
  double fastest = 0.0;
  int cells = 0;
  Cell worst{};
  for_every_cell([&](const Cell& cell) {
    const double speed = largest_speed(cell);
    EXPECT_LE(speed, kEjected) << cell;
    ++cells;
    if (speed <= fastest) return;
    fastest = speed;
    worst = cell;
  });
  std::ostringstream where;
  where << worst;
  RecordProperty("cells", cells);
  RecordProperty("fastest_mm_per_s", std::to_string(1e3 * fastest));
  RecordProperty("fastest_cell", where.str());
}

}  // namespace
}  // namespace mrhi
