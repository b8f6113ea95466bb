#include <cmath>

#include "hand_filter.h"

namespace mrhi {
namespace {

/// Weight of the newest sample in a low-pass of first order that halves the power at `cutoff` [Hz].
///
///     alpha = 1 / (1 + tau / T),   tau = 1 / (2 pi cutoff)   (Casiez, Roussel & Vogel 2012)
/// is the step of an implicit Euler method for tau y' = x - y: stable at any interval T, and the cutoff is as
/// named as long as it is well below 1 / T.
double weight(double cutoff, double elapsed) {
  const double turn = 2.0 * M_PI * cutoff * elapsed;
  return turn / (1.0 + turn);
}

/// Velocities of raw samples, low-passed: v <- v + alpha ((x - x_before) / T - v).
void follow_velocity(const Hand& from, const Hand& to, double elapsed, double gain, HandVelocity& velocity) {
  for (std::size_t point = 0; point < kHandPoints; ++point) {
    Vector3& v = velocity.points[point];
    if (has_point(from, point) && has_point(to, point)) {
      v += gain * ((hand_point(to, point) - hand_point(from, point)) / elapsed - v);
    } else {
      v.setZero();
    }
  }
}

///     cutoff = min_cutoff + beta |v|,   y <- y + alpha (x - y)
/// with |v| the rms of the hand's joints, not each one's own: joints of one finger would lag by different
/// times and bones change their lengths.
Hand one_euro(double elapsed, const FilterConfiguration& filter, FilterMemory& memory) {
  const Hand& sample = memory.history.samples[0];
  follow_velocity(memory.history.samples[1], sample, elapsed, weight(filter.derivative_cutoff, elapsed),
                  memory.velocity);
  const double cutoff = filter.min_cutoff + filter.beta * rms_speed(memory.velocity, sample);
  return blend(memory.filtered, sample, weight(cutoff, elapsed));
}

}  // namespace

/// A low-pass whose cutoff grows with the hand's speed (Casiez, Roussel & Vogel 2012), one cutoff for the
/// whole hand.
extern const HandFilter one_euro_filter{
    "one_euro", 2,
    []() -> std::vector<FilterSetting> {
      using F = FilterConfiguration;
      return {{"min_cutoff", " [Hz]", {0.01, 1000}, {0.1, 10}, &F::min_cutoff},
              {"beta", " [Hz per m/s]", {0, 10000}, {0, 500}, &F::beta},
              {"derivative_cutoff", " [Hz]", {0.01, 1000}, {0.1, 100}, &F::derivative_cutoff}};
    },
    [](const FilterConfiguration&) { return 2; }, one_euro};

}  // namespace mrhi
