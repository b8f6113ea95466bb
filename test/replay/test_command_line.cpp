#include "../../src/text/command_line.h"

#include "../../src/nodes/exit_status.h"

#include <gtest/gtest.h>

namespace mrhi {
namespace {

using Words = std::vector<std::string>;

/// A program with an option of every sort.
struct Program {
  bool quick = false;
  std::string output;
  double size = 0.0;
  long count = 0;
  std::string colour;
  Words settings, rest;

  CommandLine line(bool with_words = true) {
    CommandLine line;
    line.flag("--quick", quick).once("--output", "DIR", output);
    line.once("--size", "M", [this](const OptionValue& given) { size = given.number(-1.0, 2.5); });
    line.once("--count", "N", [this](const OptionValue& given) { count = given.whole(1, 10); });
    line.once("--colour", "NAME", [this](const OptionValue& given) {
      colour = given.one_of({"red", "blue"});
    });
    line.each("--set", "KEY=VALUE", [this](const OptionValue& given) {
      settings.push_back(given.setting().first + " is " + given.setting().second);
    });
    if (with_words) line.words([this](const OptionValue& given) { rest.push_back(given.text); });
    return line;
  }

  static std::string refusal(const Words& words, bool with_words = true) {
    try {
      Program program;
      program.line(with_words).read(words);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  }
};

TEST(CommandLine, gives_each_option_what_follows_it) {
  Program program;
  EXPECT_TRUE(program.line().read({"a", "--size", "-0.5", "--quick", "--set", "x=1", "--output", "-d",
                                   "--set", "y==", "--count", "10", "b", "--colour", "blue"}));
  EXPECT_TRUE(program.quick);
  EXPECT_EQ(program.size, -0.5);
  EXPECT_EQ(program.count, 10);
  EXPECT_EQ(program.output, "-d");
  EXPECT_EQ(program.colour, "blue");
  EXPECT_EQ(program.settings, (Words{"x is 1", "y is ="}));
  EXPECT_EQ(program.rest, (Words{"a", "b"}));
}

TEST(CommandLine, help_ends_the_reading) {
  for (const char* help : {"--help", "-h"}) {
    Program program;
    EXPECT_FALSE(program.line().read({"--quick", help, "--no-such"}));
    EXPECT_TRUE(program.quick);
  }
}

TEST(CommandLine, what_is_not_known_is_told_with_what_is) {
  const std::string allowed = "; allowed: --help, --quick, --output, --size, --count, --colour, --set";
  EXPECT_EQ(Program::refusal({"--fast"}), "unknown argument '--fast'" + allowed);
  EXPECT_EQ(Program::refusal({"stray"}, false), "unknown argument 'stray'" + allowed);
  EXPECT_EQ(Program::refusal({"stray"}), "");
}

TEST(CommandLine, an_option_needs_its_value_and_most_are_given_once) {
  for (const Words& words : {Words{"--output"}, {"--output", ""}, {"--output", "--quick"}})
    EXPECT_EQ(Program::refusal(words), "--output needs a value: --output DIR");
  EXPECT_EQ(Program::refusal({"--output", "a", "--output", "b"}), "--output is given twice; allowed: once");
  EXPECT_EQ(Program::refusal({"--set", "a=1", "--set", "a=2", "--quick", "--quick"}), "");
}

TEST(CommandLine, a_value_is_told_with_what_is_allowed) {
  for (const char* size : {"-1.01", "2.51", "nan", "inf", "1,5", "1 m", "large"})
    EXPECT_EQ(Program::refusal({"--size", size}),
              std::string("--size '") + size + "' is not allowed; allowed: a number from -1 to 2.5");
  for (const char* size : {"-1", "2.5", "1e-3"}) EXPECT_EQ(Program::refusal({"--size", size}), "");
  for (const char* count : {"0", "11", "1.5", "1e99", "nan"})
    EXPECT_EQ(Program::refusal({"--count", count}),
              std::string("--count '") + count + "' is not allowed; allowed: a whole number from 1 to 10");
  EXPECT_EQ(Program::refusal({"--colour", "green"}), "--colour 'green' is not allowed; allowed: red, blue");
  for (const char* setting : {"a", "=a"})
    EXPECT_EQ(Program::refusal({"--set", setting}),
              std::string("--set '") + setting + "' is not allowed; allowed: KEY=VALUE");
}

TEST(CommandLine, a_program_ends_with_2_for_bad_usage_and_1_for_bad_data) {
  const auto ended = [](const std::function<int()>& work) {
    ::testing::internal::CaptureStderr();
    const int status = exit_status("tool", work);
    return std::to_string(status) + " " + ::testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(ended([]() -> int { throw UsageError("so not"); }), "2 tool: so not\n");
  EXPECT_EQ(ended([]() -> int { throw std::runtime_error("broken"); }), "1 tool: broken\n");
  EXPECT_EQ(ended([]() -> int { throw std::runtime_error("a.csv: \x1b[31m\n"); }), "1 tool: a.csv: ?[31m\n");
  EXPECT_EQ(ended([] { return 0; }), "0 ");
  EXPECT_EQ(ended([] { return 1; }), "1 ");
}

}  // namespace
}  // namespace mrhi
