#pragma once

#include <vector>

#include "mr_hand_interaction/response/contact_model.h"

namespace mrhi {

/// A contact of an island: with a hand, or between two bodies.
struct ContactIndex {
  int root;  // the island's first body
  bool between_bodies;
  int index;  // in ContactStep::contacts or body_contacts
};

/// Groups of free bodies that touch each other, with the contacts that act on them. Bodies that touch
/// nothing, and fixtures, belong to none.
class Islands {
 public:
  struct Island {
    const ContactIndex* first;
    const ContactIndex* last;
    const ContactIndex* begin() const { return first; }
    const ContactIndex* end() const { return last; }
  };

  void build(const ContactStep& step);
  /// The island that begins at entry `first`; `first` moves on to the next one. Ordered by their first body.
  Island next(std::size_t& first) const;
  std::size_t size() const { return entries_.size(); }

 private:
  int root_of(int body);
  void unite(int a, int b);

  std::vector<int> parent_;
  std::vector<ContactIndex> entries_;
};

}  // namespace mrhi
