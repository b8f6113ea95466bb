#include <gtest/gtest.h>

#include "mr_hand_interaction/interaction.h"

namespace mrhi {
namespace {

constexpr Nanoseconds kFrame = 9'000'000;

class InteractionLevels : public ::testing::Test {
 protected:
  void see(InteractionLevel level, int frames) {
    for (int i = 0; i < frames; ++i) {
      now_ += kFrame;
      update_interaction(level, {now_, EventKind::hover_begin, 0, 1}, interaction_, events_);
    }
  }
  std::vector<EventKind> kinds() const {
    std::vector<EventKind> kinds;
    for (const Event& event : events_) kinds.push_back(event.kind);
    return kinds;
  }
  Nanoseconds now_ = 0;
  Interaction interaction_;
  std::vector<Event> events_;
};

TEST_F(InteractionLevels, go_up_and_down_one_by_one_in_their_fixed_order) {
  see(InteractionLevel::hover, 3);
  see(InteractionLevel::contact, 3);
  see(InteractionLevel::grasp, 20);
  see(InteractionLevel::none, 20);
  EXPECT_EQ(kinds(),
            (std::vector<EventKind>{EventKind::hover_begin, EventKind::contact_begin, EventKind::grasp_begin,
                                    EventKind::grasp_end, EventKind::contact_end, EventKind::hover_end}));
}

TEST_F(InteractionLevels, a_touch_out_of_nowhere_makes_every_event_on_the_way) {
  see(InteractionLevel::grasp, 20);
  EXPECT_EQ(kinds(), (std::vector<EventKind>{EventKind::hover_begin, EventKind::contact_begin,
                                             EventKind::grasp_begin}));
}

TEST_F(InteractionLevels, one_noisy_frame_makes_no_event) {
  see(InteractionLevel::contact, 5);
  events_.clear();
  see(InteractionLevel::grasp, 1);
  see(InteractionLevel::contact, 1);
  see(InteractionLevel::hover, 1);
  see(InteractionLevel::contact, 5);
  EXPECT_TRUE(events_.empty());
  see(InteractionLevel::grasp, 20);
  events_.clear();
  see(InteractionLevel::contact, 2);
  see(InteractionLevel::grasp, 2);
  EXPECT_TRUE(events_.empty());
}

TEST_F(InteractionLevels, a_grasp_begins_only_once_it_has_lasted) {
  see(InteractionLevel::contact, 2);
  see(InteractionLevel::grasp, 4);  // 36 ms
  EXPECT_EQ(interaction_.level, InteractionLevel::contact);
  see(InteractionLevel::grasp, 4);
  EXPECT_EQ(interaction_.level, InteractionLevel::grasp);
}

TEST_F(InteractionLevels, end_at_once_when_the_hand_is_lost) {
  see(InteractionLevel::grasp, 20);
  events_.clear();
  end_interaction({now_, EventKind::hover_end, 0, 1}, interaction_, events_);
  EXPECT_EQ(kinds(),
            (std::vector<EventKind>{EventKind::grasp_end, EventKind::contact_end, EventKind::hover_end}));
  EXPECT_EQ(interaction_.level, InteractionLevel::none);
}

}  // namespace
}  // namespace mrhi
