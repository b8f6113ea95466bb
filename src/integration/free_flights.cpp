#include "free_flights.h"

#include "free_flight.h"

namespace mrhi {
namespace {

template <template <typename> class Of>
void put(const Of<double>& one, std::size_t lane, Of<Lanes>& four) {
  const auto* from = reinterpret_cast<const double*>(&one);
  auto* to = reinterpret_cast<Lanes*>(&four);
  for (std::size_t i = 0; i < sizeof(one) / sizeof(double); ++i) to[i].lane[lane] = from[i];
}

}  // namespace

FreeFlights::FreeFlights(const Scene& scene)
    : scene_(scene), fours_((scene.bodies.size() + kLanes - 1) / kLanes) {
  for (const Body& body : scene.bodies) flyers_.push_back({body.mass, quickness(body), body.flies});
  for (std::size_t b = 0; b < kLanes * fours_.size(); ++b) {
    const bool is_body = b < scene.bodies.size();
    Four& four = fours_[b / kLanes];
    put(spinner_of(is_body ? scene.bodies[b] : Body()), b % kLanes, four.bodies);
    put(turning_of(BodyState(), 0.0), b % kLanes, four.states);
  }
}

// Which bodies share a four is fixed by their indices, so what does not change in flight is laid out once.
void FreeFlights::fly(std::size_t body, const Vector3& gravity, double step, BodyState& state) {
  const Flyer& flyer = flyers_[body];
  if (!flyer.flies) return;
  fly_on(flyer.mass, gravity, step, state);
  const Turn turn = turn_of(flyer.quickness, state.angular_momentum, step);
  if (turn == Turn::long_one)
    turn_far(scene_.bodies[body], state.angular_momentum, step, state.pose.orientation);
  if (turn != Turn::short_one) return;
  Four& four = fours_[body / kLanes];
  put(turning_of(state, step), body % kLanes, four.states);
  four.turns[body % kLanes] = true;
  ++four.count;
}

// All four lanes are worked out if one of them turns. One that does not has an old state in it, or at first
// no momentum, which is divided by: what comes of it is no number or of no use, and is not written back. A
// lane's bits are those of turn_shortly on its body alone, so it makes no difference who turns beside it.
void FreeFlights::turn(std::vector<BodyState>& states) {
  for (std::size_t f = 0; f < fours_.size(); ++f) {
    Four& four = fours_[f];
    if (four.count == 0) continue;
    turn_four_(four.bodies, four.states);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (!four.turns[lane]) continue;
      const Turning<Lanes>& turned = four.states;
      states[kLanes * f + lane].pose.orientation =
          Quaternion(turned.w.lane[lane], turned.x.lane[lane], turned.y.lane[lane], turned.z.lane[lane]);
    }
    four.turns.fill(false);
    four.count = 0;
  }
}

}  // namespace mrhi
