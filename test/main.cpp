#include <gtest/gtest.h>
#include <unistd.h>

int main(int argc, char** argv) {
  constexpr unsigned kLimit =
      1200;  // [s], far beyond what any suite takes: one that hangs leaves the others theirs
  alarm(kLimit);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
