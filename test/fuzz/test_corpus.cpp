// Every input of the corpora, and a fixed number of others made from each: what scripts/fuzz does for longer,
// with a coverage of its own, and under sanitizers.
#include <gtest/gtest.h>

#include "fuzz/target.h"
#include "mr_hand_interaction/synthetic/random.h"

namespace mrhi::fuzzing {
namespace {

constexpr int kMutants = 30;

using Input = std::vector<std::uint8_t>;

std::vector<std::filesystem::path> corpus(const std::string& target) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator("test/fuzz/corpus/" + target))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

Input read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// A few bytes other than they were; now and then cut off.
Input mutant(Input input, Random& random) {
  const auto below = [&](std::size_t count) {
    return static_cast<std::size_t>(random.uniform() * static_cast<double>(count));
  };
  for (std::size_t i = 0; i < 1 + below(6) && !input.empty(); ++i)
    input[below(input.size())] = static_cast<std::uint8_t>(below(256));
  if (below(4) == 0) input.resize(below(input.size() + 1));
  return input;
}

void expect_that_it_holds(const Target& target, const Input& input, const std::string& name) {
  try {
    target.run(input.data(), input.size());
  } catch (const Broken& broken) {
    ADD_FAILURE() << name << ": " << broken.what;
  } catch (const std::exception& error) {
    ADD_FAILURE() << name << ": " << error.what();
  }
}

TEST(FuzzCorpus, every_input_and_what_is_like_it_leaves_all_that_must_hold) {
  ASSERT_EQ(targets().size(), 8u);
  for (const Target& target : targets()) {
    const auto files = corpus(target.name);
    EXPECT_FALSE(files.empty()) << target.name;
    for (const auto& file : files) {
      const Input input = read(file);
      expect_that_it_holds(target, input, file.string());
      Random random(1);
      for (int i = 0; i < kMutants; ++i)
        expect_that_it_holds(target, mutant(input, random), file.string() + ", mutant " + std::to_string(i));
    }
  }
}

}  // namespace
}  // namespace mrhi::fuzzing
