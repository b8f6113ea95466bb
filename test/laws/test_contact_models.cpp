#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/simulation.h"
#include "support/fixtures.h"

namespace mrhi {
namespace {

std::string text_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

TEST(ContactModels, have_names_and_places_of_their_own_and_implicit_is_first) {
  std::set<std::string> names;
  std::set<int> places;
  for (const ContactModelEntry* model : contact_models())
    names.insert(model->name), places.insert(model->place);
  EXPECT_EQ(names.size(), contact_models().size());
  EXPECT_EQ(places.size(), contact_models().size());
  EXPECT_STREQ(contact_models().front()->name, "implicit");
  EXPECT_EQ(Configuration().contact_model, ContactModelKind::implicit);
}

TEST(ContactModels, can_be_set_by_name_made_and_have_their_own_stiffness) {
  for (const ContactModelEntry* model : contact_models()) {
    SCOPED_TRACE(model->name);
    Configuration configuration;
    set_parameter(configuration, "contact_model", model->name);
    EXPECT_EQ(configuration.contact_model.name, model->name);
    EXPECT_NO_THROW(Simulation(Scene(), configuration));
    EXPECT_EQ(default_material(configuration).stiffness, model->stiffness);
  }
}

TEST(ContactModels, one_that_is_not_known_is_refused_by_name) {
  Configuration configuration;
  configuration.contact_model = {"springs"};
  try {
    Simulation(Scene(), configuration);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("'springs' is not known; allowed: implicit, "),
              std::string::npos);
  }
}

// What cannot ask the registry: Python, YAML and what people read.
TEST(ContactModels, are_listed_wherever_all_of_them_are) {
  for (const char* file : {"scripts/study/measures.py", "workflow/config.yaml", "config/default.yaml",
                           "docs/contact.md", "README.md"}) {
    const std::string text = text_of(file);
    ASSERT_FALSE(text.empty()) << file;
    for (const ContactModelEntry* model : contact_models())
      EXPECT_NE(text.find(model->name), std::string::npos) << model->name << " is not in " << file;
  }
}

// The cube ends at the surface, or ahead of it by an impact; the softest model lets it in by some
// millimetres.
TEST(ContactModels, each_phalanx_and_the_palm_push_what_they_meet) {
  constexpr double kEdge = 0.05, kRadius = 0.01, kSpeed = 0.1, kFrom = -0.06, kSeconds = 0.5;
  for (const ContactModelEntry* model : contact_models()) {
    for (int capsule = 0; capsule < kCapsules; ++capsule) {
      Simulation simulation(testing::scene_of(testing::box_body(Vector3::Constant(kEdge), 0.1)),
                            testing::unfiltered({model->name}));
      testing::play(simulation, 0.0, kSeconds, 100.0, [capsule](double t) {
        const Vector3 middle(kFrom + kSpeed * t, 0, 0), half(0, 0.02, 0);
        return testing::finger(middle - half, middle + half, kRadius, capsule);
      });
      const double pushed_to = kFrom + kSpeed * kSeconds + kRadius + 0.5 * kEdge;
      EXPECT_GT(simulation.state().bodies[0].pose.position.x(), pushed_to - 0.005)
          << model->name << ", capsule " << capsule;
    }
  }
}

}  // namespace
}  // namespace mrhi
