#include <gtest/gtest.h>

#include <sys/stat.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <regex>
#include <sstream>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/training/task.h"
#include "scene/scene_files.h"
#include "scene/solid_mesh.h"

namespace mrhi {
namespace {

using test::urdf_error;

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

/// A scene of one body of this mesh.
std::string mesh_error(const test::Folder& folder, const std::string& mesh) {
  return test::scene_error(folder.write(
      "s.urdf", test::thing(std::string(test::kInertial) + "<collision><geometry><mesh filename=\"" + mesh +
                            "\"/></geometry></collision>")));
}

// A scene goes to others, by topics, bags and saved files: a mesh of a stranger must not put files of this
// machine into it. A pipe as a buffer waits without end.
TEST(HostileMesh, reads_regular_files_in_its_folder_only) {
  const test::Folder around;
  std::filesystem::create_directories(around.path() + "/in/below");
  around.write("secret.bin", test::gltf_buffer());
  around.write("in/below/own.bin", test::gltf_buffer());
  const std::string in = around.path() + "/in/";
  std::filesystem::create_symlink("../secret.bin", in + "link.bin");
  std::filesystem::create_symlink("below/own.bin", in + "inner.bin");
  ASSERT_EQ(0, mkfifo((in + "pipe.bin").c_str(), 0600));
  const auto error = [&](const std::string& buffer) {
    around.write("in/part.gltf", test::gltf_of(buffer));
    return mesh_error(around, "in/part.gltf");
  };
  EXPECT_EQ(error("below/own.bin"), "");
  EXPECT_EQ(error("below/../inner.bin"), "");
  for (const char* buffer : {"../secret.bin", "link.bin", "below/../../secret.bin"})
    test::expect_words(error(buffer),
                       {"mesh 'in/part.gltf' names the file '", "in the mesh's folder; allowed"});
  test::expect_words(error("pipe.bin"), {"mesh 'in/part.gltf' names the file 'pipe.bin', which is no file"});
  around.write("in/id_rsa", test::gltf_buffer());
  std::filesystem::create_symlink("id_rsa", in + "key.bin");
  for (const char* buffer : {"id_rsa", "key.bin"})
    test::expect_words(error(buffer), {"names the file", "is no buffer; allowed: files that end in .bin"});
  std::filesystem::resize_file(in + "below/own.bin", (64u << 20) + 1);
  test::expect_words(error("below/own.bin"), {"names the file 'below/own.bin', which has 67108865 bytes"});
  test::expect_words(error("none.bin"), {"mesh 'in/part.gltf' cannot be read", "none.bin"});
}

TEST(HostileMesh, that_is_a_symlink_reads_the_files_beside_its_target) {
  const test::Folder folder;
  std::filesystem::create_directories(folder.path() + "/source");
  folder.write("source/part.gltf", test::gltf_of("part.bin"));
  folder.write("source/part.bin", test::gltf_buffer());
  std::filesystem::create_directories(folder.path() + "/installed");
  for (const char* file : {"part.gltf", "part.bin"})
    std::filesystem::create_symlink(std::string("../source/") + file, folder.path() + "/installed/" + file);
  EXPECT_EQ(mesh_error(folder, "installed/part.gltf"), "");
}

// An open fan of 20 000 points keeps the search for its hull busy for minutes.
TEST(HostileMesh, that_takes_long_ends_once_it_is_cancelled) {
  const test::Folder folder;
  std::ostringstream obj;
  constexpr int kPoints = 20'000;
  obj << "v 0 0 0\nv 0 0 .05\n";
  for (int i = 0; i < kPoints; ++i) {
    const double turn = 6.28 * i / kPoints;
    obj << "v " << 0.05 * std::cos(turn) << " " << 0.05 * std::sin(turn) << " .02\n";
  }
  for (int i = 0; i < kPoints; ++i) obj << "f 1 2 " << i + 3 << "\n";
  folder.write("fan.obj", obj.str());
  int asked = 0;
  SceneOptions options;
  options.is_cancelled = [&] { return ++asked > 5; };
  const auto begin = std::chrono::steady_clock::now();
  const std::string urdf = folder.write(
      "s.urdf", test::thing(std::string(test::kInertial) +
                            "<collision><geometry><mesh filename=\"fan.obj\"/></geometry></collision>"));
  test::expect_words(test::scene_error(urdf, options), {"is cancelled"});
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST(HostileMesh, has_its_triangles_counted_with_the_other_meshes_of_the_scene) {
  const test::Folder folder;
  const std::string obj = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const MeshFile a{folder.write("a.obj", obj), Vector3::Ones()}, larger{a.file, Vector3(2, 1, 1)},
      b{folder.write("b.obj", obj), Vector3::Ones()}, solid{a.file, a.scale, MeshUse::solid};
  MeshBudget budget{11, 20.0};
  const std::vector<LoadedMesh> meshes = load_meshes({a, solid, b, larger}, budget);
  for (const int i : {0, 1, 2}) EXPECT_EQ(meshes[i].problem, "") << i;
  test::expect_words(meshes[3].problem, {"over 11 triangles"});
  test::expect_words(load_meshes({a}, budget)[0].problem, {"over 0 triangles"});
  MeshBudget no_time{11, 0.0};
  test::expect_words(load_meshes({a, b}, no_time)[1].problem, {"more time than is allowed in all"});
}

// Colours are not used. What is opened is published with the mesh.
TEST(HostileMesh, opens_no_materials_of_an_obj) {
  const test::Folder folder;
  const std::string obj =
      "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\ng nothing\n";
  ASSERT_EQ(0, mkfifo((folder.path() + "/pipe.mtl").c_str(), 0600));
  folder.write("own.mtl", "newmtl a\nmap_Kd none.png\n");
  folder.write("key.bin", "secret");
  for (const char* materials : {"own.mtl", "none.mtl", "../../etc/passwd", "pipe.mtl", "key.bin"}) {
    // A line is left to assimp.
    folder.write("part.obj", "mtllib " + std::string(materials) + "\n" + obj + "l 1 2\n");
    MeshBudget budget;
    const LoadedMesh mesh = load_meshes({{folder.path() + "/part.obj", Vector3::Ones()}}, budget)[0];
    EXPECT_EQ(mesh.problem, "") << materials;
    EXPECT_TRUE(mesh.files.empty()) << materials;
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

// TinyXML 2.6.2 steps over the end of its buffer on a lead byte that lacks its continuation: it never sees
// one.
TEST(HostileUrdf, that_is_no_utf8_is_read_as_latin1_and_control_characters_are_refused) {
  const std::string good = test::thing(test::kInertial + std::string(test::kBox));
  for (const char* bytes : {"\xEF", "\xEF\xBB", "\xC0\x80", "\xF5", "\xE2\x28\xA1", "\x80"}) {
    EXPECT_EQ(urdf_error("<!-- " + std::string(bytes) + " -->" + good), "");
    test::expect_words(urdf_error("<robot name=\"" + std::string(bytes) + "\">"), {"bad URDF"});
  }
  test::expect_words(urdf_error(good + "\x01"), {"is no text", "UTF-8"});
  test::expect_words(urdf_error(std::string(1, '\0') + good), {"is no text", "UTF-8"});
  EXPECT_EQ(urdf_error(good + std::string(1, '\0')), "") << "as a C program ends its text";
}

// Libraries look each attribute up among those before it: 200 000 of them took a minute.
TEST(HostileUrdf, that_has_attributes_without_end_is_refused) {
  std::string many;
  for (int i = 0; i < 65; ++i) many += " a" + std::to_string(i) + "=\"\"";
  test::expect_words(urdf_error("<robot name=\"r\"><link" + many + "/></robot>"),
                     {"65 attributes", "at most 64"});
}

TEST(HostileUrdf, with_names_of_any_length_ends_in_one_line) {
  const std::string longest(40'000, 'x');
  for (const std::string& element : {"<mesh filename=\"" + longest + "\"/>", "<" + longest + "/>"})
    EXPECT_LT(urdf_error(test::thing(std::string(test::kInertial) + "<collision><geometry>" + element +
                                     "</geometry></collision>"))
                  .size(),
              1000u);
}

TEST(HostileUrdf, with_angles_that_mean_nothing_is_refused) {
  const std::string body = test::kInertial + std::string(test::kBox);
  for (const char* rpy : {"1e300 0 0", "0 1e4 0", "0 0 -1e19", "0 0 inf"})
    test::expect_words(urdf_error(test::thing(body, std::string("xyz=\"0 0 0\" rpy=\"") + rpy + "\"")),
                       {"rpy"});
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

/// A scene of one free body whose collision shape is this mesh.
std::string mesh_error(const std::string& name, const std::string& text) {
  const test::Folder folder;
  folder.write(name, text);
  return test::scene_error(folder.write(
      "s.urdf", test::thing(std::string(test::kInertial) + "<collision><geometry><mesh filename=\"" + name +
                            "\"/></geometry></collision>")));
}

TEST(HostileUrdf, that_says_too_much_or_too_little_is_not_guessed_at_in_silence) {
  const test::Folder folder;
  const std::string two =
      "<collision><geometry><box size=\".1 .1 .1\"/><sphere radius=\"1\"/></geometry></collision>";
  const Scene scene = load_scene(folder.write("s.urdf", test::thing(test::kInertial + two)), {});
  EXPECT_EQ(scene.warnings,
            std::vector<std::string>{
                "a visual or collision has one shape: its others are left out: link 'thing' collision"});
  for (const char* mass : {"<mass value=\"\"/>", "<mass/>"})
    test::expect_words(urdf_error(test::thing("<inertial>" + std::string(mass) + "</inertial>" + test::kBox)),
                       {"link 'thing' inertial: mass has no value"});
}

// Chains of 9000 links took 40 s.
TEST(HostileUrdf, of_a_long_chain_of_links_is_read_in_linear_time) {
  const test::Folder folder;
  const auto seconds = [&](int links, const std::string& first) {
    std::string content = test::joint(first, "world", "l0", "xyz=\"0.5 0 0\"");
    for (int i = 0; i < links; ++i) {
      const std::string name = "l" + std::to_string(i);
      content += test::link(name, i == links - 1 ? test::kInertial + std::string(test::kBox) : "");
      if (i > 0) content += test::joint("fixed", "l" + std::to_string(i - 1), name, "xyz=\"0 0 1e-5\"");
    }
    const std::string file = folder.write("s.urdf", test::robot(content));
    const std::clock_t begin = std::clock();  // of the processor: a busy machine does not count
    const Scene scene = load_scene(file, {});
    const std::clock_t end = std::clock();
    EXPECT_EQ(scene.bodies.size(), 1u);
    EXPECT_NEAR((scene.bodies[0].start.position - Vector3(0.5, 0.0, 1e-5 * (links - 1))).norm(), 0.0, 1e-9);
    return static_cast<double>(end - begin) / CLOCKS_PER_SEC;
  };
  for (const char* first : {"fixed", "floating"}) {
    const double few = seconds(800, first);
    EXPECT_LT(seconds(8000, first), 30 * few + 0.2) << first;
  }
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

TEST(Names, of_links_are_made_short_and_of_letters_digits_bars_and_dashes_and_that_is_said) {
  const test::Folder folder;
  const std::string body = test::kInertial + std::string(test::kBox);
  const auto named = [&](const std::string& name) {
    return load_scene(
        folder.write("s.urdf", test::robot(test::link(name, body) + test::joint("floating", "world", name))),
        {});
  };
  for (const std::string& name : {std::string("Cube_2-b"), std::string(64, 'a')}) {
    EXPECT_EQ(named(name).bodies.at(0).name, name);
    EXPECT_TRUE(named(name).warnings.empty());
  }
  const std::regex allowed("[A-Za-z0-9_][A-Za-z0-9_-]{0,63}");
  for (const std::string& name :
       {std::string("../x"), std::string("=1+1"), std::string("+1"), std::string("-1"), std::string("@x"),
        std::string("a b"), std::string("W\xC3\xBC"), std::string(65, 'a'), std::string(100'000, 'a'),
        std::string("a,b"), std::string("a/b"), std::string("Cup.001")}) {
    const Scene scene = named(name);
    EXPECT_TRUE(std::regex_match(scene.bodies.at(0).name, allowed)) << scene.bodies[0].name;
    test::expect_words(scene.warnings.at(0), {"64 letters, digits, '_' and '-'", scene.bodies[0].name});
    EXPECT_LT(scene.warnings[0].size(), 700u);
  }
  // Names that become the same are told apart, and one that may stay stays.
  const Scene two = load_scene(
      folder.write("s.urdf", test::robot(test::link("a.b", body) + test::link("a_b", body) +
                                         test::joint("floating", "world", "a.b") +
                                         test::joint("floating", "world", "a_b", "xyz=\"1 0 0\""))),
      {});
  EXPECT_EQ(two.bodies.at(0).name, "a_b_2");
  EXPECT_EQ(two.bodies.at(1).name, "a_b");
}

}  // namespace
}  // namespace mrhi
