#include "ros/live_controls.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "tracking/hand_filter.h"

namespace mrhi {
namespace {

using Config = mr_hand_interaction::TuneConfig;

dynamic_reconfigure::Config message_of(const Config& config) {
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  return message;
}

/// The parameter that a field of the dialog is named after.
std::string parameter_of(const std::string& field) {
  if (field.rfind("gravity_", 0) == 0) return "gravity";
  for (std::string name : parameter_names()) {
    std::string with_bars = name;
    std::replace(with_bars.begin(), with_bars.end(), '/', '_');
    if (with_bars == field) return name;
  }
  return "";
}

template <class Fields>
void expect_ends_of_the_table(const Fields& least, const Fields& most) {
  ASSERT_EQ(least.size(), most.size());
  for (std::size_t i = 0; i < least.size(); ++i) {
    const std::string name = parameter_of(least[i].name);
    ASSERT_NE(name, "") << least[i].name << " is no parameter";
    const ParameterLimits limits = parameter_limits(name).value();
    EXPECT_EQ(least[i].value, limits.slider_min) << name;
    EXPECT_EQ(most[i].value, limits.slider_max) << name;
  }
}

TEST(Tuning, sliders_end_where_the_parameters_table_says) {
  Config least = Config::__getDefault__(), most = least;
  Tuning::slider_ends(least, most);
  const dynamic_reconfigure::Config low = message_of(least), high = message_of(most);
  EXPECT_GE(low.doubles.size(), 12u);
  expect_ends_of_the_table(low.doubles, high.doubles);
  expect_ends_of_the_table(low.ints, high.ints);
}

/// What a field is offered as.
std::string offered(const std::string& field) {
  for (const auto& parameter : Config::__getParamDescriptions__())
    if (parameter->name == field) return parameter->edit_method + " " + parameter->description;
  return "";
}

void expect_offers(const std::string& field, const std::string& word) {
  EXPECT_NE(offered(field).find("'" + word + "'"), std::string::npos) << word << ": " << offered(field);
}

TEST(Tuning, offers_every_contact_model_and_every_filter_with_its_numbers) {
  for (const ContactModelEntry* model : contact_models()) expect_offers("contact_model", model->name);
  for (const HandFilter* filter : hand_filters()) expect_offers("filter_type", filter->name);
  for (const FilterSetting& setting : filter_settings())
    EXPECT_NE(offered(std::string("filter_") + setting.name), "") << setting.name;
}

TEST(Tuning, numbers_begin_at_the_parameters_defaults) {
  const Configuration defaults;
  const dynamic_reconfigure::Config shown = message_of(Config::__getDefault__());
  for (const auto& field : shown.doubles) {
    if (field.name.rfind("gravity_", 0) == 0 || field.name == "material_stiffness" ||
        field.name == "filter_noise")
      continue;
    EXPECT_EQ(field.value, std::stod(parameter_text(defaults, parameter_of(field.name)))) << field.name;
  }
}

}  // namespace
}  // namespace mrhi
