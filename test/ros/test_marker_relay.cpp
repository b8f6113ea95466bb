#include <gtest/gtest.h>

#include "ros/marker_relay.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

Marker marker(const std::string& ns, int id, int action = Marker::ADD) {
  Marker made;
  made.ns = ns;
  made.id = id;
  made.action = action;
  return made;
}

MarkerArray::ConstPtr array(const std::vector<Marker>& markers) {
  MarkerArray::Ptr made(new MarkerArray);
  made->markers = markers;
  return made;
}

/// What an array does: "=" deletes all, "-" deletes, "+" adds.
std::string told(const MarkerArray& markers) {
  std::string text;
  for (const Marker& one : markers.markers) {
    if (one.action == Marker::DELETEALL) {
      text += "= ";
    } else {
      text += (one.action == Marker::DELETE ? "-" : "+") + one.ns + std::to_string(one.id) + " ";
    }
  }
  return text;
}

TEST(MarkerThinner, begins_with_a_clean_sheet_and_then_passes_the_newest) {
  MarkerThinner thinner({});
  EXPECT_EQ(told(thinner.next()), "");
  thinner.take(array({marker("hand", 1)}));
  EXPECT_EQ(told(thinner.next()), "= +hand1 ");
  thinner.take(array({marker("hand", 1)}));
  thinner.take(array({marker("hand", 2)}));
  EXPECT_EQ(told(thinner.next()), "+hand1 +hand2 ") << "an array has what changed";
  EXPECT_EQ(told(thinner.next()), "") << "nothing new";
}

TEST(MarkerThinner, no_deletion_is_lost_with_the_arrays_that_are_left_out) {
  MarkerThinner thinner({});
  thinner.take(array({marker("objects", 1), marker("objects", 2)}));
  thinner.next();
  thinner.take(array({marker("objects", 1, Marker::DELETE), marker("objects", 2)}));
  thinner.take(array({marker("objects", 2)}));
  EXPECT_EQ(told(thinner.next()), "-objects1 +objects2 ");
  thinner.take(array({marker("objects", 2, Marker::DELETEALL), marker("objects", 3)}));
  thinner.take(array({marker("objects", 3)}));
  EXPECT_EQ(told(thinner.next()), "= +objects3 ");
}

TEST(MarkerThinner, what_came_back_after_its_deletion_is_shown) {
  MarkerThinner thinner({});
  thinner.take(array({marker("hand", 1)}));
  thinner.next();
  thinner.take(array({marker("hand", 1, Marker::DELETE)}));
  thinner.take(array({marker("hand", 1)}));
  EXPECT_EQ(told(thinner.next()), "+hand1 ");
}

TEST(MarkerThinner, namespaces_that_are_left_out_are_not_passed_on) {
  MarkerThinner thinner({"hand", "ghost"});
  thinner.take(array({marker("hand", 1), marker("objects", 1)}));
  EXPECT_EQ(told(thinner.next()), "= +objects1 ");
  thinner.take(array({marker("hand", 1, Marker::DELETE), marker("objects", 1)}));
  EXPECT_EQ(told(thinner.next()), "+objects1 ");
}

TEST(MarkerThinner, starting_afresh_tells_all_that_is_shown_and_nothing_else) {
  MarkerThinner thinner({});
  thinner.take(array({marker("objects", 1), marker("objects", 2), marker("hand", 1)}));
  thinner.take(array({marker("hand", 1, Marker::DELETE)}));
  thinner.next();
  thinner.start_afresh();
  EXPECT_EQ(told(thinner.next()), "") << "nothing new to tell it with";
  thinner.take(array({marker("objects", 2)}));
  EXPECT_EQ(told(thinner.next()), "= +objects1 +objects2 ");
}

}  // namespace
}  // namespace mrhi
