#include "islands.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <numeric>
#include <tuple>

namespace mrhi {

namespace {

template <typename Predicate>
bool any_contact(const ContactStep& step, const Island& island, Predicate predicate) {
  return std::any_of(island.bodies.begin(), island.bodies.end(), [&](const IslandBody& body) {
    return std::any_of(step.contacts.begin() + static_cast<std::ptrdiff_t>(body.first),
                       step.contacts.begin() + static_cast<std::ptrdiff_t>(body.last), predicate);
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

bool is_held(const ContactStep& step, const Island& island) {
  return any_contact(step, island,
                     [](const Contact& contact) { return contact.touching() && contact.struck; });
}

// Disjoint sets, each a tree of parents, halved on the way (Tarjan & van Leeuwen 1984). The smaller index
// becomes the root: so islands come in the order of their first bodies, whatever the order of the contacts.
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

// Contacts come sorted by their bodies, so those of a body are one run of them.
void Islands::build(const ContactStep& step) {
  bodies_.clear();
  links_.clear();
  for (std::size_t first = 0, last = 0; first < step.contacts.size(); first = last) {
    const std::size_t body = step.contacts[first].key.body;
    while (last < step.contacts.size() && step.contacts[last].key.body == body) ++last;
    if (!step.scene.bodies[body].fixed) bodies_.push_back({static_cast<int>(body), body, first, last});
  }
  add_gripped(step);
  if (!step.body_contacts.empty()) link_bodies(step);
  divide(step.scene.bodies.size());
}

/// What a hand holds without touching it just now.
void Islands::add_gripped(const ContactStep& step) {
  for (const Grip& grip : step.grips) {
    if (!grip.active) continue;
    const auto after = std::lower_bound(bodies_.begin(), bodies_.end(), grip.body,
                                        [](const IslandBody& x, std::size_t y) { return x.body < y; });
    if (after == bodies_.end() || after->body != grip.body)
      bodies_.insert(after, {grip.body, grip.body, 0, 0});
  }
}

// Fixtures unite nothing: they do not move, and what stands on the same table is not one island.
void Islands::link_bodies(const ContactStep& step) {
  parent_.resize(step.scene.bodies.size());
  std::iota(parent_.begin(), parent_.end(), 0);
  listed_.assign(step.scene.bodies.size(), false);
  const auto list = [&](std::uint16_t body) {
    if (!listed_[body]) bodies_.push_back({body, body, 0, 0});
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
  gather();
}

// By root, then by body: the smallest index is the root, so both islands and the bodies within one come in
// the scene's order, and results do not hang on the order in which contacts unite them.
void Islands::gather() {
  for (IslandBody& body : bodies_) body.root = root_of(body.root);
  for (Link& link : links_) link.root = root_of(link.root);
  // Of each body the entry with what hands do to it is kept, which is the last.
  std::sort(bodies_.begin(), bodies_.end(), [](const IslandBody& x, const IslandBody& y) {
    return std::tie(x.root, x.body, y.last) < std::tie(y.root, y.body, x.last);
  });
  const auto same = [](const IslandBody& x, const IslandBody& y) { return x.body == y.body; };
  bodies_.erase(std::unique(bodies_.begin(), bodies_.end(), same), bodies_.end());
  const auto before = [](const Link& x, const Link& y) {
    return std::tie(x.root, x.index) < std::tie(y.root, y.index);
  };
  if (!std::is_sorted(links_.begin(), links_.end(), before)) std::sort(links_.begin(), links_.end(), before);
}

// Joints unite as contacts do: M of a linkage is dense, so that what pushes one of its bodies moves all.
void Islands::join(const ContactStep& step, const std::vector<std::vector<int>>& groups) {
  parent_.resize(step.scene.bodies.size());
  std::iota(parent_.begin(), parent_.end(), 0);
  for (const Link& link : links_) {
    const BodyContactKey& key = step.body_contacts[link.index].key;
    if (!step.scene.bodies[key.a].fixed) unite(key.a, key.b);
  }
  for (const std::vector<int>& group : groups) {
    for (const int body : group) {
      bodies_.push_back({body, static_cast<std::size_t>(body), 0, 0});
      unite(group.front(), body);
    }
  }
  gather();
  divide(step.scene.bodies.size());
  apart_.clear();
  const auto flies = [&](const Island& island) {
    return std::all_of(island.bodies.begin(), island.bodies.end(),
                       [&](const IslandBody& body) { return step.scene.bodies[body.body].flies; });
  };
  std::copy_if(islands_.begin(), islands_.end(), std::back_inserter(apart_), std::not_fn(flies));
  islands_.erase(std::remove_if(islands_.begin(), islands_.end(), std::not_fn(flies)), islands_.end());
}

// Bodies and links are sorted by root, so an island is a run of each.
void Islands::divide(std::size_t bodies) {
  islands_.clear();
  places_.resize(bodies, -1);
  const Link *link = links_.data(), *const links_end = link + links_.size();
  const IslandBody *body = bodies_.data(), *const bodies_end = body + bodies_.size();
  while (body != bodies_end) {
    const int root = body->root;
    Island island{{body, body}, {link, link}, places_.data()};
    for (; body != bodies_end && body->root == root; ++body)
      places_[body->body] = static_cast<int>(body - island.bodies.first);
    while (link != links_end && link->root == root) ++link;
    island.bodies.last = body;
    island.links.last = link;
    islands_.push_back(island);
  }
}

}  // namespace mrhi
