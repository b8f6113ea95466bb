#include <gtest/gtest.h>

#include "mr_hand_interaction/scene/scene_loader.h"
#include "text/yaml.h"

namespace mrhi {
namespace {

std::string nested(int levels, const char* opens, const char* closes) {
  std::string text = "1";
  for (int i = 0; i < levels; ++i) text = opens + text + closes;
  return text;
}

std::string refusal(const std::string& yaml) {
  try {
    load_yaml("here", yaml);
  } catch (const YamlError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "";
}

TEST(SafeYaml, is_taken_to_its_limits_and_no_further) {
  EXPECT_EQ(refusal(nested(32, "[", "]")), "");
  EXPECT_EQ(refusal(nested(33, "[", "]")), "here:1: is nested deeper than 32 levels; allowed: at most that");
  EXPECT_EQ(refusal(nested(32, "{a: ", "}")), "");
  EXPECT_NE(refusal(nested(33, "{a: ", "}")), "");
  const std::string comment(256 * 1024, '#');
  EXPECT_EQ(refusal(comment), "");
  EXPECT_EQ(refusal(comment + "#"), "here: is longer than 262144 bytes; allowed: at most that");
}

TEST(SafeYaml, is_one_document) {
  EXPECT_EQ(refusal("---\na: 1\n"), "");
  EXPECT_EQ(refusal("a: 1\n...\n"), "");
  EXPECT_EQ(refusal("a: 1\n---\na: 2\n"), "here: has a second document, below '---'; allowed: one");
}

TEST(SafeYaml, depth_is_counted_anew_beside_what_was_deep) {
  std::string beside;
  for (int i = 0; i < 40; ++i) beside += "- " + nested(31, "[", "]") + "\n";
  EXPECT_EQ(refusal(beside), "");
  std::string maps;
  for (int i = 0; i < 40; ++i) maps += "- " + nested(31, "{a: ", "}") + "\n";
  EXPECT_EQ(refusal(maps), "");
}

TEST(SafeYaml, of_a_callers_own_limit_may_be_longer_or_shorter) {
  EXPECT_THROW(load_yaml("here", "abcd", 3), YamlError);
  EXPECT_EQ(load_yaml("here", "abcd", 4).Scalar(), "abcd");
  EXPECT_NO_THROW(load_yaml("here", std::string(300'000, '#'), 300'000));
}

TEST(SafeYaml, names_the_line_of_what_is_no_yaml_or_an_alias) {
  EXPECT_EQ(refusal("a: 1\nb: [1, 2\n").rfind("here:", 0), 0u);
  EXPECT_NE(refusal("a: 1\nb: [1, 2\n").find("not YAML"), std::string::npos);
  EXPECT_EQ(refusal("a: &x 1\nb: 2\nc: *x\n"), "here:3: an alias is not allowed; allowed: the value itself");
}

TEST(SafeYaml, says_what_is_wrong_and_allowed_before_the_parsers_own_words) {
  const std::string message = refusal("a: {b: 1\n");
  const std::size_t ours = message.find("not YAML: a bracket, brace, quote, colon or indentation"),
                    allowed = message.find("; allowed: YAML"), theirs = message.find("(the parser says: ");
  ASSERT_NE(theirs, std::string::npos) << message;
  EXPECT_LT(ours, allowed);
  EXPECT_LT(allowed, theirs);
}

// yaml-cpp 0.6.3 took all memory for these: Debian 11 and Ubuntu 20.04.
TEST(SafeYaml, that_ends_on_a_colon_within_braces_is_refused) {
  for (const char* text : {"{po:", "- {a: 1, leaving:", "[a, b:", "{a: {b:", "{:", "[:", "? {a:"})
    EXPECT_NE(refusal(text).find("(the parser says: end of "), std::string::npos)
        << text << " " << refusal(text);
  EXPECT_EQ(refusal("po:"), "");
}

TEST(SafeYaml, of_a_file_that_is_not_there_is_told_by_its_name) {
  try {
    load_yaml_file("/nowhere/at/all.yaml");
    FAIL();
  } catch (const YamlError& error) {
    EXPECT_STREQ(error.what(), "/nowhere/at/all.yaml: cannot be read; allowed: a readable YAML file");
  }
}

TEST(YamlValues, are_of_their_type_and_finite) {
  const auto node = [](const std::string& yaml) { return load_yaml("here", yaml); };
  EXPECT_EQ(yaml_number(node("-0.5")), -0.5);
  EXPECT_EQ(yaml_number(node("3")), 3.0);
  for (const char* no : {"x", "[1]", ".inf", "-.inf", ".nan", "{a: 1}", "1 2"})
    EXPECT_FALSE(yaml_number(node(no))) << no;
  EXPECT_EQ(yaml_integer(node("-7")), -7);
  for (const char* no : {"1.5", "[1]", "99999999999", "x"}) EXPECT_FALSE(yaml_integer(node(no))) << no;
  EXPECT_EQ(yaml_vector(node("[1, -2, 0.5]")), Vector3(1, -2, 0.5));
  for (const char* no : {"[1, 2]", "[1, 2, 3, 4]", "[1, x, 3]", "[1, 2, .nan]", "1", "{a: 1, b: 2, c: 3}"})
    EXPECT_FALSE(yaml_vector(node(no))) << no;
}

TEST(YamlValues, a_range_has_its_ends_and_says_so) {
  const Range closed(-1, 2), open(0, 1, false);
  for (const double in : {-1.0, 0.0, 2.0}) EXPECT_TRUE(closed.contains(in));
  for (const double out : {-1.0000001, 2.0000001}) EXPECT_FALSE(closed.contains(out));
  EXPECT_TRUE(open.contains(1e-9));
  EXPECT_FALSE(open.contains(0.0));
  EXPECT_TRUE(open.contains(1.0));
  EXPECT_FALSE(open.contains(std::nan("")));
  EXPECT_FALSE(closed.contains(std::nan("")));
  EXPECT_EQ(closed.describe(), "a number from -1 to 2");
  EXPECT_EQ(open.describe(), "a number above 0, at most 1");
}

TEST(YamlValues, are_shown_on_one_short_line) {
  EXPECT_EQ(yaml_text(load_yaml("here", "")), "nothing");
  EXPECT_EQ(yaml_text(load_yaml("here", "~")), "nothing");
  EXPECT_EQ(yaml_text(load_yaml("here", "a b")), "a b");
  EXPECT_EQ(yaml_text(load_yaml("here", "[1, 2]")), "[1, 2]");
  EXPECT_EQ(yaml_text(load_yaml("here", std::string(61, 'x'))), std::string(60, 'x') + "...");
}

/// What reading an element by `read` is refused with.
template <typename Read>
std::string element_refusal(const std::string& yaml, const Read& read) {
  const std::string file = "f.yaml";
  try {
    read(YamlElement{file, "", load_yaml(file, yaml)});
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

TEST(YamlElement, is_told_by_file_line_and_path) {
  const std::string yaml = "bodies:\n  cube:\n    at:\n      - [1, 2, 3]\n      - [1, 2]\n";
  const auto place = [](const YamlElement& top, std::size_t index) {
    return top.at("bodies").at("cube").at("at").at(index);
  };
  EXPECT_EQ(element_refusal(yaml, [&](const YamlElement& top) { read_vector(place(top, 0)); }), "");
  EXPECT_EQ(element_refusal(yaml, [&](const YamlElement& top) { read_vector(place(top, 1)); }),
            "f.yaml:5: bodies/cube/at/2: [1, 2] is not allowed; allowed: three numbers [x, y, z] from -1000 "
            "to 1000");
  EXPECT_EQ(element_refusal("1", [](const YamlElement& top) { top.fail("is odd"); }), "f.yaml:1: is odd");
}

TEST(YamlElement, a_vector_has_each_of_its_numbers_in_the_range) {
  const auto read = [](const YamlElement& top) { read_vector(top, {-1, 1}); };
  EXPECT_EQ(element_refusal("[-1, 1, 0]", read), "");
  for (const char* beyond : {"[-1.01, 0, 0]", "[0, 1.01, 0]", "[0, 0, -2]", "[0, 0, 2]"})
    EXPECT_NE(element_refusal(beyond, read).find("from -1 to 1"), std::string::npos) << beyond;
}

TEST(YamlElement, keys_are_known_and_given_once) {
  const auto read = [](const YamlElement& top) {
    EXPECT_EQ(checked_keys(top, {"mass", "size", "name"}), (std::vector<std::string>{"size", "mass"}));
  };
  EXPECT_EQ(element_refusal("{size: 1, mass: 2}", read), "");
  EXPECT_EQ(element_refusal("{size: 1, weight: 2}", read),
            "f.yaml:1: unknown key 'weight'; allowed: mass, size, name");
  EXPECT_EQ(element_refusal("{size: 1, size: 2}", read),
            "f.yaml:1: key 'size' is given twice; allowed: once");
  EXPECT_EQ(element_refusal("[1]", read),
            "f.yaml:1: [1] is not allowed; allowed: a map with the keys mass, size, name");
}

TEST(ReadYaml, tells_whatever_is_wrong_as_the_readers_own_error_of_one_line) {
  class Wrong : public std::runtime_error {
   public:
    using std::runtime_error::runtime_error;
  };
  const auto told = [](const char* yaml) -> std::string {
    try {
      return read_yaml<Wrong>("here", [&] { return load_yaml("here", yaml)["a"]["b"].as<std::string>(); });
    } catch (const Wrong& error) {
      return error.what();
    }
  };
  EXPECT_EQ(told("a: {b: c}"), "c");
  EXPECT_EQ(told("a: &x 1\nb: *x"), refusal("a: &x 1\nb: *x"));
  // yaml-cpp 0.6, as on Debian 11, does not say where.
  const std::string scalar = told("\na: 1");
  EXPECT_TRUE(scalar.rfind("here:2: not YAML: ", 0) == 0 || scalar.rfind("here: not YAML: ", 0) == 0)
      << scalar;
  EXPECT_EQ(told("a: {}").rfind("here", 0), 0u) << told("a: {}");
}

}  // namespace
}  // namespace mrhi
