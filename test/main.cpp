#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

namespace {

// [s], far beyond what any suite takes: one that hangs leaves the others theirs. Sanitizers take longer.
unsigned limit() {
  const char* set = std::getenv("MRHI_TEST_LIMIT");
  return set ? static_cast<unsigned>(std::atoi(set)) : 1200;
}

}  // namespace

int main(int argc, char** argv) {
  alarm(limit());
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
