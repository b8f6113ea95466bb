#include "islands.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace mrhi {

namespace {

template <typename Predicate>
bool any_contact(const ContactStep& step, const Island& island, Predicate predicate) {
  return std::any_of(island.bodies.begin(), island.bodies.end(), [&](const IslandBody& body) {
    return std::any_of(step.contacts.begin() + body.first, step.contacts.begin() + body.last, predicate);
  });
}

}  // namespace

bool is_touched(const ContactStep& step, const Island& island) {
  const auto is_gripped = [&](const IslandBody& body) {
    return std::any_of(step.grips.begin(), step.grips.end(),
                       [&](const Grip& grip) { return grip.active && grip.body == body.body; });
  };
  return island.links.size() > 0 ||
         any_contact(step, island, [](const Contact& contact) { return !contact.ignored; }) ||
         std::any_of(island.bodies.begin(), island.bodies.end(), is_gripped);
}

bool has_persistent_hand_contact(const ContactStep& step, const Island& island) {
  return any_contact(step, island,
                     [](const Contact& contact) { return contact.touching() && contact.struck; });
}

// Disjoint sets as trees of parents, with path halving (Tarjan & van Leeuwen 1984). The smaller index becomes
// the root. So islands come in the order of their first bodies, whatever the order of the contacts.
int Islands::root_of(int body) {
  auto b = static_cast<std::size_t>(body);
  while (parent_[b] != static_cast<int>(b)) {
    parent_[b] = parent_[parent_[b]];
    b = static_cast<std::size_t>(parent_[b]);
  }
  return static_cast<int>(b);
}

void Islands::unite(int a, int b) {
  a = root_of(a), b = root_of(b);
  parent_[std::max(a, b)] = std::min(a, b);
}

// Contacts are sorted by body, so those of a body are adjacent.
void Islands::build(const ContactStep& step, const std::vector<std::vector<int>>& groups) {
  bodies_.clear();
  links_.clear();
  for (std::size_t first = 0, last = 0; first < step.contacts.size(); first = last) {
    const std::size_t body = step.contacts[first].key.body;
    while (last < step.contacts.size() && step.contacts[last].key.body == body) ++last;
    if (!step.scene.bodies[body].fixed) bodies_.push_back({static_cast<int>(body), body, first, last});
  }
  add_gripped(step);
  if (!step.body_contacts.empty() || !groups.empty()) link_bodies(step, groups);
  divide(step.scene, !groups.empty());
}

/// Adds bodies that a hand grips without touching them in this step.
void Islands::add_gripped(const ContactStep& step) {
  for (const Grip& grip : step.grips) {
    if (!grip.active) continue;
    const auto after = std::lower_bound(bodies_.begin(), bodies_.end(), grip.body,
                                        [](const IslandBody& x, std::size_t y) { return x.body < y; });
    if (after == bodies_.end() || after->body != grip.body)
      bodies_.insert(after, {grip.body, grip.body, 0, 0});
  }
}

// Fixtures connect no islands: they are immovable, so objects on one table stay separate. Joints connect
// bodies as contacts do: M of a linkage is dense, so a force on one of its bodies moves all.
void Islands::link_bodies(const ContactStep& step, const std::vector<std::vector<int>>& groups) {
  parent_.resize(step.scene.bodies.size());
  std::iota(parent_.begin(), parent_.end(), 0);
  listed_.assign(step.scene.bodies.size(), false);
  const auto list = [&](std::size_t body) {
    if (!listed_[body]) bodies_.push_back({static_cast<int>(body), body, 0, 0});
    listed_[body] = true;
  };
  for (std::size_t i = 0; i < step.body_contacts.size(); ++i) {
    const BodyContact& contact = step.body_contacts[i];
    links_.push_back({contact.key.b, i});
    list(contact.key.b);
    if (step.scene.bodies[contact.key.a].fixed) continue;
    list(contact.key.a);
    unite(contact.key.a, contact.key.b);
  }
  for (const std::vector<int>& group : groups) {
    for (const int body : group) {
      list(body);
      unite(group.front(), body);
    }
  }
  gather();
}

// Sorts by root, then by body. The smallest index is the root, so islands and the bodies in each come in the
// scene's order. Results do not depend on the order in which contacts connect them.
void Islands::gather() {
  for (IslandBody& body : bodies_) body.root = root_of(body.root);
  for (IslandContact& link : links_) link.root = root_of(link.root);
  // Keeps the last of a body's entries, which has the hands' contacts.
  std::sort(bodies_.begin(), bodies_.end(), [](const IslandBody& x, const IslandBody& y) {
    return std::tie(x.root, x.body, y.last) < std::tie(y.root, y.body, x.last);
  });
  const auto same = [](const IslandBody& x, const IslandBody& y) { return x.body == y.body; };
  bodies_.erase(std::unique(bodies_.begin(), bodies_.end(), same), bodies_.end());
  const auto before = [](const IslandContact& x, const IslandContact& y) {
    return std::tie(x.root, x.index) < std::tie(y.root, y.index);
  };
  if (!std::is_sorted(links_.begin(), links_.end(), before)) std::sort(links_.begin(), links_.end(), before);
}

// Bodies and links are sorted by root, so an island is a range of each.
void Islands::divide(const Scene& scene, bool by_joints) {
  islands_.clear();
  with_joints_.clear();
  numbers_.resize(scene.bodies.size(), -1);
  const IslandContact *link = links_.data(), *const links_end = link + links_.size();
  const IslandBody *body = bodies_.data(), *const bodies_end = body + bodies_.size();
  while (body != bodies_end) {
    const int root = body->root;
    Island island{{body, body}, {link, link}, numbers_.data()};
    bool has_joints = false;
    for (; body != bodies_end && body->root == root; ++body) {
      numbers_[body->body] = static_cast<int>(body - island.bodies.first);
      has_joints = has_joints || (by_joints && !scene.bodies[body->body].flies);
    }
    while (link != links_end && link->root == root) ++link;
    island.bodies.last = body;
    island.links.last = link;
    (has_joints ? with_joints_ : islands_).push_back(island);
  }
}

}  // namespace mrhi
