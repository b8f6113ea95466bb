#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <limits>
#include <map>
#include <sstream>

#include "mr_hand_interaction/parameters.h"
#include "scene/scene_files.h"

namespace mrhi {
namespace {

std::string error(const std::string& name, const std::string& value) {
  Configuration configuration;
  try {
    set_parameter(configuration, name, value);
  } catch (const ParameterError& caught) {
    const std::string message = caught.what();
    EXPECT_EQ(std::string::npos, message.find('\n')) << message;
    return message;
  }
  return "";
}

std::string file_error(const std::string& yaml, Configuration configuration = {}) {
  const test::Folder folder;
  try {
    load_parameters(configuration, folder.write("p.yaml", yaml));
  } catch (const ParameterError& caught) {
    const std::string message = caught.what();
    EXPECT_EQ(std::string::npos, message.find('\n')) << message;
    return message;
  }
  return "";
}

Configuration set(const std::string& name, const std::string& value) {
  Configuration configuration;
  set_parameter(configuration, name, value);
  return configuration;
}

void expect_defaults(const Configuration& c) {
  const Configuration d;
  EXPECT_EQ(d.contact_model, c.contact_model);
  EXPECT_EQ(d.step, c.step);
  EXPECT_EQ(d.gravity.has_value(), c.gravity.has_value());
  EXPECT_EQ(d.filter.type, c.filter.type);
  EXPECT_EQ(d.filter.window, c.filter.window);
  EXPECT_EQ(d.filter.min_cutoff, c.filter.min_cutoff);
  EXPECT_EQ(d.filter.beta, c.filter.beta);
  EXPECT_EQ(d.filter.derivative_cutoff, c.filter.derivative_cutoff);
  EXPECT_EQ(d.filter.noise, c.filter.noise);
  EXPECT_EQ(d.filter.acceleration, c.filter.acceleration);
  EXPECT_EQ(d.filter.agility, c.filter.agility);
  EXPECT_EQ(d.material.restitution, c.material.restitution);
  EXPECT_EQ(d.material.static_friction, c.material.static_friction);
  EXPECT_EQ(d.material.dynamic_friction, c.material.dynamic_friction);
  EXPECT_EQ(d.stiffness, c.stiffness);
  EXPECT_EQ(d.hand_radius_scale, c.hand_radius_scale);
  EXPECT_EQ(d.hand_joint_speed, c.hand_joint_speed);
  EXPECT_EQ(d.control_display_ratio, c.control_display_ratio);
  EXPECT_EQ(d.tracking.hold_time, c.tracking.hold_time);
  EXPECT_EQ(d.tracking.max_speed, c.tracking.max_speed);
  EXPECT_EQ(d.contact.anchors, c.contact.anchors);
  EXPECT_EQ(d.contact.damping, c.contact.damping);
  EXPECT_EQ(d.contact.edge_grip, c.contact.edge_grip);
  EXPECT_EQ(d.contact.entry_face, c.contact.entry_face);
  EXPECT_EQ(d.contact.impact_friction, c.contact.impact_friction);
  EXPECT_EQ(d.contact.literal, c.contact.literal);
  EXPECT_EQ(d.contact.object_stiffness, c.contact.object_stiffness);
  EXPECT_EQ(d.contact.sleep, c.contact.sleep);
  EXPECT_EQ(d.contact.sweep, c.contact.sweep);
  EXPECT_EQ(d.contact.swing_back, c.contact.swing_back);
  EXPECT_EQ(d.contact.torsion, c.contact.torsion);
  EXPECT_EQ(d.contact.two_points, c.contact.two_points);
}

/// Unlike the defaults in every parameter.
Configuration unlike_defaults() {
  Configuration c;
  c.contact_model = ContactModelKind::impulse;
  c.step = 0.004;
  c.gravity = Vector3(1, 2, 3);
  c.filter = {FilterKind::none, 7, false, 11, 12, 13, 0.014, 15, 16};
  c.material = {0.11, 0.22, 0.12, 44};
  c.hand_radius_scale = 2;
  c.hand_joint_speed = 3;
  c.control_display_ratio = 1.5;
  c.contact = {false, false, false, false, false,
               false, false, false, false, false,
               false, false, true,  1,     {7, 8, 0.001, 0.03, 0.5, 0.25}};
  c.tracking = {1.5, 3};
  return c;
}

void collect_names(const YAML::Node& map, const std::string& prefix, std::vector<std::string>& names) {
  for (const auto& entry : map) {
    const std::string name = prefix + entry.first.Scalar();
    if (entry.second.IsMap()) {
      collect_names(entry.second, name + "/", names);
    } else {
      names.push_back(name);
    }
  }
}

TEST(Parameters, DefaultFileHoldsTheDefaultOfEveryParameter) {
  Configuration configuration = unlike_defaults();
  load_parameters(configuration, "config/default.yaml");
  expect_defaults(configuration);
  std::vector<std::string> names;
  collect_names(YAML::LoadFile("config/default.yaml"), "", names);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(parameter_names(), names);
}

TEST(Parameters, NamesAreTheContracts) {
  const std::vector<std::string> contract{"contact/anchors",
                                          "contact/damping",
                                          "contact/edge_grip",
                                          "contact/entry_face",
                                          "contact/grasp_assist",
                                          "contact/impact_friction",
                                          "contact/object_stiffness",
                                          "contact/release_fade",
                                          "contact/sleep",
                                          "contact/sweep",
                                          "contact/swing_back",
                                          "contact/torsion",
                                          "contact/two_points",
                                          "contact_model",
                                          "filter/acceleration",
                                          "filter/agility",
                                          "filter/beta",
                                          "filter/derivative_cutoff",
                                          "filter/min_cutoff",
                                          "filter/noise",
                                          "filter/type",
                                          "filter/window",
                                          "gravity",
                                          "hand/finger_mass",
                                          "hand/joint_speed",
                                          "hand/pad",
                                          "hand/palm_mass",
                                          "hand/palm_strength",
                                          "hand/radius_scale",
                                          "hand/restitution",
                                          "hand/strength",
                                          "material/dynamic_friction",
                                          "material/restitution",
                                          "material/static_friction",
                                          "material/stiffness",
                                          "rendering/control_display_ratio",
                                          "scene/density",
                                          "seed/literal",
                                          "step",
                                          "tracking/hold_time",
                                          "tracking/max_speed"};
  EXPECT_EQ(contract, parameter_names());
}

TEST(Parameters, EachNameSetsItsOwnValue) {
  EXPECT_EQ(ContactModelKind::penetration, set("contact_model", "penetration").contact_model);
  EXPECT_EQ(ContactModelKind::impulse, set("contact_model", "impulse").contact_model);
  EXPECT_EQ(ContactModelKind::seed, set("contact_model", "seed").contact_model);
  EXPECT_EQ(ContactModelKind::virtual_spring, set("contact_model", "virtual_spring").contact_model);
  EXPECT_EQ(ContactModelKind::soft_pad, set("contact_model", "soft_pad").contact_model);
  EXPECT_FALSE(set("contact/anchors", "false").contact.anchors);
  EXPECT_FALSE(set("contact/damping", "false").contact.damping);
  EXPECT_FALSE(set("contact/edge_grip", "false").contact.edge_grip);
  EXPECT_FALSE(set("contact/entry_face", "false").contact.entry_face);
  EXPECT_FALSE(set("contact/impact_friction", "false").contact.impact_friction);
  EXPECT_EQ(3e4, set("contact/object_stiffness", "3e4").contact.object_stiffness);
  EXPECT_FALSE(set("contact/sleep", "false").contact.sleep);
  EXPECT_FALSE(set("contact/sweep", "false").contact.sweep);
  EXPECT_FALSE(set("contact/swing_back", "false").contact.swing_back);
  EXPECT_FALSE(set("contact/torsion", "false").contact.torsion);
  EXPECT_FALSE(set("contact/two_points", "false").contact.two_points);
  EXPECT_EQ(0.002, set("step", "2e-3").step);
  EXPECT_EQ(Vector3(0, 0, -9.81), set("gravity", "[0, 0, -9.81]").gravity.value());
  EXPECT_FALSE(set("gravity", "scene").gravity);
  EXPECT_EQ(FilterKind::none, set("filter/type", "none").filter.type);
  EXPECT_EQ(FilterKind::window, set("filter/type", "window").filter.type);
  EXPECT_EQ(FilterKind::one_euro, set("filter/type", "one_euro").filter.type);
  EXPECT_EQ(FilterKind::constant_velocity, set("filter/type", "constant_velocity").filter.type);
  EXPECT_EQ(16, set("filter/window", "16").filter.window);
  EXPECT_EQ(1.5, set("filter/min_cutoff", "1.5").filter.min_cutoff);
  EXPECT_EQ(0, set("filter/beta", "0").filter.beta);
  EXPECT_EQ(5, set("filter/derivative_cutoff", "5").filter.derivative_cutoff);
  EXPECT_EQ(1e-3, set("filter/noise", "1e-3").filter.noise);
  EXPECT_FALSE(set("filter/noise", "estimated").filter.noise);
  EXPECT_EQ(2, set("filter/acceleration", "2").filter.acceleration);
  EXPECT_EQ(0, set("filter/agility", "0").filter.agility);
  EXPECT_EQ(1, set("material/restitution", "1").material.restitution);
  EXPECT_EQ(0.7, set("material/static_friction", "0.7").material.static_friction);
  EXPECT_EQ(0, set("material/dynamic_friction", "0").material.dynamic_friction);
  EXPECT_EQ(1e4, set("material/stiffness", "10000").stiffness);
  EXPECT_EQ(0.5, set("hand/radius_scale", "0.5").hand_radius_scale);
  EXPECT_EQ(2.5, set("hand/joint_speed", "2.5").hand_joint_speed);
  EXPECT_EQ(1.3, set("rendering/control_display_ratio", "1.3").control_display_ratio);
  EXPECT_EQ(0, set("tracking/hold_time", "0").tracking.hold_time);
  EXPECT_EQ(5, set("tracking/max_speed", "5").tracking.max_speed);
}

TEST(Parameters, AreReadBackAsTheyWereSet) {
  Configuration set;
  set_parameter(set, "step", "0.0012345678901234567");
  set_parameter(set, "gravity", "[0, -0.1, -1.62]");
  set_parameter(set, "contact_model", "seed");
  set_parameter(set, "filter/window", "7");
  set_parameter(set, "filter/noise", "0.003");
  set_parameter(set, "contact/sweep", "false");
  Configuration read;
  for (const std::string& name : parameter_names()) {
    EXPECT_EQ(parameter_text(Configuration(), name), parameter_text(read, name)) << name;
    set_parameter(read, name, parameter_text(set, name));
  }
  EXPECT_EQ(read.step, set.step);
  EXPECT_EQ(read.gravity, set.gravity);
  EXPECT_EQ(read.contact_model, set.contact_model);
  EXPECT_EQ(read.filter.window, 7);
  EXPECT_EQ(read.filter.noise, 0.003);
  EXPECT_FALSE(read.contact.sweep);
  EXPECT_EQ(parameter_text(read, "step"), "0.0012345678901234567");
  EXPECT_EQ(parameter_text(read, "material/stiffness"), "model");
  EXPECT_EQ(parameter_text(Configuration(), "filter/noise"), "estimated");
  EXPECT_THROW(parameter_text(read, "speed"), ParameterError);
}

TEST(Parameters, RefusesAnUnknownNameAndListsTheKnown) {
  std::vector<std::string> words = parameter_names();
  words.push_back("'filter/windw'");
  test::expect_words(error("filter/windw", "3"), words);
  test::expect_words(error("", "3"), {"unknown parameter ''"});
}

TEST(Parameters, RefusesValuesOfAWrongTypeOrOutOfRange) {
  const std::vector<std::array<std::string, 3>> wrong{
      {{"contact_model", "springs", "implicit, seed, penetration, impulse, virtual_spring, soft_pad"}},
      {{"contact_model", "[seed]", "implicit, seed, penetration, impulse, virtual_spring, soft_pad"}},
      {{"step", "0", "from 1e-05 to 0.05 [s]"}},
      {{"step", "0.0501", "from 1e-05 to 0.05"}},
      {{"step", "-1", "from 1e-05"}},
      {{"step", "fast", "a number"}},
      {{"step", "1 ms", "a number"}},
      {{"step", ".nan", "a number"}},
      {{"step", "", "a number"}},
      {{"contact/sweep", "1", "true, false"}},
      {{"gravity", "-9.81", "three numbers"}},
      {{"gravity", "[0, 0]", "three numbers"}},
      {{"gravity", "[0, 0, .inf]", "three numbers"}},
      {{"gravity", "moon", "'scene'"}},
      {{"filter/type", "kalman", "none, window, one_euro, constant_velocity"}},
      {{"filter/min_cutoff", "0", "from 0.01 to 1000 [Hz]"}},
      {{"filter/beta", "-1", "from 0 to 10000 [Hz per m/s]"}},
      {{"filter/derivative_cutoff", "0", "from 0.01 to 1000 [Hz]"}},
      {{"filter/noise", "0", "from 1e-06 to 0.1 [m], or 'estimated'"}},
      {{"filter/noise", "guessed", "from 1e-06 to 0.1 [m], or 'estimated'"}},
      {{"filter/acceleration", "0", "from 0.001 to 1000 [m/s^2]"}},
      {{"filter/agility", "-1", "from 0 to 1000 [1/s]"}},
      {{"filter/window", "0", "from 1 to 16"}},
      {{"filter/window", "17", "from 1 to 16"}},
      {{"filter/window", "2.5", "whole number"}},
      {{"material/restitution", "1.01", "from 0 to 1"}},
      {{"material/restitution", "-0.01", "from 0 to 1"}},
      {{"material/static_friction", "-1", "from 0 to 10"}},
      {{"material/dynamic_friction", "-1", "from 0 to 10"}},
      {{"material/stiffness", "0", "from 1 to 1e+07 [N/m]"}},
      {{"material/stiffness", ".inf", "from 1"}},
      {{"hand/radius_scale", "0.09", "from 0.1 to 10"}},
      {{"hand/radius_scale", "11", "from 0.1 to 10"}},
      {{"hand/joint_speed", "0", "from 0.1 to 100"}},
      {{"rendering/control_display_ratio", "0.9", "from 1 to 2"}},
      {{"hand/strength", "0", "from 0.1 to 1000 [N], or 'unlimited'"}},
      {{"hand/palm_strength", "strong", "from 0.1 to 1000 [N], or 'unlimited'"}},
      {{"hand/pad", "0.02", "from 0 to 0.01 [m]"}},
      {{"hand/finger_mass", "0", "from 0.001 to 10 [kg], or 'unlimited'"}},
      {{"tracking/hold_time", "-0.1", "from 0 to 10 [s]"}},
      {{"tracking/max_speed", "0", "from 0.1 to 1000 [m/s]"}},
  };
  for (const auto& [name, value, allowed] : wrong) {
    test::expect_words(error(name, value), {"'" + name + "'", value, "allowed: ", allowed});
  }
  test::expect_words(error("gravity", "[0, 0"), {"'gravity'", "[0, 0", "not YAML"});
}

/// Every number that can be set, as the text of a value with `number` in its place.
std::vector<std::pair<std::string, std::string>> with_number(const std::string& number) {
  std::vector<std::pair<std::string, std::string>> values;
  for (const std::string& name : parameter_names()) {
    if (!parameter_limits(name)) continue;
    values.emplace_back(name, name == "gravity" ? "[0, " + number + ", 0]" : number);
  }
  return values;
}

TEST(Parameters, EveryNumberHasTwoFiniteEndsThatAreAllowedAndNothingBeyond) {
  for (const auto& [name, any] : with_number("0")) {
    const ParameterLimits limits = parameter_limits(name).value();
    const auto text = [&, gravity = name == "gravity"](double value) {
      std::ostringstream stream;
      stream.precision(17);
      stream << value;
      return gravity ? "[0, " + stream.str() + ", 0]" : stream.str();
    };
    EXPECT_EQ(error(name, text(limits.min)), "") << name;
    EXPECT_EQ(error(name, text(limits.max)), "") << name;
    const double beyond = 1e-6 * (limits.max - limits.min);
    EXPECT_NE(error(name, text(limits.min - beyond)), "") << name;
    EXPECT_NE(error(name, text(limits.max + beyond)), "") << name;
    EXPECT_LE(limits.min, limits.slider_min) << name;
    EXPECT_LT(limits.slider_min, limits.slider_max) << name;
    EXPECT_LE(limits.slider_max, limits.max) << name;
  }
  for (const char* number : {"1e300", "-1e300", ".nan", ".inf", "-.inf", "1e999"}) {
    for (const auto& [name, value] : with_number(number)) EXPECT_NE(error(name, value), "") << name << value;
  }
}

TEST(Parameters, have_the_limits_and_sliders_that_were_reviewed) {
  // Least and greatest value, then the ends of the slider.
  const std::map<std::string, std::array<double, 4>> reviewed{
      {"contact/object_stiffness", {1, 1e+09, 10000, 1e+08}},
      {"filter/acceleration", {0.001, 1000, 0.01, 10}},
      {"filter/agility", {0, 1000, 0, 30}},
      {"filter/beta", {0, 10000, 0, 500}},
      {"filter/derivative_cutoff", {0.01, 1000, 0.1, 100}},
      {"filter/min_cutoff", {0.01, 1000, 0.1, 10}},
      {"filter/noise", {1e-06, 0.1, 1e-05, 0.01}},
      {"filter/window", {1, 16, 1, 16}},
      {"gravity", {-100, 100, -10, 10}},
      {"hand/finger_mass", {0.001, 10, 0.005, 0.5}},
      {"hand/joint_speed", {0.1, 100, 0.5, 20}},
      {"hand/pad", {0, 0.01, 0, 0.005}},
      {"hand/palm_mass", {0.001, 10, 0.05, 2}},
      {"hand/palm_strength", {0.1, 1000, 1, 200}},
      {"hand/radius_scale", {0.1, 10, 0.5, 2}},
      {"hand/restitution", {0, 1, 0, 1}},
      {"hand/strength", {0.1, 1000, 1, 100}},
      {"material/dynamic_friction", {0, 10, 0, 2}},
      {"material/restitution", {0, 1, 0, 1}},
      {"material/static_friction", {0, 10, 0, 2}},
      {"material/stiffness", {1, 1e+07, 10, 10000}},
      {"rendering/control_display_ratio", {1, 2, 1, 2}},
      {"scene/density", {0.1, 100000, 10, 10000}},
      {"step", {1e-05, 0.05, 0.0002, 0.01}},
      {"tracking/hold_time", {0, 10, 0, 2}},
      {"tracking/max_speed", {0.1, 1000, 1, 50}},
  };
  std::map<std::string, std::array<double, 4>> all;
  for (const std::string& name : parameter_names()) {
    if (const auto limits = parameter_limits(name))
      all[name] = {limits->min, limits->max, limits->slider_min, limits->slider_max};
  }
  EXPECT_EQ(all, reviewed);
}

TEST(Parameters, ThatAreNoNumberHaveNoLimits) {
  EXPECT_FALSE(parameter_limits("contact_model"));
  EXPECT_FALSE(parameter_limits("contact/sweep"));
  EXPECT_THROW(parameter_limits("speed"), ParameterError);
}

TEST(Parameters, SetInCodeAreValidatedToo) {
  Configuration configuration;
  configuration.step = 1e-10;
  EXPECT_THROW(validate(configuration), ParameterError);
  configuration = {};
  configuration.gravity = Vector3(0, 0, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(validate(configuration), ParameterError);
  configuration = {};
  configuration.filter.agility = 1e300;
  EXPECT_THROW(validate(configuration), ParameterError);
  configuration.filter.agility = 1000;
  EXPECT_NO_THROW(validate(configuration));
}

TEST(Parameters, TruthsAreThoseOfYamlInAnyCase) {
  Configuration configuration;
  for (const auto& [word, value] :
       {std::pair("False", false), std::pair("TRUE", true), std::pair("false", false)}) {
    set_parameter(configuration, "contact/sleep", word);
    EXPECT_EQ(value, configuration.contact.sleep) << word;
  }
  EXPECT_THROW(set_parameter(configuration, "contact_model", "SEED"), ParameterError);
}

TEST(Parameters, AreUnchangedByARefusedValue) {
  Configuration configuration;
  for (const std::string& name : parameter_names()) {
    EXPECT_THROW(set_parameter(configuration, name, "[1, {a: b}]"), ParameterError) << name;
  }
  EXPECT_THROW(set_parameter(configuration, "gravity", "[0, 0, x]"), ParameterError);
  expect_defaults(configuration);
  const test::Folder folder;
  const std::string file = folder.write("p.yaml", "step: 0.004\nfilter/window: 99\n");
  EXPECT_THROW(load_parameters(configuration, file), ParameterError);
  expect_defaults(configuration);
}

TEST(Parameters, FilesMayNestOrUseSlashes) {
  const test::Folder folder;
  Configuration configuration;
  load_parameters(configuration, folder.write("p.yaml", "filter: {window: 5}\nmaterial/stiffness: 250\n"));
  EXPECT_EQ(5, configuration.filter.window);
  EXPECT_EQ(250, configuration.stiffness);
  load_parameters(configuration, folder.write("empty.yaml", "# nothing\n"));
  EXPECT_EQ(5, configuration.filter.window);
}

TEST(Parameters, WrongFilesAreRefusedWithTheirLine) {
  test::expect_words(file_error("step: 0.001\nfilter:\n  window: 99\n"),
                     {"p.yaml:3", "'filter/window'", "99", "from 1 to 16"});
  test::expect_words(file_error("filter: {size: 3}"), {"p.yaml:1", "'filter/size'", "filter/window"});
  test::expect_words(file_error("filter: {window: 3}\nfilter/window: 4"),
                     {"p.yaml:2", "'filter/window'", "twice"});
  test::expect_words(file_error("- step"), {"p.yaml", "map"});
  test::expect_words(file_error("step: [1\nb: }"), {"p.yaml:", "not YAML"});
  Configuration configuration;
  EXPECT_THROW(load_parameters(configuration, "nowhere.yaml"), ParameterError);
}

TEST(Parameters, DynamicFrictionIsAtMostStatic) {
  Configuration configuration;
  EXPECT_NO_THROW(validate(configuration));
  set_parameter(configuration, "material/dynamic_friction", "0.9");
  try {
    validate(configuration);
    ADD_FAILURE();
  } catch (const ParameterError& caught) {
    test::expect_words(caught.what(), {"material/dynamic_friction", "0.9", "0.8"});
  }
  set_parameter(configuration, "material/static_friction", "0.9");
  EXPECT_NO_THROW(validate(configuration));
}

}  // namespace
}  // namespace mrhi
