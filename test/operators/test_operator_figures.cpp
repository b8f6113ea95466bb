#include <cstdio>

#include "mr_hand_interaction/parameters.h"
#include "operator_figures.h"

namespace mrhi {
namespace {
using testing::OperatorWatch;
using testing::Watched;
constexpr double kEarth = 9.80665;

TEST(OperatorFigures, of_the_reach) {
  for (const char* group : {"beginner", "veteran"}) {
    for (const char* object : {"cube", "long_cuboid", "flat_cuboid"}) {
      for (std::uint64_t person = 5001; person <= 5008; ++person) {
        Watched watched;
        watched.object = object; watched.group = group; watched.person = person;
        const OperatorWatch watch(watched);
        const auto& r = watch.reach();
        std::printf("%s %s %d: %.2f s widest %.2f fastest %.2f closed %.2f peaks %d | grip %.2f margin %.2f lost %d\n", group, object, (int)person, r.duration, r.widest_at, r.fastest_at, r.closed_before, r.speed_peaks, watch.grip().mean(), watch.grip().safety_margin(watch.friction()), !watch.held_all_the_time());
      }
    }
  }
}
TEST(OperatorFigures, of_the_swing) {
  for (double g : {0.0, 1.0, 1.8})
    for (double mass : {0.2, 0.4})
      for (double swing : {0.2, 0.4}) for (std::uint64_t p = 5001; p <= 5002; ++p) {
        Watched w; w.gravity = g * kEarth; w.mass = mass; w.swing = swing; w.person = p;
        const OperatorWatch watch(w); const auto& f = watch.grip();
        std::printf("%.1f g %.1f kg %.1f m p%d: grip %.2f p10 %.2f p90 %.2f load %.2f max %.2f r %.3f margin %.2f lost %d\n", g, mass, swing, (int)p, f.mean(), f.quantile(.1), f.quantile(.9), f.mean_load(), *std::max_element(f.load.begin(), f.load.end()), f.correlation(), f.safety_margin(watch.friction()), !watch.held_all_the_time());
      }
}
}  // namespace
}  // namespace mrhi
