#include <cmath>
#include <dart/collision/bullet/bullet.hpp>
#include <dart/dart.hpp>

#include "../engine.h"

namespace mrhi::benchmark {
namespace {

namespace dyn = dart::dynamics;

struct Setting {
  const char* name;
  bool pgs;
  double error_reduction;     // fraction of the overlap corrected per step, 0.01 by default
  double reduction_velocity;  // its maximum [m/s], 1e-3 by default
  double force_mixing;        // 1e-5 by default
};

// All use the Bullet collision back end: FCL's replaces capsules by spheres. The last two are the best on
// pinch, catch and squeeze of 36 combinations of these three and the solver.
constexpr Setting kSettings[] = {
    {"Bullet collision; Dantzig; default", false, 0.01, 1e-3, 1e-5},
    {"Bullet collision; PGS; force mixing 0.001", true, 0.01, 1e-3, 1e-3},
    {"Bullet collision; Dantzig; error reduction 0.2 up to 0.1 m/s; force mixing 0.01", false, 0.2, 0.1,
     1e-2},
};

Eigen::Isometry3d to_dart(const Pose& pose) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = pose.orientation.toRotationMatrix();
  result.translation() = pose.position;
  return result;
}

class DartEngine final : public Engine {
 public:
  DartEngine(const Setting& setting, const World& world, double step)
      : step_(step), friction_(world.friction), restitution_(std::sqrt(world.restitution)) {
    using dart::constraint::ContactConstraint;
    ContactConstraint::setErrorReductionParameter(setting.error_reduction);
    ContactConstraint::setMaxErrorReductionVelocity(setting.reduction_velocity);
    ContactConstraint::setConstraintForceMixing(setting.force_mixing);
    world_ = dart::simulation::World::create();
    world_->setTimeStep(step);
    world_->setGravity(world.gravity);
    auto solver = std::make_unique<dart::constraint::BoxedLcpConstraintSolver>();
    if (setting.pgs) {
      solver->setBoxedLcpSolver(std::make_shared<dart::constraint::PgsBoxedLcpSolver>());
      solver->setSecondaryBoxedLcpSolver(nullptr);
    }
    world_->setConstraintSolver(std::move(solver));
    world_->getConstraintSolver()->setCollisionDetector(dart::collision::BulletCollisionDetector::create());
    // DART's limit of 1000 contacts would let a large scene fall through the floor.
    world_->getConstraintSolver()->getCollisionOption().maxNumContacts = 1000 + 16 * world.bodies.size();
    for (const BodySpec& spec : world.bodies) add(spec);
    for (const KinematicSpec& spec : world.kinematics) add(spec);
  }

  void move(std::size_t kinematic, const Pose& now, const Pose& next) override {
    dyn::FreeJoint* joint = hand_[kinematic];
    joint->setTransform(to_dart(now));
    const Twist twist = twist_between(now, next, step_);
    joint->setLinearVelocity(twist.linear);
    joint->setAngularVelocity(twist.angular);
  }
  void step() override { world_->step(); }

  Motion motion(std::size_t index) const override {
    const dyn::BodyNode* body = bodies_[index];
    const Eigen::Isometry3d& place = body->getTransform();
    return {{place.translation(), Quaternion(place.linear())},
            {body->getCOMLinearVelocity(), body->getAngularVelocity()}};
  }

 private:
  void add_shape(dyn::BodyNode* body, const dyn::ShapePtr& shape, const Pose& pose) {
    auto* node = body->createShapeNodeWith<dyn::CollisionAspect, dyn::DynamicsAspect>(shape);
    node->setRelativeTransform(to_dart(pose));
    node->getDynamicsAspect()->setFrictionCoeff(friction_);
    node->getDynamicsAspect()->setRestitutionCoeff(restitution_);
  }

  void add(const BodySpec& spec) {
    const auto skeleton = dyn::Skeleton::create("body_" + std::to_string(bodies_.size()));
    const auto pair = skeleton->createJointAndBodyNodePair<dyn::FreeJoint>();
    if (const Box* box = std::get_if<Box>(&spec.shape)) {
      add_shape(pair.second, std::make_shared<dyn::BoxShape>(2.0 * box->half_extents), {});
    } else {
      add_shape(pair.second, std::make_shared<dyn::SphereShape>(std::get<Sphere>(spec.shape).radius), {});
    }
    pair.second->setInertia(dyn::Inertia(spec.mass, Vector3::Zero(), spec.inertia.asDiagonal()));
    pair.first->setTransform(to_dart(spec.pose));
    pair.first->setLinearVelocity(spec.twist.linear);
    pair.first->setAngularVelocity(spec.twist.angular);
    skeleton->setMobile(!spec.fixed);
    world_->addSkeleton(skeleton);
    bodies_.push_back(pair.second);
  }

  /// A skeleton that is not mobile only moves as set here; contacts see its velocity.
  void add(const KinematicSpec& spec) {
    const auto skeleton = dyn::Skeleton::create("hand_" + std::to_string(hand_.size()));
    const auto pair = skeleton->createJointAndBodyNodePair<dyn::FreeJoint>();
    for (const Capsule& capsule : spec.capsules) {
      const Vector3 axis = capsule.end - capsule.start;
      add_shape(pair.second, std::make_shared<dyn::CapsuleShape>(capsule.radius, axis.norm()),
                {capsule.centre(), Quaternion::FromTwoVectors(Vector3::UnitZ(), axis)});
    }
    pair.first->setTransform(to_dart(spec.pose));
    skeleton->setMobile(false);
    world_->addSkeleton(skeleton);
    hand_.push_back(pair.first);
  }

  double step_, friction_, restitution_;
  dart::simulation::WorldPtr world_;
  std::vector<dyn::BodyNode*> bodies_;
  std::vector<dyn::FreeJoint*> hand_;
};

using DartMaker = TableMaker<DartEngine, kSettings>;

}  // namespace
}  // namespace mrhi::benchmark

MRHI_ENGINE_MODULE(mrhi::benchmark::DartMaker)
