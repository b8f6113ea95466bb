#include <gtest/gtest.h>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/ros/server_parameters.h"

namespace mrhi {
namespace {

using Value = XmlRpc::XmlRpcValue;

TEST(ServerParameters, values_become_yaml_that_keeps_their_bits) {
  EXPECT_EQ(yaml_text(Value(true)), "true");
  EXPECT_EQ(yaml_text(Value(3)), "3");
  EXPECT_EQ(yaml_text(Value("window")), "window");
  EXPECT_EQ(std::stod(yaml_text(Value(1.0 / 3.0))), 1.0 / 3.0);
  Value vector;
  vector[0] = 0.0;
  vector[1] = 0;
  vector[2] = -9.5;
  EXPECT_EQ(yaml_text(vector), "[0, 0, -9.5]");
}

TEST(ServerParameters, a_vector_written_as_text_in_a_launch_file_is_taken) {
  Configuration configuration;
  set_parameter(configuration, "gravity", yaml_text(Value("[0, 0, -1.62]")));
  ASSERT_TRUE(configuration.gravity);
  EXPECT_EQ(configuration.gravity->z(), -1.62);
}

}  // namespace
}  // namespace mrhi
