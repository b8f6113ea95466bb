// What the ledger of fuzz_step.cpp sees of the contact models, on cases at random.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "fuzz/played_step.h"
#include "mr_hand_interaction/synthetic/random.h"

namespace mrhi::fuzzing {
namespace {

/// As many as MR_HAND_CASES says.
int cases() {
  const char* set = std::getenv("MR_HAND_CASES");
  return set != nullptr ? std::atoi(set) : 120;
}

struct Tally {
  int booked = 0, borne = 0, off = 0;  // frames, those with a grip that bears, cases with energy of nowhere
  double surplus = 0.0;
};

StepCase case_at_random(std::uint64_t seed, const ContactModelKind& model) {
  Random random(seed);
  std::vector<std::uint8_t> bytes(400);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.bits());
  return step_case(bytes.data(), bytes.size(), model);
}

Tally tally(const ContactModelKind& model) {
  Tally sum;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(cases()); ++seed) {
    Played played;
    try {
      played = play(case_at_random(1000 + seed, model));
    } catch (const Broken& broken) {
      ADD_FAILURE() << model.name << ", case " << seed << ": " << broken.what;
    }
    sum.booked += played.booked;
    sum.borne += played.borne;
    sum.off += played.surplus > kRounding;
    sum.surplus = std::max(sum.surplus, played.surplus);
  }
  std::printf(
      "%s: %d frames, %d with a grip that bears, %d of %d cases with energy of nowhere, at most %.2g\n",
      std::string(model.name).c_str(), sum.booked, sum.borne, sum.off, cases(), sum.surplus);
  return sum;
}

/// play() throws if the books of energy do not balance where they must.
TEST(StepLedger, balances_under_implicit_and_impulse_and_grips_are_in_it) {
  const Tally implicit = tally(ContactModelKind::implicit), impulse = tally(ContactModelKind::impulse);
  EXPECT_GT(implicit.booked, 100);
  EXPECT_GT(implicit.borne, 0);
  EXPECT_GT(impulse.booked, 100);
  EXPECT_EQ(implicit.off + impulse.off, 0);
}

/// Two bodies inside each other, each pushed by a finger, whose problem Newton does not solve.
TEST(StepLedger, bodies_get_what_is_told_of_hands_where_the_solution_is_cut_short) {
  EXPECT_NO_THROW(play(case_at_random(1369, ContactModelKind::implicit)));
}

/// A spring whose force is that of the step's start gives back more than it took: the ledger sees it.
TEST(StepLedger, sees_that_springs_of_the_step_s_start_give_more_than_they_took) {
  int off = 0;
  for (const ContactModelKind& model : {ContactModelKind::seed, ContactModelKind::penetration,
                                        ContactModelKind::virtual_spring, ContactModelKind::soft_pad})
    off += tally(model).off;
  EXPECT_GT(off, 0);
}

}  // namespace
}  // namespace mrhi::fuzzing
