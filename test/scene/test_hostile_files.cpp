#include <gtest/gtest.h>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/training/task.h"
#include "scene/scene_files.h"

namespace mrhi {
namespace {

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

/// Ten aliases of ten aliases of ...: 10^levels values from a few lines.
std::string alias_bomb(int levels) {
  std::string yaml = "a0: &a0 [0, 0]\n";
  for (int i = 1; i <= levels; ++i) {
    const std::string name = "a" + std::to_string(i);
    yaml += name + ": &" + name + " [" + repeated("*a" + std::to_string(i - 1) + ", ", 9) + "*a" +
            std::to_string(i - 1) + "]\n";
  }
  return yaml;
}

std::string parameters_error(const std::string& yaml) {
  const test::Folder folder;
  Configuration configuration;
  try {
    load_parameters(configuration, folder.write("p.yaml", yaml));
  } catch (const ParameterError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    EXPECT_LT(std::string(error.what()).size(), 500u);
    return error.what();
  }
  return "";
}

std::string task_error(const std::string& yaml) {
  const test::Folder folder;
  try {
    load_task(folder.write("t.yaml", yaml));
  } catch (const SceneError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    EXPECT_LT(std::string(error.what()).size(), 500u);
    return error.what();
  }
  return "";
}

std::string settings_error(const std::string& yaml) {
  const test::Folder folder;
  folder.write("s.yaml", yaml);
  return test::scene_error(folder.write("s.urdf", test::thing(test::kInertial + std::string(test::kBox))));
}

std::string urdf_error(const std::string& xml) {
  const test::Folder folder;
  return test::scene_error(folder.write("s.urdf", xml));
}

TEST(HostileYaml, that_holds_itself_is_refused_with_its_line) {
  test::expect_words(parameters_error("step: 0.001\ngravity: &g [*g]\n"), {"p.yaml:2", "alias"});
  test::expect_words(parameters_error("filter: &f {type: *f}\n"), {"p.yaml:1", "alias"});
  test::expect_words(task_error("name: &n [*n]\n"), {"t.yaml:1", "alias"});
  test::expect_words(settings_error("materials: &m {thing: *m}\n"), {"s.yaml:1", "alias"});
}

TEST(HostileYaml, that_stands_for_more_than_it_is_is_refused) {
  for (const int levels : {1, 9, 30}) {
    test::expect_words(parameters_error(alias_bomb(levels)), {"p.yaml:2", "alias"});
    test::expect_words(task_error(alias_bomb(levels)), {"t.yaml:2", "alias"});
    test::expect_words(settings_error(alias_bomb(levels)), {"s.yaml:2", "alias"});
  }
}

TEST(HostileYaml, that_is_deep_or_large_is_refused) {
  test::expect_words(parameters_error("step: " + repeated("[", 100'000)), {"p.yaml:1", "32 levels"});
  test::expect_words(parameters_error(repeated("- ", 10'000)), {"p.yaml:1", "32 levels"});
  test::expect_words(parameters_error("step: " + repeated("{a: ", 100) + "1" + repeated("}", 100)),
                     {"p.yaml:1", "32 levels"});
  test::expect_words(task_error(repeated("# nothing\n", 100'000)), {"longer than 262144 bytes"});
}

TEST(HostileYaml, given_as_text_is_refused_alike) {
  Configuration configuration;
  for (const std::string& value : {std::string("&a [*a]"), repeated("[", 1000), repeated("x", 300'000)}) {
    try {
      set_parameter(configuration, "gravity", value);
      ADD_FAILURE() << value.substr(0, 60);
    } catch (const ParameterError& error) {
      EXPECT_LT(std::string(error.what()).size(), 500u);
    }
  }
}

TEST(HostileUrdf, that_is_deep_is_refused_before_it_is_parsed) {
  for (const int depth : {33, 30'000, 200'000})
    test::expect_words(urdf_error("<robot name=\"r\">" + repeated("<a>", depth)), {"32 levels"});
  // A '>' in quotes and a closing tag too many must not hide the depth.
  test::expect_words(urdf_error("<robot name=\"r\">" + repeated("<a b=\"/>\">", 100)), {"32 levels"});
  test::expect_words(urdf_error("<robot name=\"r\">" + repeated("</a>", 100) + repeated("<a>", 100)),
                     {"32 levels"});
}

// The library would call itself 200 000 times.
TEST(HostileUrdf, that_is_deep_behind_a_comment_that_only_seems_to_close_is_refused) {
  for (const char* before : {"<!--><a x=\"-->", "<?xml >", "<1 x=\">"})
    test::expect_words(urdf_error("<robot name=\"x\">" + std::string(before) + repeated("<a>", 200'000)),
                       {"bad URDF"});
}

TEST(HostileUrdf, that_is_large_is_refused) {
  test::expect_words(urdf_error("<robot name=\"r\">" + repeated("          ", 500'000)),
                     {"longer than 4194304 bytes"});
  test::expect_words(urdf_error("<robot name=\"r\">" + repeated("<a/>", 100'001)), {"at most 100000"});
}

// TinyXML 2.6.2 steps over the end of its buffer on a lead byte that lacks its continuation, and stands still
// on some of them.
TEST(HostileUrdf, that_is_no_text_is_refused) {
  const std::string good = test::thing(test::kInertial + std::string(test::kBox));
  for (const char* bytes : {"\xEF", "\xEF\xBB", "\xC0\x80", "\xF5", "\xE2\x28\xA1", "\x80", "\x01"}) {
    test::expect_words(urdf_error(good + bytes), {"is no text", "UTF-8"});
    test::expect_words(urdf_error("<robot name=\"" + std::string(bytes) + "\">"), {"is no text", "UTF-8"});
  }
  test::expect_words(urdf_error(good + std::string(1, '\0')), {"is no text", "UTF-8"});
}

TEST(HostileUrdf, that_declares_entities_is_refused) {
  test::expect_words(urdf_error("<!DOCTYPE r [<!ENTITY a \"b\">]><robot name=\"r\"/>"), {"document type"});
}

TEST(HostileUrdf, good_text_with_letters_of_any_language_and_comments_is_taken) {
  const std::string good = test::thing(test::kInertial + std::string(test::kBox));
  EXPECT_EQ(urdf_error("<?xml version=\"1.0\"?><!-- Gr\xC3\xB6\xC3\x9F"
                       "e > 3 <a><b> -->" +
                       good),
            "");
}

/// A free body of a 5 cm box at that place.
std::string box_at(const std::string& name, const std::string& origin) {
  return test::link(name, test::kInertial + std::string(test::kBox)) +
         test::joint("floating", "world", name, "xyz=\"" + origin + "\"");
}

TEST(Overlaps, of_bodies_at_load_are_refused_and_named) {
  EXPECT_EQ(urdf_error(test::robot(box_at("a", "0 0 0") + box_at("b", "0.05 0 0"))), "") << "they touch";
  EXPECT_EQ(urdf_error(test::robot(box_at("a", "0 0 0") + box_at("b", "0.0495 0 0"))), "") << "half a mm";
  test::expect_words(urdf_error(test::robot(box_at("a", "0 0 0") + box_at("b", "0.04 0 0"))),
                     {"'b' is 0.01 m in 'a'", "at most 0.001 m"});
  std::string boxes;
  for (int i = 0; i < 14; ++i) boxes += box_at("box" + std::to_string(i), "0 0 " + std::to_string(0.001 * i));
  const std::string message = urdf_error(test::robot(boxes));
  test::expect_words(message, {"'box1' is ", " m in 'box0'"});
  EXPECT_LT(message.size(), 600u);
}

TEST(Overlaps, of_fixtures_with_each_other_are_their_own_affair) {
  const std::string shelf = test::link("s", test::kBox) + test::joint("fixed", "world", "s") +
                            test::link("t", test::kBox) + test::joint("fixed", "world", "t");
  EXPECT_EQ(urdf_error(test::robot(shelf)), "");
  test::expect_words(urdf_error(test::robot(shelf + box_at("a", "0 0 0.03"))), {"'a' is 0.02 m in 's'"});
}

/// A scene of one free body whose collision shape is this mesh.
std::string mesh_error(const std::string& name, const std::string& text) {
  const test::Folder folder;
  folder.write(name, text);
  return test::scene_error(folder.write(
      "s.urdf", test::thing(std::string(test::kInertial) + "<collision><geometry><mesh filename=\"" + name +
                            "\"/></geometry></collision>")));
}

// Thirty nodes, each of which has the next twice: 2^30 nodes, more than any machine's memory.
TEST(HostileMesh, that_stands_for_an_endless_scene_is_given_up_within_its_limits) {
  std::string nodes;
  for (int i = 0; i < 30; ++i) {
    const std::string next = "<instance_node url=\"#n" + std::to_string(i + 1) + "\"/>";
    nodes += "<node id=\"n" + std::to_string(i) + "\">" + next + next + "</node>";
  }
  const std::string dae =
      "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
      "version=\"1.4.1\"><library_nodes>" +
      nodes +
      "<node id=\"n30\"/></library_nodes><library_visual_scenes><visual_scene id=\"s\"><node>"
      "<instance_node url=\"#n0\"/></node></visual_scene></library_visual_scenes><scene>"
      "<instance_visual_scene url=\"#s\"/></scene></COLLADA>";
  test::expect_words(mesh_error("bomb.dae", dae), {"mesh 'bomb.dae'", "memory"});
}

TEST(HostileMesh, that_is_too_large_or_has_too_many_triangles_is_refused) {
  test::expect_words(mesh_error("large.stl", std::string((64u << 20) + 1, 'x')), {"at most 67108864"});
  std::string faces = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\n";
  for (int i = 0; i < 500'001; ++i) faces += "f 1 2 3\n";
  test::expect_words(mesh_error("many.obj", faces), {"500001 triangles", "at most 500000"});
}

TEST(SceneError, is_one_line_whatever_the_file_is_called) {
  const test::Folder folder;
  try {
    load_scene(folder.write("two\nlines.urdf", "<robot"), {});
    FAIL();
  } catch (const SceneError& error) {
    test::expect_words(error.what(), {"two lines.urdf"});
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST(Names, of_links_are_short_and_of_letters_digits_bars_and_dashes) {
  const auto named = [](const std::string& name) {
    const std::string body = test::kInertial + std::string(test::kBox);
    return urdf_error(test::robot(test::link(name, body) + test::joint("floating", "world", name)));
  };
  EXPECT_EQ(named("Cube_2-b"), "");
  EXPECT_EQ(named(std::string(64, 'a')), "");
  for (const std::string& name :
       {std::string("../x"), std::string("=1+1"), std::string("+1"), std::string("-1"), std::string("@x"),
        std::string("a b"), std::string("W\xC3\xBC"), std::string(65, 'a'), std::string(100'000, 'a')}) {
    const std::string message = named(name);
    test::expect_words(message, {"64 letters, digits, '_' and '-'"});
    EXPECT_LT(message.size(), 500u);
  }
}

}  // namespace
}  // namespace mrhi
