// A state out of a recording: the first byte chooses a simulation that runs, of whose state the others change
// bytes: three for the place, one for how many, then those. Its sum is right. What is taken is gone on from.
#include <map>
#include <memory>

#include "fuzz/played_step.h"
#include "mr_hand_interaction/synthetic/random.h"
#include "simulation/state_bytes.h"

namespace {

using namespace mrhi;
using fuzzing::require;

struct Running {
  fuzzing::StepCase of;
  std::string state;
};

Running run(std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint8_t> bytes(400);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.bits());
  Running made{fuzzing::step_case(bytes.data(), bytes.size()), ""};
  Simulation simulation(made.of.scene, made.of.configuration);
  for (const JointsFrame& joints : made.of.frames) {
    std::vector<std::string> defects;
    if (const auto frame = complete_frame(joints, Pose(), defects)) simulation.advance(*frame);
  }
  made.state = to_bytes(simulation.state());
  return made;
}

const Running& running(std::uint8_t seed) {
  static std::map<std::uint8_t, std::unique_ptr<const Running>> all;
  auto& found = all[seed];
  if (!found) found = std::make_unique<const Running>(run(seed));
  return *found;
}

/// FNV-1a, as at their end.
void put_sum(std::string& bytes) {
  const std::size_t size = bytes.size() - sizeof(std::uint64_t);
  std::uint64_t sum = 14695981039346656037ull;
  for (std::size_t i = 0; i < size; ++i)
    sum = (sum ^ static_cast<unsigned char>(bytes[i])) * 1099511628211ull;
  std::memcpy(&bytes[size], &sum, sizeof sum);
}

std::string changed(std::string state, fuzzing::Bytes& bytes) {
  while (bytes.left()) {
    std::size_t place = bytes.byte();
    place = (place << 8) + bytes.byte();
    place = (place << 8) + bytes.byte();
    const int count = 1 + bytes.below(8);
    for (int i = 0; i < count; ++i)
      state[(8 + place + static_cast<std::size_t>(i)) % state.size()] = static_cast<char>(bytes.byte());
  }
  put_sum(state);
  return state;
}

void go_on_from(const SimulationState& state, const fuzzing::StepCase& of) {
  // A silence of up to a minute is gone through step by step, which is right and takes its time.
  constexpr double kLongestSilence = 1.0;  // [s]
  const Nanoseconds last = std::max(state.time, state.stamps.last);
  if (to_seconds(last) - to_seconds(state.time) > kLongestSilence) return;
  Simulation simulation(of.scene, of.configuration);
  simulation.set_state(state);
  for (int i = 1; i <= 5; ++i) {
    const Hand hand = mrhi::testing::posed_hand(relaxed_posture(), {});
    simulation.advance({last + i * 10'000'000, {hand}});
    for (const Hand& tracked : simulation.result().tracked)
      require(fuzzing::finite(tracked), "tracked hands are finite");
    for (const RenderedHand& rendered : simulation.result().rendered)
      require(fuzzing::finite(rendered.hand), "drawn hands are finite");
    for (const BodyState& body : simulation.state().bodies)
      require(body.pose.position.allFinite() && body.linear_momentum.allFinite(), "bodies are finite");
  }
  hash(simulation.state());
}

}  // namespace

FUZZ_TARGET(state) {
  if (size < 1) return;
  const Running& base = running(data[0]);
  fuzzing::Bytes bytes(data + 1, size - 1);
  try {
    go_on_from(state_from_bytes(changed(base.state, bytes), base.of.scene), base.of);
  } catch (const std::invalid_argument& error) {
    fuzzing::require_one_line(error.what());
  }
}
