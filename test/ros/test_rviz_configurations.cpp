#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

namespace mrhi {
namespace {

/// A configuration of rviz, seen from one and the same place.
std::string without_view(const std::string& name) {
  YAML::Node configuration = YAML::LoadFile("rviz/" + name + ".rviz");
  YAML::Node view = configuration["Visualization Manager"]["Views"]["Current"];
  EXPECT_TRUE(view.IsMap()) << name;
  for (const char* const key : {"Distance", "Focal Point"})
    EXPECT_TRUE(view.remove(key)) << name << ": " << key;
  return YAML::Dump(configuration);
}

TEST(RvizConfigurations, the_catch_is_drawn_as_all_else_and_seen_from_elsewhere) {
  EXPECT_EQ(without_view("catch"), without_view("interaction"));
}

TEST(RvizConfigurations, the_list_of_layers_is_open) {
  const YAML::Node window = YAML::LoadFile("rviz/interaction.rviz")["Window Geometry"];
  EXPECT_FALSE(window["Hide Left Dock"].as<bool>());
  EXPECT_FALSE(window["Displays"]["collapsed"].as<bool>());
}

}  // namespace
}  // namespace mrhi
