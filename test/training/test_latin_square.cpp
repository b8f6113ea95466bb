#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "mr_hand_interaction/training/session.h"

namespace mrhi {
namespace {

TEST(LatinSquare, each_thing_has_each_place_once_among_n_participants) {
  for (std::size_t n = 1; n <= 7; ++n) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      for (std::uint64_t block = 0; block < 4; ++block) {
        std::set<std::pair<std::size_t, std::size_t>> seen;
        for (std::uint64_t i = 0; i < n; ++i) {
          const auto order = latin_square_order(n, block * n + i, seed);
          for (std::size_t place = 0; place < n; ++place) seen.insert({place, order[place]});
        }
        EXPECT_EQ(n * n, seen.size()) << n << " things, seed " << seed << ", block " << block;
      }
    }
  }
}

TEST(LatinSquare, each_thing_follows_each_other_equally_often) {
  for (std::size_t n = 2; n <= 7; ++n) {
    const std::size_t participants = n % 2 == 0 ? n : 2 * n;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      std::map<std::pair<std::size_t, std::size_t>, std::size_t> follows;
      for (std::uint64_t i = 0; i < participants; ++i) {
        const auto order = latin_square_order(n, i, seed);
        for (std::size_t place = 1; place < n; ++place) ++follows[{order[place - 1], order[place]}];
      }
      EXPECT_EQ(n * (n - 1), follows.size());
      for (const auto& pair : follows)
        EXPECT_EQ(participants / n, pair.second) << n << " things, seed " << seed;
    }
  }
}

TEST(LatinSquare, seed_decides) {
  std::set<std::vector<std::size_t>> firsts;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    EXPECT_EQ(latin_square_order(3, 4, seed), latin_square_order(3, 4, seed));
    firsts.insert(latin_square_order(3, 0, seed));
  }
  EXPECT_EQ(6u, firsts.size()) << "50 seeds show all orders of three things";
}

}  // namespace
}  // namespace mrhi
