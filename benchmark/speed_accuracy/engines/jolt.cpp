#include <Jolt/Jolt.h>
// Jolt's main header must come first.
#include <Jolt/Core/Factory.h>
#include <Jolt/Core/JobSystemSingleThreaded.h>
#include <Jolt/Core/TempAllocator.h>
#include <Jolt/Physics/Body/BodyCreationSettings.h>
#include <Jolt/Physics/Body/BodyLock.h>
#include <Jolt/Physics/Collision/BroadPhase/BroadPhaseLayerInterfaceTable.h>
#include <Jolt/Physics/Collision/BroadPhase/ObjectVsBroadPhaseLayerFilterTable.h>
#include <Jolt/Physics/Collision/ObjectLayerPairFilterTable.h>
#include <Jolt/Physics/Collision/Shape/BoxShape.h>
#include <Jolt/Physics/Collision/Shape/CapsuleShape.h>
#include <Jolt/Physics/Collision/Shape/MeshShape.h>
#include <Jolt/Physics/Collision/Shape/SphereShape.h>
#include <Jolt/Physics/Collision/Shape/StaticCompoundShape.h>
#include <Jolt/Physics/Constraints/HingeConstraint.h>
#include <Jolt/Physics/PhysicsSystem.h>
#include <Jolt/RegisterTypes.h>

#include <algorithm>
#include <vector>

#include "../engine.h"

namespace mrhi::benchmark {
namespace {

struct Setting {
  const char* name;
  JPH::uint velocity_steps, position_steps;  // 10 and 2 by default
  float slop;                                // remaining overlap [m], 0.02 by default
  float speculative;                         // distance of speculative contacts [m], 0.02 by default
  bool tuned;  // gyroscopic torque, no damping, no sleep, restitution at any speed, sharp boxes
};

// The default slop, as deep as a fingertip is thick, keeps a grasp at rest: without slop the hand pushes its
// object out. Tried on pinch, slap, plate, stack and squeeze: 4, 10 and 30 velocity steps, slop 0, 0.02, 0.1
// and 20 mm, speculative distances of 2 and 20 mm.
constexpr Setting kSettings[] = {
    {"default", 10, 2, 0.02F, 0.02F, false},
    {"4+1 iterations; no sleep", 4, 1, 0.02F, 0.02F, true},
    {"10+2 iterations; no sleep; speculative 2 mm", 10, 2, 0.02F, 0.002F, true},
    {"10+2 iterations; no sleep; slop 0.1 mm", 10, 2, 0.0001F, 0.02F, true},
};

constexpr JPH::ObjectLayer kFixed = 0, kFree = 1, kHand = 2, kLayers = 3;
constexpr JPH::uint kMaxBodies = 4096, kMaxPairs = 65536, kMaxContacts = 32768;
constexpr std::size_t kScratch = 64 << 20;  // [bytes]

JPH::Vec3 to_jolt(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
JPH::Quat to_jolt(const Quaternion& q) {
  return JPH::Quat(static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()),
                   static_cast<float>(q.w()))
      .Normalized();
}
Vector3 from_jolt(JPH::Vec3Arg v) {
  return {v.GetX(), v.GetY(), v.GetZ()};
}

/// Jolt is started and stopped once per process.
struct Library {
  Library() {
    JPH::RegisterDefaultAllocator();
    JPH::Factory::sInstance = new JPH::Factory;
    JPH::RegisterTypes();
  }
};

/// Collision filter: free bodies collide with everything, the hand and fixtures only with free bodies.
struct Layers {
  Layers() {
    for (JPH::ObjectLayer layer = 0; layer < kLayers; ++layer) {
      pairs.EnableCollision(kFree, layer);
      broad.MapObjectToBroadPhaseLayer(layer, JPH::BroadPhaseLayer(static_cast<JPH::uint8>(layer != kFixed)));
    }
  }
  JPH::ObjectLayerPairFilterTable pairs{kLayers};
  JPH::BroadPhaseLayerInterfaceTable broad{kLayers, 2};
};

class JoltEngine final : public Engine {
 public:
  static constexpr bool kHinges = true, kMeshes = true;
  JoltEngine(const Setting& setting, const World& world, double step)
      : setting_(setting), step_(static_cast<float>(step)), world_(started(world)) {
    system_.Init(kMaxBodies, 0, kMaxPairs, kMaxContacts, layers_.broad, filter_, layers_.pairs);
    system_.SetGravity(to_jolt(world.gravity));
    JPH::PhysicsSettings settings;
    settings.mNumVelocitySteps = setting.velocity_steps;
    settings.mNumPositionSteps = setting.position_steps;
    settings.mPenetrationSlop = setting.slop;
    settings.mSpeculativeContactDistance = setting.speculative;
    if (setting.tuned) settings.mMinVelocityForRestitution = 0.0F;
    system_.SetPhysicsSettings(settings);
    for (const BodySpec& spec : world.bodies) bodies_.push_back(add(spec));
    for (const KinematicSpec& spec : world.kinematics) hand_.push_back(add(spec));
    for (const HingeSpec& spec : world.hinges) add(spec);
    system_.OptimizeBroadPhase();
  }

  void move(std::size_t kinematic, const Pose&, const Pose& next) override {
    bodies().MoveKinematic(hand_[kinematic], to_jolt(next.position), to_jolt(next.orientation), step_);
  }
  void step() override { system_.Update(step_, 1, &scratch_, &jobs_); }

  Motion motion(std::size_t index) const override {
    const JPH::BodyInterface& bodies = system_.GetBodyInterfaceNoLock();
    const JPH::BodyID id = bodies_[index];
    const JPH::Quat q = bodies.GetRotation(id);
    return {{from_jolt(bodies.GetCenterOfMassPosition(id)),
             Quaternion(q.GetW(), q.GetX(), q.GetY(), q.GetZ()).normalized()},
            {from_jolt(bodies.GetLinearVelocity(id)), from_jolt(bodies.GetAngularVelocity(id))}};
  }

 private:
  /// The library must be started before any member of Jolt's types is constructed.
  static const World& started(const World& world) {
    static const Library library;
    return world;
  }
  JPH::BodyInterface& bodies() { return system_.GetBodyInterfaceNoLock(); }

  JPH::BodyID create(JPH::BodyCreationSettings& settings) {
    settings.mFriction = static_cast<float>(world_.friction);
    settings.mRestitution = static_cast<float>(world_.restitution);
    if (setting_.tuned) {
      settings.mApplyGyroscopicForce = true;
      settings.mLinearDamping = settings.mAngularDamping = 0.0F;
    }
    settings.mAllowSleeping = world_.sleep && !setting_.tuned;
    return bodies().CreateAndAddBody(settings, JPH::EActivation::Activate);
  }

  static JPH::ShapeRefC shape_of(const TriangleMesh& mesh) {
    JPH::VertexList vertices;
    for (const Vector3& vertex : mesh.vertices) {
      const JPH::Vec3 v = to_jolt(vertex);
      vertices.push_back({v.GetX(), v.GetY(), v.GetZ()});
    }
    JPH::IndexedTriangleList triangles;
    for (const auto& corners : mesh.triangles) {
      const auto corner = [&](std::size_t i) { return static_cast<JPH::uint32>(corners[i]); };
      triangles.push_back({corner(0), corner(1), corner(2), 0});
    }
    JPH::MeshShapeSettings settings(vertices, triangles);
    settings.SetEmbedded();
    return settings.Create().Get();
  }

  JPH::BodyID add(const BodySpec& spec) {
    JPH::ShapeRefC shape;
    if (const Mesh* mesh = std::get_if<Mesh>(&spec.shape)) {
      shape = shape_of(*mesh->triangles);
    } else if (const Box* box = std::get_if<Box>(&spec.shape)) {
      const auto thinnest = static_cast<float>(box->half_extents.minCoeff());
      shape = new JPH::BoxShape(to_jolt(box->half_extents),
                                setting_.tuned ? 0.0F : std::min(JPH::cDefaultConvexRadius, thinnest));
    } else {
      shape = new JPH::SphereShape(static_cast<float>(std::get<Sphere>(spec.shape).radius));
    }
    JPH::BodyCreationSettings settings(shape, to_jolt(spec.pose.position), to_jolt(spec.pose.orientation),
                                       spec.fixed ? JPH::EMotionType::Static : JPH::EMotionType::Dynamic,
                                       spec.fixed ? kFixed : kFree);
    settings.mLinearVelocity = to_jolt(spec.twist.linear);
    settings.mAngularVelocity = to_jolt(spec.twist.angular);
    if (!spec.fixed) {
      settings.mOverrideMassProperties = JPH::EOverrideMassProperties::MassAndInertiaProvided;
      settings.mMassPropertiesOverride.mMass = static_cast<float>(spec.mass);
      settings.mMassPropertiesOverride.mInertia = JPH::Mat44::sScale(to_jolt(spec.inertia));
    }
    return create(settings);
  }

  JPH::BodyID add(const KinematicSpec& spec) {
    JPH::StaticCompoundShapeSettings compound;
    for (const Capsule& capsule : spec.capsules) {
      const Vector3 axis = capsule.end - capsule.start;
      compound.AddShape(
          to_jolt(capsule.centre()), to_jolt(Quaternion::FromTwoVectors(Vector3::UnitY(), axis)),
          new JPH::CapsuleShape(static_cast<float>(0.5 * axis.norm()), static_cast<float>(capsule.radius)));
    }
    compound.SetEmbedded();
    JPH::BodyCreationSettings settings(compound.Create().Get(), to_jolt(spec.pose.position),
                                       to_jolt(spec.pose.orientation), JPH::EMotionType::Kinematic, kHand);
    return create(settings);
  }

  void add(const HingeSpec& spec) {
    JPH::HingeConstraintSettings settings;
    settings.mPoint1 = settings.mPoint2 = to_jolt(spec.anchor);
    settings.mHingeAxis1 = settings.mHingeAxis2 = to_jolt(spec.axis);
    settings.mNormalAxis1 = settings.mNormalAxis2 = to_jolt(spec.axis).GetNormalizedPerpendicular();
    settings.mMaxFrictionTorque = static_cast<float>(spec.friction);
    const JPH::BodyLockWrite lock(system_.GetBodyLockInterfaceNoLock(), bodies_[spec.body]);
    system_.AddConstraint(settings.Create(JPH::Body::sFixedToWorld, lock.GetBody()));
  }

  Setting setting_;
  float step_;
  const World& world_;
  Layers layers_;
  JPH::ObjectVsBroadPhaseLayerFilterTable filter_{layers_.broad, 2, layers_.pairs, kLayers};
  JPH::TempAllocatorImpl scratch_{kScratch};
  JPH::JobSystemSingleThreaded jobs_{JPH::cMaxPhysicsJobs};
  JPH::PhysicsSystem system_;
  std::vector<JPH::BodyID> bodies_, hand_;
};

using JoltMaker = TableMaker<JoltEngine, kSettings>;

}  // namespace
}  // namespace mrhi::benchmark

MRHI_ENGINE_MODULE(mrhi::benchmark::JoltMaker)
