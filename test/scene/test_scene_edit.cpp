#include "mr_hand_interaction/scene/scene.h"

#include <gtest/gtest.h>

#include "support/joints.h"

namespace mrhi {
namespace {

using testing::box_body;
using testing::hinge;

Body named(const std::string& name) {
  Body body = box_body({0.02, 0.02, 0.02}, 0.1);
  body.name = name;
  return body;
}

/// a <- b <- d, a <- c by joints named after their children; e flies, f hangs on the world.
Scene family() {
  Scene scene;
  scene.name = "family";
  for (const char* name : {"a", "b", "c", "d", "e", "f"}) scene.bodies.push_back(named(name));
  for (const auto& [parent, child] : std::vector<std::pair<int, int>>{{0, 1}, {0, 2}, {1, 3}, {-1, 5}}) {
    Joint joint = hinge(parent, child, {{0, 0, 0.1}, Quaternion::Identity()}, {});
    joint.name = scene.bodies[std::size_t(child)].name;
    scene.joints.push_back(joint);
  }
  return scene;
}

std::string bodies_of(const Scene& scene) {
  std::string names;
  for (const Body& body : scene.bodies) names += body.name;
  return names;
}
/// "ba " for a joint by which b hangs on a; '-' is the world.
std::string joints_of(const Scene& scene) {
  std::string names;
  for (const Joint& joint : scene.joints) {
    EXPECT_EQ(joint.name, scene.bodies.at(std::size_t(joint.child)).name);
    names += joint.name + (joint.parent < 0 ? "-" : scene.bodies.at(std::size_t(joint.parent)).name) + " ";
  }
  return names;
}

TEST(RemoveBody, takes_along_what_hangs_on_it_and_leaves_all_other_joints_their_bodies) {
  const struct {
    const char *taken, *bodies, *joints;
  } cases[] = {{"a", "ef", "f- "},          {"b", "acef", "ca f- "},        {"c", "abdef", "ba db f- "},
               {"d", "abcef", "ba ca f- "}, {"e", "abcdf", "ba ca db f- "}, {"f", "abcde", "ba ca db "}};
  for (const auto& one : cases) {
    Scene scene = family();
    remove_body(std::size_t(*find_body(scene, one.taken)), scene);
    EXPECT_EQ(bodies_of(scene), one.bodies) << one.taken;
    EXPECT_EQ(joints_of(scene), one.joints) << one.taken;
  }
}

TEST(RemoveBody, what_hangs_on_it_is_told_in_the_scenes_order) {
  using Bodies = std::vector<std::size_t>;
  EXPECT_EQ(hanging_on(0, family()), (Bodies{0, 1, 2, 3}));
  EXPECT_EQ(hanging_on(1, family()), (Bodies{1, 3}));
  EXPECT_EQ(hanging_on(4, family()), (Bodies{4}));
}

TEST(Append, what_is_added_has_its_own_joints_and_is_taken_out_again_without_a_trace) {
  Scene part;
  part.bodies = {named("x"), named("y"), named("z")};
  part.joints = {hinge(-1, 0, {}, {}), hinge(0, 2, {}, {})};
  part.joints[0].name = "x", part.joints[1].name = "z";
  Scene scene = family();
  append(part, scene);
  EXPECT_EQ(bodies_of(scene), "abcdefxyz");
  EXPECT_EQ(joints_of(scene), "ba ca db f- x- zx ");
  remove_body(std::size_t(*find_body(scene, "x")), scene);
  EXPECT_EQ(bodies_of(scene), "abcdefy");
  remove_body(std::size_t(*find_body(scene, "y")), scene);
  EXPECT_EQ(bodies_of(scene), bodies_of(family()));
  EXPECT_EQ(joints_of(scene), joints_of(family()));
}

TEST(Append, a_name_that_is_taken_is_refused_and_nothing_is_added) {
  Scene part;
  part.bodies = {named("x"), named("c")};
  Scene scene = family();
  try {
    append(part, scene);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "object 'c' is there already; allowed: a name other than a, b, c, d, e, f");
  }
  EXPECT_EQ(bodies_of(scene), "abcdef");
  part.bodies = {named("x")};
  part.joints = {hinge(-1, 0, {}, {})};
  part.joints[0].name = "d";
  try {
    append(part, scene);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "joint 'd' is there already; allowed: a name that is not taken");
  }
  EXPECT_EQ(bodies_of(scene), "abcdef");
}

TEST(FindBody, gives_the_free_one_of_a_name_and_else_tells_which_there_are) {
  Scene scene = family();
  scene.bodies[1].fixed = true;
  EXPECT_EQ(find_body(scene, "b"), 1);
  EXPECT_FALSE(find_body(scene, "B"));
  EXPECT_EQ(&free_body(scene, "c"), &scene.bodies[2]);
  for (const char* name : {"b", "nobody"}) {
    try {
      free_body(scene, name);
      FAIL() << name;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()),
                "scene 'family' has no free object '" + std::string(name) + "'; allowed: a, c, d, e, f");
    }
  }
  for (Body& body : scene.bodies) body.fixed = true;
  EXPECT_THROW(free_body(scene, "a"), std::invalid_argument);
}

// What is wrong with a joint of this kind of settings; "" if nothing is.
std::string complaint(const std::function<void(Joint&)>& change) {
  Scene scene = family();
  Joint& joint = scene.joints[1];
  joint.lower = -1.0, joint.upper = 2.0;
  change(joint);
  try {
    arrange_joints(scene);
  } catch (const std::invalid_argument& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.rfind("joint '", 0), 0u) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    EXPECT_NE(what.find("; allowed: "), std::string::npos) << what;
    return what;
  }
  return "";
}

TEST(ArrangeJoints, takes_numbers_to_their_limits_and_none_beyond) {
  const struct {
    std::function<void(Joint&, double)> set;
    double least, most;
  } numbers[] = {
      {[](Joint& j, double x) { j.start = x; }, -1.0, 2.0},
      {[](Joint& j, double x) {
         j.lower = x;
         j.start = 1.5;
       },
       -1000.0, 1.5},
      {[](Joint& j, double x) {
         j.upper = x;
         j.start = -0.5;
       },
       -0.5, 1000.0},
      {[](Joint& j, double x) { j.restitution = x; }, 0.0, 1.0},
      {[](Joint& j, double x) { j.damping = x; }, 0.0, 1e5},
      {[](Joint& j, double x) { j.friction = x; }, 0.0, 1e5},
      {[](Joint& j, double x) {
         j.spring = JointSpring{x, 0.0};
       },
       0.0, 1e6},
      {[](Joint& j, double x) {
         j.spring = JointSpring{1.0, x};
       },
       -1000.0, 1000.0},
      {[](Joint& j, double x) {
         j.latch = Latch{x, 1.0, 0.1};
       },
       -1000.0, 1000.0},
      {[](Joint& j, double x) {
         j.latch = Latch{0.0, x, 0.1};
       },
       0.0, 1e5},
      {[](Joint& j, double x) {
         j.latch = Latch{0.0, 1.0, x};
       },
       1e-5, 10.0},
      {[](Joint& j, double x) {
         j.detents = Detents{{-0.5, 0.5}, x};
       },
       0.0, 1e5},
      {[](Joint& j, double x) {
         j.detents = Detents{{x, x + 1.0}, 1.0};
       },
       -1000.0, -1.0},
  };
  int which = 0;
  for (const auto& number : numbers) {
    const double beyond = 1e-6 * (number.most - number.least);
    EXPECT_EQ(complaint([&](Joint& joint) { number.set(joint, number.least); }), "") << which;
    EXPECT_EQ(complaint([&](Joint& joint) { number.set(joint, number.most); }), "") << which;
    EXPECT_NE(complaint([&](Joint& joint) { number.set(joint, number.least - beyond); }), "") << which;
    if (which < 12) {
      EXPECT_NE(complaint([&](Joint& joint) { number.set(joint, number.most + beyond); }), "") << which;
    }
    EXPECT_NE(complaint([&](Joint& joint) { number.set(joint, std::nan("")); }), "") << which;
    ++which;
  }
}

TEST(ArrangeJoints, detents_are_two_to_sixty_four_and_ascend) {
  const auto detents = [](std::vector<double> at) {
    return complaint([&](Joint& joint) { joint.detents = Detents{at, 1.0}; });
  };
  const auto row = [](int count, double distance) {
    std::vector<double> at;
    for (int i = 0; i < count; ++i) at.push_back(i * distance);
    return at;
  };
  EXPECT_EQ(detents(row(2, 0.1)), "");
  EXPECT_EQ(detents(row(64, 0.01)), "");
  EXPECT_EQ(detents(row(1, 0.1)), "joint 'c': 1 detents; allowed: 2 to 64");
  EXPECT_EQ(detents(row(65, 0.01)), "joint 'c': 65 detents; allowed: 2 to 64");
  EXPECT_EQ(detents({0.0, 2e-4, 4e-4}), "");
  EXPECT_NE(detents({0.0, 0.9e-4}), "");
  EXPECT_NE(detents({0.1, 0.0}), "");
  EXPECT_NE(detents({0.0, 0.1, 0.1}), "");
}

TEST(ArrangeJoints, refuses_what_is_no_tree) {
  const auto refused = [](const std::function<void(Scene&)>& change) {
    Scene scene = family();
    change(scene);
    try {
      arrange_joints(scene);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused([](Scene&) {}), "");
  EXPECT_EQ(refused([](Scene& s) { s.joints[0].parent = 3; }),  // a <- b needs d, which hangs on b
            "joint 'b': hangs in a loop of joints; allowed: trees");
  EXPECT_EQ(refused([](Scene& s) { s.joints[2].parent = 3; }),
            "joint 'd': hangs in a loop of joints; allowed: trees");
  EXPECT_EQ(refused([](Scene& s) { s.joints[2].child = 1; }),
            "joint 'd': is a second one of body 'b'; allowed: one joint to each body");
  EXPECT_EQ(refused([](Scene& s) { s.bodies[2].fixed = true; }),
            "joint 'c': moves the fixture 'c'; allowed: a body that is no fixture");
  for (const int nobody : {6, -1})
    EXPECT_EQ(refused([&](Scene& s) { s.joints[0].child = nobody; }),
              "joint 'b': a body that is not there; allowed: the scene's");
  for (const int nobody : {6, -2})
    EXPECT_EQ(refused([&](Scene& s) { s.joints[0].parent = nobody; }),
              "joint 'b': a body that is not there; allowed: the scene's");
  for (const Vector3& axis : {Vector3(0, 0, 0), Vector3(1, 1, 0), Vector3(std::nan(""), 0, 0)})
    EXPECT_NE(refused([&](Scene& s) { s.joints[0].axis = axis; }).find("allowed: a unit vector"),
              std::string::npos);
}

TEST(ArrangeJoints, two_hundred_and_fifty_six_are_taken) {
  Scene scene;
  for (int i = 0; i < 257; ++i) {
    scene.bodies.push_back(named("b" + std::to_string(i)));
    scene.joints.push_back(hinge(i % 32 == 0 ? Joint::kWorld : i - 1, i, {}, {}));
  }
  EXPECT_THROW(arrange_joints(scene), std::invalid_argument);
  scene.joints.pop_back();
  EXPECT_NO_THROW(arrange_joints(scene));
}

/// As chains and as stars: on the world, on a fixture, and on a body that is free, whose branches are one.
TEST(ArrangeJoints, thirty_two_that_hang_together_are_taken) {
  const auto said = [](int joints, bool chain, const char* root) {
    Scene scene;
    scene.bodies.push_back(named(root));
    scene.bodies[0].fixed = std::string(root) == "frame";
    for (int i = 1; i <= joints; ++i) {
      scene.bodies.push_back(named("b" + std::to_string(i)));
      const int on = std::string(root) == "world" ? Joint::kWorld : 0;
      scene.joints.push_back(hinge(chain && i > 1 ? i - 1 : on, i, {}, {}));
      scene.joints.back().name = "j" + std::to_string(i);
    }
    try {
      arrange_joints(scene);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string rest = " has more than 32 joints; allowed: at most that, and 256 in a scene";
  for (const char* const root : {"world", "frame", "free"}) {
    EXPECT_EQ(said(32, true, root), "") << root;
    EXPECT_EQ(said(33, true, root),
              "the mechanism of " +
                  std::string(root[1] == 'r' && root[2] == 'e' ? "body 'free'" : "joint 'j1'") + rest);
  }
  EXPECT_EQ(said(33, false, "free"), "the mechanism of body 'free'" + rest);
  EXPECT_EQ(said(33, false, "frame"), "") << "fixtures pass nothing on";
}

TEST(ArrangeJoints, comes_to_the_same_in_whichever_order_they_were) {
  Scene ordered = family();
  arrange_joints(ordered);
  Scene shuffled = family();
  std::reverse(shuffled.joints.begin(), shuffled.joints.end());
  arrange_joints(shuffled);
  for (std::size_t b = 0; b < ordered.bodies.size(); ++b) {
    EXPECT_EQ(shuffled.bodies[b].start.position, ordered.bodies[b].start.position);
    EXPECT_EQ(shuffled.bodies[b].flies, ordered.bodies[b].flies);
    EXPECT_EQ(ordered.bodies[b].flies, ordered.bodies[b].name == "e");
  }
  // A body's own joint comes before those of what hangs on it.
  std::vector<bool> placed(ordered.bodies.size(), false);
  for (const Joint& joint : shuffled.joints) {
    placed[std::size_t(joint.child)] = true;
    for (const Joint& other : shuffled.joints) {
      if (other.child == joint.parent) {
        EXPECT_TRUE(placed[std::size_t(joint.parent)]);
      }
    }
  }
}

TEST(ArrangeJoints, bodies_start_where_their_joints_have_them) {
  Scene scene;
  scene.bodies = {named("a"), named("b")};
  const Quaternion quarter(Eigen::AngleAxisd(M_PI / 2, Vector3::UnitZ()));
  scene.joints = {hinge(-1, 0, {{1, 2, 3}, quarter}, {{0, 0, 0.1}, Quaternion::Identity()}, M_PI / 2),
                  hinge(0, 1, {{0, 0, -0.1}, Quaternion::Identity()}, {{0.05, 0, 0}, quarter}, 0.2)};
  scene.joints[1].kind = JointKind::sliding;
  arrange_joints(scene);
  for (const Joint& joint : scene.joints) {
    const Pose parent = joint.parent < 0 ? Pose() : scene.bodies[0].start;
    const Pose on_parent = parent * joint.in_parent * joint_motion(joint, joint.start);
    const Pose on_child = scene.bodies[std::size_t(joint.child)].start * joint.in_child;
    EXPECT_LT((on_parent.position - on_child.position).norm(), 1e-12);
    EXPECT_LT(on_parent.orientation.angularDistance(on_child.orientation), 1e-12);
  }
  // By hand: the hinge's y, turned by the quarter, is -x in world; a quarter turn about it takes -z to -y.
  EXPECT_LT((scene.bodies[0].start.position - Vector3(1, 1.9, 3)).norm(), 1e-12);
}

}  // namespace
}  // namespace mrhi
