#include "state_bytes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "../math/fnv1a.h"
#include "../tracking/hand_filter.h"

namespace mrhi {
namespace {

/// Format version. Changes whenever the order or meaning of the bytes does.
constexpr std::uint64_t kFormat = 0x6d7268690000000bull;

[[noreturn]] void refuse(const char* what) {
  throw std::invalid_argument(std::string("recorded state: ") + what +
                              "; allowed: a whole one of this version");
}

void check_limit(int number, double max) {
  if (number < 0 || number > max) refuse("has a number that is too large");
}

/// Largest plausible magnitude of a number in a state.
constexpr double kMaxNumber = 1e30;

struct Out {
  static constexpr bool kHashes = false;

  std::string bytes;

  void check(double) {}
  void check(Nanoseconds) {}

  void raw(void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }
  std::size_t count(std::size_t size, std::size_t) {
    auto number = static_cast<std::uint64_t>(size);
    raw(&number, sizeof number);
    return size;
  }
};

struct In {
  static constexpr bool kHashes = false;

  const char* at;
  const char* end;

  void raw(void* data, std::size_t size) {
    if (static_cast<std::size_t>(end - at) < size) refuse("ends early");
    std::memcpy(data, at, size);
    at += size;
  }
  void check(double number) {
    if (!(std::abs(number) <= kMaxNumber)) refuse("has a number that is too large, or none");
  }
  /// Limits stamps so that the difference of any two does not overflow.
  void check(Nanoseconds stamp) {
    if (stamp < -StampCheck::kLatest || stamp > StampCheck::kLatest) refuse("has a stamp that is none");
  }
  /// Reads a count of items of `item` bytes in memory, each of which takes at least an eighth of that here.
  std::size_t count(std::size_t, std::size_t item) {
    std::uint64_t number = 0;
    raw(&number, sizeof number);
    if (number > 8 * static_cast<std::uint64_t>(end - at) / item) refuse("ends early");
    return static_cast<std::size_t>(number);
  }
};

/// Hashes the members that determine the future. Stamps are relative to `now`.
struct Hash {
  static constexpr bool kHashes = true;

  Nanoseconds now;
  Fnv1a fnv1a = {};

  void check(double) {}
  void check(Nanoseconds) {}
  void raw(const void* data, std::size_t size) { fnv1a.add(data, size); }
  static std::size_t count(std::size_t size, std::size_t) { return size; }
};

/// Visits every member of every part, in order, to write, read or hash it. A part that gains a member does
/// not compile until the member is listed here, because members are bound by name.
template <class Visitor>
class Parts {
 public:
  explicit Parts(Visitor& visitor) : visitor_(visitor) {}

  template <class... Items>
  void all(Items&... items) {
    (one(items), ...);
  }

  /// Members that the hash omits: of a single step, or derived from others.
  template <class... Items>
  void not_hashed(Items&... items) {
    if constexpr (!Visitor::kHashes) all(items...);
  }
  void stamp(Nanoseconds& stamp) {
    if constexpr (Visitor::kHashes) {
      Nanoseconds since = visitor_.now - stamp;
      one(since);
    } else {
      one(stamp);
    }
  }

  template <class Number, std::enable_if_t<std::is_arithmetic<Number>::value, int> = 0>
  void one(Number& number) {
    visitor_.raw(&number, sizeof number);
    if constexpr (std::is_floating_point<Number>::value) visitor_.check(static_cast<double>(number));
    if constexpr (std::is_same<Number, Nanoseconds>::value) visitor_.check(number);
  }
  void one(bool& truth) {
    std::uint8_t number = truth ? 1 : 0;
    one(number);
    truth = number != 0;
  }
  template <class Enum>
  void one_of(Enum& value, Enum last) {
    auto number = static_cast<std::uint8_t>(value);
    one(number);
    if (number > static_cast<std::uint8_t>(last)) refuse("has a value of no meaning");
    value = static_cast<Enum>(number);
  }
  void up_to(int& number, int max) {
    one(number);
    check_limit(number, max);
  }
  template <class Item>
  void one(std::vector<Item>& items) {
    items.resize(visitor_.count(items.size(), sizeof(Item)));
    for (Item& item : items) one(item);
  }
  template <class Item, std::size_t size>
  void one(std::array<Item, size>& items) {
    for (Item& item : items) one(item);
  }
  template <class Item>
  void one(std::optional<Item>& item) {
    bool has_value = item.has_value();
    not_hashed(has_value);
    if (!has_value) item.reset();
    if (has_value && !item) item.emplace();
    if (has_value) one(*item);
  }
  void one(Vector3& v) { all(v[0], v[1], v[2]); }
  void one(FingerOffset& a) { all(a[0], a[1], a[2], a[3]); }
  void one(Quaternion& q) { all(q.x(), q.y(), q.z(), q.w()); }
  void one(Pose& part) {
    auto& [position, orientation] = part;
    all(position, orientation);
  }
  void one(Twist& part) {
    auto& [linear, angular] = part;
    all(linear, angular);
  }
  void one(Material& part) {
    auto& [restitution, static_friction, dynamic_friction, stiffness] = part;
    all(restitution, static_friction, dynamic_friction, stiffness);
  }
  void one(StampCheck& part) {
    auto& [started, last, interval, stray, strays] = part;
    all(started, last, interval, stray, strays);
  }
  void one(BodyState& part) {
    auto& [pose, linear_momentum, angular_momentum, pushed, appeared] = part;
    all(pose, linear_momentum, angular_momentum, pushed, appeared);
  }
  void one(Capsule& part) {
    auto& [start, end, radius] = part;
    all(start, end, radius);
  }
  void one(Hand& part) {
    auto& [id, side, confidence, grab, pinch, palm, palm_width, wrist, capsules] = part;
    one(id);
    one_of(side, Side::right);
    not_hashed(confidence, grab, pinch);
    one(palm);
    not_hashed(palm_width);
    all(wrist, capsules);
  }
  void one(SampleHistory& part) {
    auto& [samples, elapsed, size] = part;
    if constexpr (!Visitor::kHashes) up_to(size, kMaxFilterWindow);
    for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) all(samples[i], elapsed[i]);
  }
  void one(HandVelocity& part) {
    auto& [points, turn] = part;
    all(points, turn);
  }
  void one(MotionVariance& part) {
    auto& [position, mixed, speed] = part;
    all(position, mixed, speed);
  }
  /// Also hashed for a free slot: the next hand of its side inherits it.
  void one(SeenNoise& part, Side side) {
    auto& [variances, size, variance] = part;
    if constexpr (Visitor::kHashes) {
      if (size == 0) return;
      one_of(side, Side::right);
    } else {
      up_to(size, kNoiseWindow);
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) one(variances[i]);
    one(variance);
  }
  void one(FilterMemory& part) {
    auto& [history, filtered, velocity, variance, noise] = part;
    all(history, filtered, velocity, variance);
    one(noise, filtered.side);
  }
  void one(Rejoin& part) {
    auto& [from, begin, duration] = part;
    one(duration);
    if (Visitor::kHashes && duration <= 0) return;
    stamp(begin);
    one(from);
  }
  void one(FilterConfiguration& part) {
    all(part.type, part.as_printed);
    for (const FilterSetting& setting : filter_settings()) {
      std::visit([&](auto value) { one(part.*value); }, setting.value);
      if (const auto* whole = std::get_if<int FilterConfiguration::*>(&setting.value))
        check_limit(part.**whole, setting.range.max);
    }
  }
  /// As its index in hand_filters().
  void one(FilterKind& kind) {
    const auto& filters = hand_filters();
    const auto at = std::find_if(filters.begin(), filters.end(),
                                 [&](const HandFilter* filter) { return filter->name == kind.name; });
    auto index = static_cast<std::uint8_t>(at - filters.begin());
    one(index);
    if (index >= filters.size()) refuse("has a value of no meaning");
    kind.name = filters[index]->name;
  }
  void one(FilterChange& part) {
    auto& [from, memory, begin] = part;
    not_hashed(from);
    stamp(begin);
    one(memory);
  }
  void one(HandPath& part) {
    auto& [start_bend, end_bend, longest_bend, velocity, differences, intervals, order, noise, energy,
           extrapolated] = part;
    not_hashed(start_bend, end_bend, longest_bend);  // of the previous frame
    up_to(order, 3);
    if (Visitor::kHashes && order == 0) return;
    all(velocity, differences, intervals, noise, energy, extrapolated);
  }
  void one(HandTrack& part) {
    auto& [active, held, appeared, emerged, converges, previous, current, last_seen, filter, rejoin, change,
           path, mean_velocity] = part;
    one(active);
    if (Visitor::kHashes && !active) return one(filter.noise, current.side);
    all(held, appeared, emerged, converges);
    stamp(last_seen);
    all(previous, current, filter, change, rejoin, path, mean_velocity);
  }
  void one(ContactKey& part) {
    auto& [point, shape, capsule, hand, body] = part;
    not_hashed(point, shape, capsule, hand, body);
    in_order(part);
  }
  void one(ContactMemory& part) {
    auto& [key, friction, struck, ignored, god_object, entry_normal, touched_from, axis_parameter, at_edge,
           depth, twist, engaged, compliance, force] = part;
    all(key, god_object, entry_normal, touched_from, axis_parameter, depth, twist, engaged);
    one_of(friction, Friction::slipping);
    all(struck, compliance, ignored);
    not_hashed(at_edge, force);
  }
  void one(Contact& c) {
    one(static_cast<ContactMemory&>(c));
    if constexpr (Visitor::kHashes) return;
    all(c.point, c.normal, c.hand_point, c.lever, c.hand_velocity, c.hand_spin, c.axis, c.radius, c.patch,
        c.grip, c.share, c.inverse_mass, c.carrier_inverse_mass, c.restitution, c.impulse, c.torque);
    // Recomputed in each step; may be infinite.
    visitor_.raw(&c.strength, sizeof c.strength);
    visitor_.raw(&c.time_of_impact, sizeof c.time_of_impact);
  }
  void one(BodyContactKey& part) {
    auto& [a, b, shape_a, shape_b, feature] = part;
    not_hashed(a, b, shape_a, shape_b, feature);
    in_order(part);
  }
  void one(BodyContactMemory& part) {
    auto& [key, friction, struck, still, depth, anchor_a, anchor_b, force] = part;
    all(key, anchor_a, anchor_b, depth);
    one_of(friction, Friction::slipping);
    all(struck, still, force);
  }
  void one(BodyContact& c) {
    one(static_cast<BodyContactMemory&>(c));
    not_hashed(c.point, c.normal, c.arm_a, c.arm_b, c.friction_offset, c.stretch, c.material, c.share,
               c.first_touch, c.impulse);
  }
  void one(PalmLag& part) {
    auto& [whole, frame] = part;
    one(whole);
    if constexpr (Visitor::kHashes) {
      Vector3 still = Vector3::Zero();  // keeps the hashes of recorded runs
      one(still);
    }
    one(frame);
  }
  void one(HandOffset& part) {
    auto& [shift, fingers, lag, stamp, left, left_since] = part;
    if (Visitor::kHashes && part.zero()) return;
    all(shift, lag, fingers);
    this->stamp(stamp);
    one(left);
    if (!Visitor::kHashes || left > 0.0) this->stamp(left_since);
  }
  void one(MassLag& part) {
    auto& [displacement, velocity, stamp] = part;
    if (Visitor::kHashes && part.zero()) return;
    all(displacement, velocity);
    this->stamp(stamp);
  }
  void one(Grip& part) {
    auto& [body, hand, by_palm, fingers, touch_aperture, mean_aperture, min_aperture, bond, stiffness, active,
           released, lost, body_in_palm, closes, opened, pads, in_palm_before, in_palm, slips, in_hand,
           in_body, force, torque, point, velocity] = part;
    all(body, hand, by_palm, fingers, touch_aperture, mean_aperture, min_aperture, bond, active, released);
    not_hashed(lost);
    if (!Visitor::kHashes || lost) one(body_in_palm);
    all(pads, in_palm, in_hand, in_body);
    not_hashed(stiffness, closes, opened, in_palm_before, slips, force, torque, point, velocity);
  }
  void one(Interaction& part) {
    auto& [level, agreed, shown_in] = part;
    one_of(level, InteractionLevel::grasp);
    one(shown_in);
    if (!Visitor::kHashes || level >= InteractionLevel::contact) stamp(agreed);
  }
  void one(JointState& part) {
    auto& [position, anchor, pushed, effort, still, detent, at_limit, latched] = part;
    all(position, anchor, pushed, still, detent, at_limit, latched);
    not_hashed(effort);
  }
  void one(SimulationState& part) {
    auto& [started, time, last_frame, stamps, bodies, joints, asleep, restrained, hands, contacts,
           body_contacts, sleeping_contacts, offsets, mass_lags, grips, interactions] = part;
    not_hashed(started, time, stamps, asleep);
    stamp(last_frame);
    all(bodies, joints, restrained);
    if constexpr (Visitor::kHashes) {
      for (std::size_t slot = 0; slot < hands.size(); ++slot) {
        one(hands[slot]);
        if (!hands[slot].active) continue;
        one(offsets[slot]);
        one(mass_lags[slot]);
      }
    } else {
      all(hands, offsets, mass_lags);
    }
    all(contacts, grips, body_contacts, sleeping_contacts, interactions);
  }

 private:
  template <class Key>
  void in_order(const Key& key) {
    if constexpr (Visitor::kHashes) {
      std::uint64_t order = key.order();
      one(order);
    }
  }

  Visitor& visitor_;
};

}  // namespace

std::uint64_t hash(const SimulationState& state) {
  SimulationState copy = state;
  Hash hash{state.time};
  Parts<Hash>(hash).one(copy);
  return hash.fnv1a.value;
}

std::string to_bytes(const SimulationState& state) {
  SimulationState copy = state;
  std::uint64_t format = kFormat;
  Out out;
  out.raw(&format, sizeof format);
  Parts<Out>(out).one(copy);
  std::uint64_t sum = Fnv1a().add(out.bytes.data(), out.bytes.size()).value;
  out.raw(&sum, sizeof sum);
  return out.bytes;
}

SimulationState state_from_bytes(const std::string& bytes, const Scene& scene) {
  std::uint64_t format = 0, sum = 0;
  if (bytes.size() < sizeof format + sizeof sum) refuse("ends early");
  const std::size_t size = bytes.size() - sizeof sum;
  std::memcpy(&format, bytes.data(), sizeof format);
  std::memcpy(&sum, bytes.data() + size, sizeof sum);
  if (format != kFormat) refuse("is of another version");
  if (sum != Fnv1a().add(bytes.data(), size).value) refuse("is damaged");
  In in{bytes.data() + sizeof format, bytes.data() + size};
  SimulationState state;
  Parts<In>(in).one(state);
  if (in.at != in.end) refuse("is too long");
  if (!fits(state, scene)) refuse("does not fit the scene");
  return state;
}

}  // namespace mrhi
