#include <Simbody.h>

#include <algorithm>
#include <cmath>

#include "../engine.h"

namespace mrhi::benchmark {
namespace {

struct Setting {
  const char* name;
  double accuracy;   // of the error-controlled integrator, 1e-3 by default
  double stiffness;  // of the contact material [Pa] (Hertz)
};

// Supports spheres and boxes on a half space, and spheres on spheres; Simbody has no capsule and no box on
// box. Contact is Hertz's with Hunt and Crossley's dissipation.
constexpr Setting kSettings[] = {
    {"Runge-Kutta-Merson; default accuracy 1e-3; 1 MPa", 1e-3, 1e6},
    {"Runge-Kutta-Merson; accuracy 1e-6; 1 MPa", 1e-6, 1e6},
};

SimTK::Vec3 to_simbody(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}
Vector3 from_simbody(const SimTK::Vec3& v) {
  return {v[0], v[1], v[2]};
}

bool has_means_for(const World& world) {
  if (!world.kinematics.empty()) return false;
  std::size_t boxes = 0, fixtures = 0;
  for (const BodySpec& spec : world.bodies) {
    if (spec.fixed) {
      ++fixtures;
    } else if (std::holds_alternative<Box>(spec.shape)) {
      ++boxes;
    }
  }
  return boxes <= 1 && fixtures <= 1;
}

class SimbodyEngine final : public Engine {
 public:
  SimbodyEngine(const Setting& setting, const World& world, double step)
      : step_(step), gravity_(forces_, matter_, to_simbody(world.gravity)) {
    contacts_.setTransitionVelocity(1e-3);
    // Hunt and Crossley: e = 1 - c v, at 1 m/s.
    material_ =
        SimTK::ContactMaterial(setting.stiffness, 1.0 - world.restitution, world.friction, world.friction, 0);
    for (const BodySpec& spec : world.bodies) add(spec);
    SimTK::State state = system_.realizeTopology();
    system_.realizeModel(state);
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
      if (!world.bodies[i].fixed) start(world.bodies[i], bodies_[i], state);
    integrator_.setAccuracy(setting.accuracy);
    integrator_.setFinalTime(1e9);
    stepper_.initialize(state);
  }

  void move(std::size_t, const Pose&, const Pose&) override {}
  void step() override {
    ++steps_;
    stepper_.stepTo(static_cast<double>(steps_) * step_);
  }

  Motion motion(std::size_t index) const override {
    const SimTK::State& state = stepper_.getState();
    const SimTK::MobilizedBody& body = bodies_[index];
    system_.realize(state, SimTK::Stage::Velocity);
    const SimTK::Quaternion q = body.getBodyRotation(state).convertRotationToQuaternion();
    return {
        {from_simbody(body.getBodyOriginLocation(state)), Quaternion(q[0], q[1], q[2], q[3])},
        {from_simbody(body.getBodyOriginVelocity(state)), from_simbody(body.getBodyAngularVelocity(state))}};
  }

 private:
  void add(const BodySpec& spec) {
    if (spec.fixed) {
      // Its upper face, as a half space; Simbody's is on the side of +x.
      const double top = spec.pose.position.z() + std::get<Box>(spec.shape).half_extents.z();
      const SimTK::Rotation down(0.5 * SimTK::Pi, SimTK::YAxis);
      matter_.Ground().updBody().addContactSurface(
          SimTK::Transform(down, SimTK::Vec3(0, 0, top)),
          SimTK::ContactSurface(SimTK::ContactGeometry::HalfSpace(), material_));
      bodies_.push_back(matter_.Ground());
      return;
    }
    SimTK::Body::Rigid body(
        SimTK::MassProperties(spec.mass, SimTK::Vec3(0), SimTK::Inertia(to_simbody(spec.inertia))));
    if (const Box* box = std::get_if<Box>(&spec.shape)) {
      body.addContactSurface(
          SimTK::Transform(),
          SimTK::ContactSurface(SimTK::ContactGeometry::Brick(to_simbody(box->half_extents)), material_,
                                0.1 * box->half_extents.minCoeff()));
    } else {
      const double radius = std::get<Sphere>(spec.shape).radius;
      body.addContactSurface(SimTK::Transform(),
                             SimTK::ContactSurface(SimTK::ContactGeometry::Sphere(radius), material_));
    }
    bodies_.push_back(
        SimTK::MobilizedBody::Free(matter_.Ground(), SimTK::Transform(), body, SimTK::Transform()));
  }

  void start(const BodySpec& spec, const SimTK::MobilizedBody& body, SimTK::State& state) const {
    const Quaternion& q = spec.pose.orientation;
    body.setQToFitTransform(state,
                            SimTK::Transform(SimTK::Rotation(SimTK::Quaternion(q.w(), q.x(), q.y(), q.z())),
                                             to_simbody(spec.pose.position)));
    body.setUToFitVelocity(state,
                           SimTK::SpatialVec(to_simbody(spec.twist.angular), to_simbody(spec.twist.linear)));
  }

  double step_;
  long steps_ = 0;
  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_{system_};
  SimTK::GeneralForceSubsystem forces_{system_};
  SimTK::ContactTrackerSubsystem tracker_{system_};
  SimTK::CompliantContactSubsystem contacts_{system_, tracker_};
  SimTK::Force::UniformGravity gravity_;
  SimTK::ContactMaterial material_;
  std::vector<SimTK::MobilizedBody> bodies_;
  SimTK::RungeKuttaMersonIntegrator integrator_{system_};
  SimTK::TimeStepper stepper_{system_, integrator_};
};

class SimbodyMaker final : public EngineMaker {
 public:
  std::vector<std::string> settings() const override {
    std::vector<std::string> names;
    for (const Setting& setting : kSettings) names.push_back(setting.name);
    return names;
  }
  std::unique_ptr<Engine> make(const std::string& name, const World& world, double step) const override {
    if (!has_means_for(world)) return nullptr;
    for (const Setting& setting : kSettings)
      if (name == setting.name) return std::make_unique<SimbodyEngine>(setting, world, step);
    return nullptr;
  }
};

}  // namespace
}  // namespace mrhi::benchmark

MRHI_ENGINE_MODULE(mrhi::benchmark::SimbodyMaker)
