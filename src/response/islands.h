#pragma once

#include <vector>

#include "contact_step.h"

namespace mrhi {

/// A free body that something touches, and the hands' contacts with it.
struct IslandBody {
  int root;                 // the island's first body
  std::size_t body;         // in Scene::bodies
  std::size_t first, last;  // in ContactStep::contacts
};

/// A contact of an island's body with another one of it, or with a fixture.
struct Link {
  int root;
  std::size_t index;  // in ContactStep::body_contacts
};

template <typename T>
struct Span {
  const T* first;
  const T* last;
  const T* begin() const { return first; }
  const T* end() const { return last; }
  std::size_t size() const { return static_cast<std::size_t>(last - first); }
};

/// A group of free bodies that touch each other, with the contacts that act on them.
struct Island {
  Span<IslandBody> bodies;  // by their index
  Span<Link> links;         // likewise
  const int* places;        // by index in Scene::bodies; of bodies of other islands, any number

  /// Returns the number of a body of Scene::bodies in the island; -1 if it belongs to another one.
  int place_of(std::size_t body) const {
    const auto place = static_cast<std::size_t>(places[body]);
    return place < bodies.size() && bodies.first[place].body == body ? places[body] : -1;
  }
};

/// True if anything touches or grips the island.
bool is_touched(const ContactStep& step, const Island& island);
/// True if a hand touches the island and is past its approach: a finger that is about to hit holds nothing.
bool is_held(const ContactStep& step, const Island& island);

/// Bodies that touch nothing, and fixtures, belong to none.
class Islands {
 public:
  void build(const ContactStep& step);
  /// By their first body.
  const std::vector<Island>& all() const { return islands_; }
  /// Bodies of a group, which hang together, belong to one island, touched or not. Islands with any of them
  /// are then in apart(), and no more in all().
  void join(const ContactStep& step, const std::vector<std::vector<int>>& groups);
  const std::vector<Island>& apart() const { return apart_; }

 private:
  void add_gripped(const ContactStep& step);
  void link_bodies(const ContactStep& step);
  void gather();
  void divide(std::size_t bodies);
  int root_of(int body);
  void unite(int a, int b);

  std::vector<IslandBody> bodies_;
  std::vector<Link> links_;
  std::vector<Island> islands_, apart_;
  std::vector<int> parent_;   // by body
  std::vector<int> places_;   // by body
  std::vector<char> listed_;  // by body: whether it is among them already
};

}  // namespace mrhi
