#include "mr_hand_interaction/synthetic/tremor.h"

#include <cmath>

namespace mrhi {

Tremor::Tremor(double rms, Random& random) {
  constexpr int kWaves = 3;
  for (int i = 0; i < kWaves; ++i) {
    const double frequency = 8.0 + 4.0 * random.uniform(), phase = 2.0 * M_PI * random.uniform();
    waves_.push_back({frequency, phase, random.gaussian_vector(rms * std::sqrt(2.0 / kWaves))});
  }
}

Vector3 Tremor::at(double time) const {
  Vector3 sum = Vector3::Zero();
  for (const Wave& wave : waves_)
    sum += std::sin(2.0 * M_PI * wave.frequency * time + wave.phase) * wave.amplitude;
  return sum;
}

}  // namespace mrhi
