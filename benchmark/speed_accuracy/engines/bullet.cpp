// Built twice, with Bullet in single and in double precision, which must not share a process.
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <memory>

#include "../engine.h"

namespace mrhi::benchmark {
namespace {

struct Setting {
  const char* name;
  bool awake;        // bodies never fall asleep
  bool split;        // split impulse at any depth (Bullet's default begins at 40 mm)
  int iterations;    // of the solver, 10 by default
  double stiffness;  // of the hand's surface [N/m], 0: rigid
  double damping;    // of the hand's surface [N s/m]
};

// "soft contact": Bullet's contact stiffness and damping, the best on pinch, catch and squeeze of 500, 2000
// and 10000 N/m with 1, 10 and 50 N s/m, each with 10 and 50 iterations. "split impulse": the best for slaps
// and plates, with restitution at any speed.
constexpr Setting kSettings[] = {
    {"default", false, false, 10, 0.0, 0.0},
    {"soft contact 500 N/m 10 N s/m; no sleeping", true, false, 10, 500.0, 10.0},
    {"soft contact 500 N/m 10 N s/m; no sleeping; 50 iterations", true, false, 50, 500.0, 10.0},
    {"split impulse at any depth; no sleeping; 50 iterations; restitution at any speed", true, true, 50, 0.0,
     0.0},
};

btVector3 to_bullet(const Vector3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
btTransform to_bullet(const Pose& pose) {
  const Quaternion& q = pose.orientation;
  return btTransform(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                  static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w())),
                     to_bullet(pose.position));
}
Vector3 from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

class BulletEngine final : public Engine {
 public:
  static constexpr bool kHinges = true, kMeshes = true;
  BulletEngine(const Setting& setting, const World& world, double step)
      : awake_(setting.awake || !world.sleep), setting_(setting), step_(static_cast<btScalar>(step)) {
    // Bullet multiplies the coefficients of the two surfaces.
    friction_ = static_cast<btScalar>(std::sqrt(world.friction));
    restitution_ = static_cast<btScalar>(std::sqrt(world.restitution));
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
    world_.setGravity(to_bullet(world.gravity));
    world_.getSolverInfo().m_numIterations = setting.iterations;
    if (setting.split) {
      world_.getSolverInfo().m_splitImpulsePenetrationThreshold = 0;
      world_.getSolverInfo().m_restitutionVelocityThreshold = 0;
    }
    for (const BodySpec& spec : world.bodies) bodies_.push_back(&add(spec));
    for (const KinematicSpec& spec : world.kinematics) hand_.push_back(&add(spec));
    for (const HingeSpec& spec : world.hinges) add(spec, world.bodies[spec.body].pose);
  }
  ~BulletEngine() override {
    for (const auto& hinge : hinges_) world_.removeConstraint(hinge.get());
    for (const auto& body : all_) world_.removeRigidBody(body.get());
  }

  void move(std::size_t kinematic, const Pose&, const Pose& next) override {
    // Bullet derives a kinematic body's velocity from its motion state.
    hand_[kinematic]->getMotionState()->setWorldTransform(to_bullet(next));
  }
  void step() override { world_.stepSimulation(step_, 0); }

  Motion motion(std::size_t index) const override {
    const btRigidBody& body = *bodies_[index];
    const btTransform& place = body.getWorldTransform();
    const btQuaternion q = place.getRotation();
    return {{from_bullet(place.getOrigin()), Quaternion(q.w(), q.x(), q.y(), q.z()).normalized()},
            {from_bullet(body.getLinearVelocity()), from_bullet(body.getAngularVelocity())}};
  }

  double pressing(std::size_t kinematic) const override {
    double impulse = 0.0;
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(i);
      if (manifold.getBody0() != hand_[kinematic] && manifold.getBody1() != hand_[kinematic]) continue;
      for (int p = 0; p < manifold.getNumContacts(); ++p) {
        const btManifoldPoint& point = manifold.getContactPoint(p);
        impulse += std::hypot(point.m_appliedImpulse, point.m_appliedImpulseLateral1,
                              point.m_appliedImpulseLateral2);
      }
    }
    return impulse / step_;
  }

 private:
  /// Bullet keeps a reference to the triangles.
  std::unique_ptr<btCollisionShape> mesh_of(const TriangleMesh& mesh) {
    meshes_.push_back(std::make_unique<btTriangleMesh>());
    for (const auto& triangle : mesh.triangles) {
      const auto corner = [&](int i) {
        return to_bullet(mesh.vertices[static_cast<std::size_t>(triangle[static_cast<std::size_t>(i)])]);
      };
      meshes_.back()->addTriangle(corner(0), corner(1), corner(2));
    }
    auto shape = std::make_unique<btGImpactMeshShape>(meshes_.back().get());
    shape->updateBound();
    return shape;
  }

  btRigidBody& add(const BodySpec& spec) {
    if (const Mesh* mesh = std::get_if<Mesh>(&spec.shape)) {
      shapes_.push_back(mesh_of(*mesh->triangles));
    } else if (const Box* box = std::get_if<Box>(&spec.shape)) {
      shapes_.push_back(std::make_unique<btBoxShape>(to_bullet(box->half_extents)));
    } else {
      shapes_.push_back(
          std::make_unique<btSphereShape>(static_cast<btScalar>(std::get<Sphere>(spec.shape).radius)));
    }
    const btScalar mass = spec.fixed ? btScalar(0) : static_cast<btScalar>(spec.mass);
    btRigidBody& body = add(mass, *shapes_.back(), to_bullet(spec.inertia), spec.pose);
    if (spec.fixed) {
      world_.addRigidBody(&body);
      return body;
    }
    body.setLinearVelocity(to_bullet(spec.twist.linear));
    body.setAngularVelocity(to_bullet(spec.twist.angular));
    if (awake_) body.setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(&body);
    return body;
  }

  btRigidBody& add(const KinematicSpec& spec) {
    auto compound = std::make_unique<btCompoundShape>();
    for (const Capsule& capsule : spec.capsules) {
      const Vector3 axis = capsule.end - capsule.start;
      shapes_.push_back(std::make_unique<btCapsuleShapeZ>(static_cast<btScalar>(capsule.radius),
                                                          static_cast<btScalar>(axis.norm())));
      const Pose place{capsule.centre(), Quaternion::FromTwoVectors(Vector3::UnitZ(), axis)};
      compound->addChildShape(to_bullet(place), shapes_.back().get());
    }
    shapes_.push_back(std::move(compound));
    btRigidBody& body = add(0, *shapes_.back(), btVector3(0, 0, 0), spec.pose);
    body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    body.setActivationState(DISABLE_DEACTIVATION);
    if (setting_.stiffness > 0.0) {
      body.setContactStiffnessAndDamping(static_cast<btScalar>(setting_.stiffness),
                                         static_cast<btScalar>(setting_.damping));
    }
    world_.addRigidBody(&body, btBroadphaseProxy::KinematicFilter, btBroadphaseProxy::DefaultFilter);
    return body;
  }

  /// Friction is a motor with target speed zero.
  void add(const HingeSpec& spec, const Pose& pose) {
    hinges_.push_back(
        std::make_unique<btHingeConstraint>(*bodies_[spec.body], to_bullet(pose.to_local(spec.anchor)),
                                            to_bullet(Vector3(pose.orientation.conjugate() * spec.axis))));
    if (spec.friction > 0.0)
      hinges_.back()->enableAngularMotor(true, 0, static_cast<btScalar>(spec.friction) * step_);
    world_.addConstraint(hinges_.back().get());
  }

  btRigidBody& add(btScalar mass, btCollisionShape& shape, const btVector3& inertia, const Pose& pose) {
    states_.push_back(std::make_unique<btDefaultMotionState>(to_bullet(pose)));
    btRigidBody::btRigidBodyConstructionInfo info(mass, states_.back().get(), &shape, inertia);
    info.m_friction = friction_;
    info.m_restitution = restitution_;
    all_.push_back(std::make_unique<btRigidBody>(info));
    return *all_.back();
  }

  bool awake_;
  Setting setting_;
  btScalar step_, friction_, restitution_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broad_phase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btTriangleMesh>> meshes_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btMotionState>> states_;
  std::vector<std::unique_ptr<btRigidBody>> all_;
  std::vector<btRigidBody*> bodies_, hand_;
  std::vector<std::unique_ptr<btHingeConstraint>> hinges_;
};

using BulletMaker = TableMaker<BulletEngine, kSettings>;

}  // namespace
}  // namespace mrhi::benchmark

MRHI_ENGINE_MODULE(mrhi::benchmark::BulletMaker)
