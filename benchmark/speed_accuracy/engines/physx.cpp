#include <PxPhysicsAPI.h>

#include <memory>
#include <stdexcept>
#include <vector>

#include "../engine.h"

namespace mrhi::benchmark {
namespace {

struct Setting {
  const char* name;
  physx::PxSolverType::Enum solver;             // PGS by default
  physx::PxU32 position_steps, velocity_steps;  // 4 and 1 by default
  float length;  // of objects [m]: scales contact offset and thresholds, 1 by default
  bool tuned;    // gyroscopic torque, no damping, no sleep, restitution at any speed, friction in every
                 // iteration
};

// Tried on pinch, slap, plate, sliding, bouncing, stack, squeeze and catch: both solvers with 1 to 16
// position and 0 to 4 velocity iterations, and objects of 5 cm and 1 m.
constexpr Setting kSettings[] = {
    {"default", physx::PxSolverType::ePGS, 4, 1, 1.0F, false},
    {"PGS 16+4 iterations; no sleep; objects of 5 cm", physx::PxSolverType::ePGS, 16, 4, 0.05F, true},
    {"TGS 4+1 iterations; no sleep", physx::PxSolverType::eTGS, 4, 1, 1.0F, true},
    {"TGS 4+1 iterations; no sleep; objects of 5 cm", physx::PxSolverType::eTGS, 4, 1, 0.05F, true},
    {"TGS 16+4 iterations; no sleep; objects of 5 cm", physx::PxSolverType::eTGS, 16, 4, 0.05F, true},
};

physx::PxVec3 to_physx(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
physx::PxQuat to_physx(const Quaternion& q) {
  return physx::PxQuat(static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
                       static_cast<float>(q.w()))
      .getNormalized();
}
physx::PxTransform to_physx(const Pose& pose) {
  return {to_physx(pose.position), to_physx(pose.orientation)};
}
Vector3 from_physx(const physx::PxVec3& v) {
  return {v.x, v.y, v.z};
}

/// PhysX has one foundation per process.
physx::PxFoundation& foundation() {
  static physx::PxDefaultAllocator allocator;
  static physx::PxDefaultErrorCallback errors;
  static physx::PxFoundation* const it = PxCreateFoundation(PX_PHYSICS_VERSION, allocator, errors);
  if (it == nullptr) throw std::runtime_error("PhysX does not start");
  return *it;
}

struct Release {
  template <typename Part>
  void operator()(Part* part) const {
    part->release();
  }
};
template <typename Part>
using Owned = std::unique_ptr<Part, Release>;

class PhysxEngine final : public Engine {
 public:
  static constexpr bool kHinges = true;
  PhysxEngine(const Setting& setting, const World& world, double step)
      : setting_(setting), step_(static_cast<float>(step)), sleep_(world.sleep && !setting.tuned) {
    const physx::PxTolerancesScale scale(setting.length, physx::PxTolerancesScale().speed);
    physics_.reset(PxCreatePhysics(PX_PHYSICS_VERSION, foundation(), scale));
    dispatcher_.reset(physx::PxDefaultCpuDispatcherCreate(0));  // in the thread that calls
    physx::PxSceneDesc description(scale);
    description.gravity = to_physx(world.gravity);
    description.cpuDispatcher = dispatcher_.get();
    description.filterShader = physx::PxDefaultSimulationFilterShader;
    description.solverType = setting.solver;
    if (setting.tuned) {
      description.bounceThresholdVelocity = 1e-3F;  // [m/s], which must be positive
      description.flags |= physx::PxSceneFlag::eENABLE_FRICTION_EVERY_ITERATION;
    }
    scene_.reset(physics_->createScene(description));
    if (!scene_) throw std::runtime_error("PhysX takes no such scene");
    const auto friction = static_cast<float>(world.friction);
    material_ = physics_->createMaterial(friction, friction, static_cast<float>(world.restitution));
    for (const BodySpec& spec : world.bodies) bodies_.push_back(add(spec));
    for (const KinematicSpec& spec : world.kinematics) hand_.push_back(add(spec));
    for (const HingeSpec& spec : world.hinges) add(spec, world.bodies[spec.body].pose);
  }

  void move(std::size_t kinematic, const Pose&, const Pose& next) override {
    hand_[kinematic]->setKinematicTarget(to_physx(next));
  }
  void step() override {
    scene_->simulate(step_);
    scene_->fetchResults(true);
  }

  Motion motion(std::size_t index) const override {
    const physx::PxRigidActor& body = *bodies_[index];
    const physx::PxTransform pose = body.getGlobalPose();
    const Pose place{from_physx(pose.p), Quaternion(pose.q.w, pose.q.x, pose.q.y, pose.q.z).normalized()};
    const auto* moving = body.is<physx::PxRigidDynamic>();
    if (moving == nullptr) return {place, {}};
    return {place, {from_physx(moving->getLinearVelocity()), from_physx(moving->getAngularVelocity())}};
  }

 private:
  physx::PxRigidActor* add(const BodySpec& spec) {
    const physx::PxTransform pose = to_physx(spec.pose);
    if (spec.fixed) {
      physx::PxRigidActor* body = physics_->createRigidStatic(pose);
      shape(*body, spec);
      scene_->addActor(*body);
      return body;
    }
    physx::PxRigidDynamic* body = physics_->createRigidDynamic(pose);
    shape(*body, spec);
    body->setMass(static_cast<float>(spec.mass));
    body->setMassSpaceInertiaTensor(to_physx(spec.inertia));
    body->setLinearVelocity(to_physx(spec.twist.linear));
    body->setAngularVelocity(to_physx(spec.twist.angular));
    body->setSolverIterationCounts(setting_.position_steps, setting_.velocity_steps);
    if (setting_.tuned) {
      body->setAngularDamping(0.0F);
      body->setRigidBodyFlag(physx::PxRigidBodyFlag::eENABLE_GYROSCOPIC_FORCES, true);
    }
    if (!sleep_) body->setSleepThreshold(0.0F);
    scene_->addActor(*body);
    return body;
  }

  void shape(physx::PxRigidActor& body, const BodySpec& spec) {
    if (const Box* box = std::get_if<Box>(&spec.shape)) {
      physx::PxRigidActorExt::createExclusiveShape(body, physx::PxBoxGeometry(to_physx(box->half_extents)),
                                                   *material_);
    } else {
      const auto radius = static_cast<float>(std::get<Sphere>(spec.shape).radius);
      physx::PxRigidActorExt::createExclusiveShape(body, physx::PxSphereGeometry(radius), *material_);
    }
  }

  physx::PxRigidDynamic* add(const KinematicSpec& spec) {
    physx::PxRigidDynamic* body = physics_->createRigidDynamic(to_physx(spec.pose));
    body->setRigidBodyFlag(physx::PxRigidBodyFlag::eKINEMATIC, true);
    for (const Capsule& capsule : spec.capsules) {
      const Vector3 axis = capsule.end - capsule.start;
      const physx::PxCapsuleGeometry geometry(static_cast<float>(capsule.radius),
                                              static_cast<float>(0.5 * axis.norm()));
      physx::PxRigidActorExt::createExclusiveShape(*body, geometry, *material_)
          ->setLocalPose(
              to_physx(Pose{capsule.centre(), Quaternion::FromTwoVectors(Vector3::UnitX(), axis)}));
    }
    scene_->addActor(*body);
    return body;
  }

  /// Friction is a drive with target speed zero. PhysX's hinge is along x.
  void add(const HingeSpec& spec, const Pose& pose) {
    const Pose frame{spec.anchor, Quaternion::FromTwoVectors(Vector3::UnitX(), spec.axis)};
    physx::PxRevoluteJoint* joint = PxRevoluteJointCreate(
        *physics_, nullptr, to_physx(frame), bodies_[spec.body], to_physx(pose.inverse() * frame));
    if (spec.friction <= 0.0) return;
    joint->setRevoluteJointFlag(physx::PxRevoluteJointFlag::eDRIVE_ENABLED, true);
    joint->setDriveVelocity(0.0F);
    joint->setDriveForceLimit(static_cast<float>(spec.friction));
  }

  Setting setting_;
  float step_;
  bool sleep_;
  Owned<physx::PxPhysics> physics_;
  Owned<physx::PxDefaultCpuDispatcher> dispatcher_;
  Owned<physx::PxScene> scene_;
  physx::PxMaterial* material_ = nullptr;  // of physics_, as are the bodies
  std::vector<physx::PxRigidActor*> bodies_;
  std::vector<physx::PxRigidDynamic*> hand_;
};

using PhysxMaker = TableMaker<PhysxEngine, kSettings>;

}  // namespace
}  // namespace mrhi::benchmark

MRHI_ENGINE_MODULE(mrhi::benchmark::PhysxMaker)
