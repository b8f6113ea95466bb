#include "operators_at_work.h"
#include "synthetic/person.h"

namespace mrhi {
namespace {

constexpr double kPeriod = 1.0 / 115.0;

struct Done {
  double seconds;
  Vector3 end;  // where the wrist is then
};

/// One goal, done once, before a hatch that stays as it is.
Done done(Skilled skill) {
  PractisedPerson person(OperatorSkill(), {PractisedGoal{skill}, std::nullopt}, testing::shipped_body("cube"),
                         1);
  Sight sight;
  Vector3 before = person.move(0.0, sight).wrist.position;
  Done result{0.0, before};
  double still = 0.0;
  for (double time = kPeriod; still < 4.0; time += kPeriod) {
    const Vector3 wrist = person.move(time, sight).wrist.position;
    const bool moves = (wrist - before).norm() > 1e-9;
    if (moves) sight.goal = 1, result.seconds = time, still = 0.0;
    if (!moves) still += kPeriod;
    result.end = before = wrist;
    EXPECT_LT(time, 60.0);
    if (time >= 60.0) break;
  }
  return result;
}

TEST(PractisedPerson, takes_the_handle_at_once_where_the_latches_are_undone) {
  const Done all = done(Skilled::open_hatch), pull = done(Skilled::pull_hatch);
  EXPECT_LT(pull.seconds, 0.6 * all.seconds);
  EXPECT_LT((pull.end - all.end).norm(), 1e-9);  // the same motion's end
}

}  // namespace
}  // namespace mrhi
