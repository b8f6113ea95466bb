#include "islands.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace mrhi {
namespace {

/// Surfaces farther apart than this, that do not close within the step, do not couple their bodies [m].
constexpr double kCoupled = 1e-4;

bool couples(const ContactStep& step, const BodyContact& contact) {
  if (contact.depth > -kCoupled || contact.first_touch >= 0.0) return true;
  const auto a = static_cast<std::size_t>(contact.key.a), b = static_cast<std::size_t>(contact.key.b);
  const Twist twist_a = twist_of(step.scene.bodies[a], step.bodies[a]);
  const Twist twist_b = twist_of(step.scene.bodies[b], step.bodies[b]);
  const Vector3 relative = twist_a.linear + twist_a.angular.cross(contact.arm_a) - twist_b.linear -
                           twist_b.angular.cross(contact.arm_b);
  const double fall = 0.5 * step.step * step.step * step.gravity.norm();
  return contact.depth - step.step * contact.normal.dot(relative) + fall > 0.0;
}

bool in_order(const ContactIndex& x, const ContactIndex& y) {
  return std::tie(x.root, x.between_bodies, x.index) < std::tie(y.root, y.between_bodies, y.index);
}

}  // namespace

int Islands::root_of(int body) {
  auto b = static_cast<std::size_t>(body);
  while (parent_[b] != static_cast<int>(b)) {
    parent_[b] = parent_[static_cast<std::size_t>(parent_[b])];
    b = static_cast<std::size_t>(parent_[b]);
  }
  return static_cast<int>(b);
}

void Islands::unite(int a, int b) {
  a = root_of(a), b = root_of(b);
  parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
}

void Islands::build(const ContactStep& step) {
  entries_.clear();
  for (int i = 0; i < static_cast<int>(step.contacts.size()); ++i) {
    const int body = step.contacts[static_cast<std::size_t>(i)].key.body;
    if (!step.scene.bodies[static_cast<std::size_t>(body)].fixed) entries_.push_back({body, false, i});
  }
  if (step.body_contacts.empty()) return;

  parent_.resize(step.scene.bodies.size());
  std::iota(parent_.begin(), parent_.end(), 0);
  for (int i = 0; i < static_cast<int>(step.body_contacts.size()); ++i) {
    const BodyContact& contact = step.body_contacts[static_cast<std::size_t>(i)];
    if (!couples(step, contact)) continue;
    if (!step.scene.bodies[contact.key.a].fixed) unite(contact.key.a, contact.key.b);
    entries_.push_back({contact.key.b, true, i});
  }
  for (ContactIndex& entry : entries_) entry.root = root_of(entry.root);
  std::sort(entries_.begin(), entries_.end(), in_order);
}

Islands::Island Islands::next(std::size_t& first) const {
  std::size_t last = first;
  while (last < entries_.size() && entries_[last].root == entries_[first].root) ++last;
  const Island island{entries_.data() + first, entries_.data() + last};
  first = last;
  return island;
}

}  // namespace mrhi
