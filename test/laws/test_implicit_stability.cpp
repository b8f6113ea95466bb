#include <gtest/gtest.h>

#include <sstream>

#include "support/stability_map.h"

namespace mrhi {
namespace {

using testing::StabilityCell;
using testing::StabilityGrid;
using testing::StabilityOutcome;
using testing::StabilityResult;
using testing::StabilityRun;

const StabilityGrid kGrid{{0.001, 0.03, 1.0, 100.0},
                          {0.00025, 0.001, 0.004, 1.0 / 60.0},
                          {50.0, 2000.0, 1e5},
                          {1, 2, 5, 10, 20},
                          {0.0, 0.5, 1.0}};

/// A grip that friction alone would hold: 0.1 kg between ten fingertips of 2000 N/m. Explicit springs are
/// stable at steps below 2 / sqrt(N gamma / m) = 4.47 ms.
constexpr double kExplicitBound = 0.00447;  // [s]

StabilityOutcome ten_fingertips(ContactModelKind model, double step) {
  return StabilityRun({model, 0.1, step, 2000.0, 10, 0.0}).play().outcome;
}

TEST(ImplicitStability, no_mass_step_stiffness_number_of_contacts_or_restitution_diverges_ejects_or_lets_go) {
  double fastest = 0.0;
  int cells = 0;
  std::ostringstream where;
  kGrid.for_every_cell(ContactModelKind::implicit, [&](const StabilityCell& cell) {
    const StabilityResult result = StabilityRun(cell).play();
    EXPECT_EQ(result.outcome, StabilityOutcome::stable)
        << cell << ": " << result.largest_speed << " m/s, slid " << 1e3 * result.slid << " mm";
    ++cells;
    if (result.largest_speed <= fastest) return;
    fastest = result.largest_speed;
    where.str("");
    where << cell;
  });
  EXPECT_EQ(cells, 720);
  RecordProperty("cells", cells);
  RecordProperty("fastest_mm_per_s", std::to_string(1e3 * fastest));
  RecordProperty("fastest_cell", where.str());
}

// What it cannot hold with its strength it may let go.
TEST(ImplicitStability, a_persons_hand_makes_nothing_diverge_or_fly_off) {
  int let_go = 0;
  kGrid.for_every_cell(ContactModelKind::implicit, [&](StabilityCell cell) {
    cell.hand = HandStrength::of_a_person();
    const StabilityResult result = StabilityRun(cell).play();
    EXPECT_TRUE(result.outcome == StabilityOutcome::stable || result.outcome == StabilityOutcome::let_go)
        << cell << ": " << result.largest_speed << " m/s";
    let_go += result.outcome == StabilityOutcome::let_go;
  });
  EXPECT_LE(let_go, 30);  // measured 24 of 720
  RecordProperty("let_go", let_go);
}

TEST(ImplicitStability, judgement_finds_seed_stable_below_the_explicit_bound_and_ejecting_beyond_it) {
  EXPECT_EQ(ten_fingertips(ContactModelKind::seed, 0.25 * kExplicitBound), StabilityOutcome::stable);
  EXPECT_EQ(ten_fingertips(ContactModelKind::seed, 2.0 * kExplicitBound), StabilityOutcome::ejected);
  EXPECT_EQ(ten_fingertips(ContactModelKind::implicit, 2.0 * kExplicitBound), StabilityOutcome::stable);
}

TEST(ImplicitStability, judgement_finds_seed_diverging_far_beyond_the_explicit_bound) {
  // 20 fingertips of 1e5 N/m on 1 g: the bound is 0.045 ms.
  StabilityCell cell{ContactModelKind::seed, 0.001, 0.001, 1e5, 20, 1.0};
  EXPECT_EQ(StabilityRun(cell).play().outcome, StabilityOutcome::diverged);
  cell.model = ContactModelKind::implicit;
  EXPECT_EQ(StabilityRun(cell).play().outcome, StabilityOutcome::stable);
}

TEST(ImplicitStability, judgement_finds_that_impulses_alone_let_go) {
  EXPECT_EQ(ten_fingertips(ContactModelKind::impulse, 0.001), StabilityOutcome::let_go);
}

}  // namespace
}  // namespace mrhi
