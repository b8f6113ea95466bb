#include <array>
#include <cmath>
#include <stdexcept>

#include "../engine.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi::benchmark {
namespace {

// Every contact model with the paper's hand, which no load stops, like the peers' hands and the closed forms;
// `implicit` also with stiffer fingers, and with the default hand: its strength, mass and pads. Without a
// filter, as the hand's poses are given. Simulation::step() is measured. The broad phase runs once per frame,
// in begin(), with tracking of the hand. "with begin" measures both, which peers do within a step. "whole
// frame" is an application's cost: it includes reported contacts and events, and rendering of the hand.
enum class Measured { step, begin_and_step, whole_frame };

struct Setting {
  const char* name;
  ContactModelKind model;
  double stiffness;  // [N/m], 0: the model's default
  Measured measured;
  bool shipped_hand = false;
};

constexpr std::array<Setting, 14> kSettings{{
    {"implicit", ContactModelKind::implicit, 0.0, Measured::step},
    {"implicit; stiffness 20000", ContactModelKind::implicit, 20000.0, Measured::step},
    {"implicit; stiffness 200000", ContactModelKind::implicit, 200000.0, Measured::step},
    {"implicit; stiffness 2000000", ContactModelKind::implicit, 2000000.0, Measured::step},
    {"implicit; with begin", ContactModelKind::implicit, 0.0, Measured::begin_and_step},
    {"implicit; whole frame", ContactModelKind::implicit, 0.0, Measured::whole_frame},
    {"implicit; shipped hand", ContactModelKind::implicit, 0.0, Measured::step, true},
    {"implicit; shipped hand; whole frame", ContactModelKind::implicit, 0.0, Measured::whole_frame, true},
    {"implicit; shipped hand; stiffness 2000000; whole frame", ContactModelKind::implicit, 2000000.0,
     Measured::whole_frame, true},
    {"seed", ContactModelKind::seed, 0.0, Measured::step},
    {"penetration", ContactModelKind::penetration, 0.0, Measured::step},
    {"impulse", ContactModelKind::impulse, 0.0, Measured::step},
    {"virtual_spring", ContactModelKind::virtual_spring, 0.0, Measured::step},
    {"soft_pad", ContactModelKind::soft_pad, 0.0, Measured::step},
}};

Body body_of(const BodySpec& spec, const Material& material, std::size_t index) {
  Body body;
  body.name = "body_" + std::to_string(index);
  body.fixed = spec.fixed;
  body.mass = spec.mass;
  body.inertia = spec.inertia.asDiagonal();
  body.start = spec.pose;
  body.start_twist = spec.twist;
  body.material = material;
  std::visit([&body](const auto& shape) { body.shapes.push_back({shape, {}}); }, spec.shape);
  return body;
}

mrhi::Scene scene_of(const World& world, const Configuration& configuration) {
  Material material = default_material(configuration);
  material.restitution = world.restitution;
  material.static_friction = material.dynamic_friction = world.friction;
  mrhi::Scene scene;
  scene.name = "benchmark";
  scene.gravity = world.gravity;
  scene.bounds = {Vector3::Constant(-1e3), Vector3::Constant(1e3)};
  for (const BodySpec& spec : world.bodies)
    scene.bodies.push_back(body_of(spec, material, scene.bodies.size()));
  for (const HingeSpec& hinge : world.hinges) {
    const Pose at{hinge.anchor, Quaternion::Identity()};
    Joint joint;
    joint.name = "hinge_" + std::to_string(scene.joints.size());
    joint.child = static_cast<int>(hinge.body);
    joint.axis = hinge.axis;
    joint.in_parent = at;
    joint.in_child = world.bodies[hinge.body].pose.inverse() * at;
    joint.friction = hinge.friction;
    scene.joints.push_back(joint);
  }
  return scene;
}

Configuration configuration_of(const Setting& setting, const World& world, double step) {
  Configuration configuration;
  configuration.contact.sleep = world.sleep;
  if (!setting.shipped_hand) configuration.contact.hand = HandStrength{};
  configuration.contact_model = setting.model;
  configuration.step = step;
  configuration.filter.type = FilterKind::none;
  if (setting.stiffness > 0.0) configuration.stiffness = setting.stiffness;
  return configuration;
}

class OurEngine final : public Engine {
 public:
  static constexpr bool kHinges = true, kMeshes = true;
  OurEngine(const Setting& setting, const World& world, double step)
      : measured_(setting.measured),
        step_(std::llround(step * 1e9)),
        parts_(world.kinematics),
        simulation_(scene_of(world, configuration_of(setting, world, 1e-9 * static_cast<double>(step_))),
                    configuration_of(setting, world, 1e-9 * static_cast<double>(step_))) {
    frame_.stamp = 1'000'000'000;
    std::size_t first = 0;
    for (const KinematicSpec& part : parts_) {
      first_capsule_.push_back(first);
      first += part.capsules.size();
    }
    frame_.hands.resize((first + kCapsules - 1) / kCapsules);
    if (frame_.hands.size() > kMaxHands) throw std::runtime_error("more capsules than four hands have");
    for (std::size_t i = 0; i < frame_.hands.size(); ++i)
      frame_.hands[i].id = static_cast<std::uint32_t>(i + 1);
    for (std::size_t i = 0; i < parts_.size(); ++i) place(i, parts_[i].pose);
    simulation_.advance(frame_);
  }

  void move(std::size_t kinematic, const Pose&, const Pose& next) override { place(kinematic, next); }

  void before_step() override {
    frame_.stamp += step_;
    if (measured_ == Measured::step) simulation_.begin(frame_);
  }
  void step() override {
    if (measured_ != Measured::step) simulation_.begin(frame_);
    while (simulation_.step()) {
    }
    if (measured_ == Measured::whole_frame) simulation_.end();
  }
  void after_step() override {
    if (measured_ != Measured::whole_frame) simulation_.end();
  }

  Motion motion(std::size_t body) const override {
    const BodyState& state = simulation_.state().bodies[body];
    return {state.pose, twist_of(simulation_.scene().bodies[body], state)};
  }

  double pressing(std::size_t part) const override {
    double sum = 0.0;
    for (const Contact& contact : simulation_.state().contacts) {
      const std::size_t index = contact.key.hand * kCapsules + contact.key.capsule;
      if (index >= first_capsule_[part] && index < first_capsule_[part] + parts_[part].capsules.size())
        sum += contact.force.norm();
    }
    return sum;
  }

 private:
  void place(std::size_t part, const Pose& pose) {
    for (std::size_t c = 0; c < parts_[part].capsules.size(); ++c) {
      const std::size_t index = first_capsule_[part] + c;
      const Capsule& local = parts_[part].capsules[c];
      Hand& hand = frame_.hands[index / kCapsules];
      hand.capsules[index % kCapsules] = {pose * local.start, pose * local.end, local.radius};
      if (index % kCapsules == 0) hand.palm = pose;
    }
  }

  Measured measured_;
  Nanoseconds step_;
  std::vector<KinematicSpec> parts_;
  std::vector<std::size_t> first_capsule_;
  HandFrame frame_;
  Simulation simulation_;
};

using OurMaker = TableMaker<OurEngine, kSettings>;

}  // namespace
}  // namespace mrhi::benchmark

MRHI_ENGINE_MODULE(mrhi::benchmark::OurMaker)
