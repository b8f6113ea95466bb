#pragma once

#include <vector>

#include "contact_step.h"

namespace mrhi {

/// A free body of an island, and the hands' contacts with it.
struct IslandBody {
  int root;                 // first body of the island
  std::size_t body;         // in Scene::bodies
  std::size_t first, last;  // in ContactStep::contacts
};

/// A contact of an island's body with another of its bodies or with a fixture.
struct IslandContact {
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

/// A group of free bodies connected by contacts or joints, with the contacts that act on them.
struct Island {
  Span<IslandBody> bodies;    // sorted by index
  Span<IslandContact> links;  // likewise
  const int* numbers;         // by index in Scene::bodies; arbitrary for bodies of other islands

  /// Returns the number of a body of Scene::bodies in the island; -1 if it belongs to another one.
  int number_of(std::size_t body) const {
    const auto number = static_cast<std::size_t>(numbers[body]);
    return number < bodies.size() && bodies.first[number].body == body ? numbers[body] : -1;
  }
  bool contains(std::size_t body) const { return number_of(body) >= 0; }
};

/// True if any contact or grip acts on the island.
bool is_touched(const ContactStep& step, const Island& island);
/// True if a hand touches the island after its approach has ended: a finger about to collide does not hold.
bool has_persistent_hand_contact(const ContactStep& step, const Island& island);

/// Finds islands. Fixtures and bodies without contacts belong to none.
class Islands {
 public:
  /// `groups`: bodies connected by joints, which share an island, touched or not. Islands that contain any of
  /// them are in with_joints(), not in all().
  void build(const ContactStep& step, const std::vector<std::vector<int>>& groups = {});
  /// Sorted by their first body.
  const std::vector<Island>& all() const { return islands_; }
  const std::vector<Island>& with_joints() const { return with_joints_; }

 private:
  void add_gripped(const ContactStep& step);
  void link_bodies(const ContactStep& step, const std::vector<std::vector<int>>& groups);
  void gather();
  void divide(const Scene& scene, bool by_joints);
  int root_of(int body);
  void unite(int a, int b);

  std::vector<IslandBody> bodies_;
  std::vector<IslandContact> links_;
  std::vector<Island> islands_, with_joints_;
  std::vector<int> parent_;   // by body
  std::vector<int> numbers_;  // by body: in its island
  std::vector<char> listed_;  // by body: true if it is in bodies_
};

}  // namespace mrhi
