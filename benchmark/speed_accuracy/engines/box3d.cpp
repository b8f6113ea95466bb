#include <box3d/box3d.h>

#include <cmath>
#include <vector>

#include "../engine.h"

namespace mrhi::benchmark {
namespace {

struct Setting {
  const char* name;
  float unit;            // length unit of its tolerances [m]
  int substeps;          // 4 by default
  float hertz;           // of contacts, 30 by default
  bool restitution_low;  // restitution at any speed; false: only above one unit per second
};

// Its tolerances are for people and cars: half a centimetre of overlap is allowed. A smaller length unit is
// its documented means for small objects (b3SetLengthUnitsPerMeter). Tried on pinch, slap, plate, stack and
// squeeze: units of 5 cm and 1 m; 1, 4 and 8 substeps; contacts of 10, 30, 240 and 1000 Hz.
constexpr Setting kSettings[] = {
    {"default", 1.0F, 4, 30.0F, false},
    {"unit 5 cm; 1 substep", 0.05F, 1, 30.0F, true},
    {"unit 5 cm; 1 substep; contacts 240 Hz", 0.05F, 1, 240.0F, true},
    {"unit 5 cm; 8 substeps; contacts 240 Hz", 0.05F, 8, 240.0F, true},
};

b3Vec3 to_box3d(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
b3Quat to_box3d(const Quaternion& q) {
  return {to_box3d(Vector3(q.vec())), static_cast<float>(q.w())};
}
Vector3 from_box3d(const b3Vec3& v) {
  return {v.x, v.y, v.z};
}

class Box3dEngine final : public Engine {
 public:
  Box3dEngine(const Setting& setting, const World& world, double step)
      : substeps_(setting.substeps), step_(static_cast<float>(step)) {
    b3SetLengthUnitsPerMeter(setting.unit);
    b3WorldDef def = b3DefaultWorldDef();
    def.gravity = to_box3d(world.gravity);
    def.workerCount = 1;
    def.enableSleep = world.sleep;
    def.contactHertz = setting.hertz;
    if (setting.restitution_low) def.restitutionThreshold = 0.0F;
    world_ = b3CreateWorld(&def);
    surface_ = b3DefaultShapeDef();
    surface_.baseMaterial.friction = static_cast<float>(world.friction);
    surface_.baseMaterial.restitution = static_cast<float>(world.restitution);
    for (const BodySpec& spec : world.bodies) add(spec);
    for (const KinematicSpec& spec : world.kinematics) add(spec);
  }
  ~Box3dEngine() override { b3DestroyWorld(world_); }

  void move(std::size_t kinematic, const Pose&, const Pose& next) override {
    b3Body_SetTargetTransform(hand_[kinematic], {to_box3d(next.position), to_box3d(next.orientation)}, step_,
                              true);
  }
  void step() override { b3World_Step(world_, step_, substeps_); }

  Motion motion(std::size_t index) const override {
    const b3BodyId body = bodies_[index];
    const b3Quat q = b3Body_GetRotation(body);
    return {{from_box3d(b3Body_GetPosition(body)), Quaternion(q.s, q.v.x, q.v.y, q.v.z).normalized()},
            {from_box3d(b3Body_GetLinearVelocity(body)), from_box3d(b3Body_GetAngularVelocity(body))}};
  }

  double pressing(std::size_t kinematic) const override {
    const b3BodyId body = hand_[kinematic];
    std::vector<b3ContactData> contacts(static_cast<std::size_t>(b3Body_GetContactCapacity(body)));
    const int count = b3Body_GetContactData(body, contacts.data(), static_cast<int>(contacts.size()));
    double impulse = 0.0;
    for (int i = 0; i < count; ++i) {
      const b3ContactData& contact = contacts[static_cast<std::size_t>(i)];
      for (int m = 0; m < contact.manifoldCount; ++m) impulse += impulse_of(contact.manifolds[m]);
    }
    return impulse / step_;
  }

 private:
  static double impulse_of(const b3Manifold& manifold) {
    double normal = 0.0;
    for (int p = 0; p < manifold.pointCount; ++p) normal += manifold.points[p].totalNormalImpulse;
    return std::hypot(normal, from_box3d(manifold.frictionImpulse).norm());
  }

  b3BodyId create(b3BodyType type, const Pose& pose, const Twist& twist = {}) const {
    b3BodyDef def = b3DefaultBodyDef();
    def.type = type;
    def.position = to_box3d(pose.position);
    def.rotation = to_box3d(pose.orientation);
    def.linearVelocity = to_box3d(twist.linear);
    def.angularVelocity = to_box3d(twist.angular);
    return b3CreateBody(world_, &def);
  }

  void add(const BodySpec& spec) {
    const b3BodyId body = create(spec.fixed ? b3_staticBody : b3_dynamicBody, spec.pose, spec.twist);
    bodies_.push_back(body);
    if (const Box* box = std::get_if<Box>(&spec.shape)) {
      const b3Vec3 half = to_box3d(box->half_extents);
      const b3BoxHull hull = b3MakeBoxHull(half.x, half.y, half.z);
      b3CreateHullShape(body, &surface_, &hull.base);
    } else {
      const b3Sphere sphere{{0, 0, 0}, static_cast<float>(std::get<Sphere>(spec.shape).radius)};
      b3CreateSphereShape(body, &surface_, &sphere);
    }
    if (spec.fixed) return;
    const b3Vec3 moments = to_box3d(spec.inertia);
    b3Body_SetMassData(body, {static_cast<float>(spec.mass),
                              {0, 0, 0},
                              {{moments.x, 0, 0}, {0, moments.y, 0}, {0, 0, moments.z}}});
  }

  void add(const KinematicSpec& spec) {
    const b3BodyId body = create(b3_kinematicBody, spec.pose);
    hand_.push_back(body);
    for (const Capsule& part : spec.capsules) {
      const b3Capsule capsule{to_box3d(part.start), to_box3d(part.end), static_cast<float>(part.radius)};
      b3CreateCapsuleShape(body, &surface_, &capsule);
    }
  }

  int substeps_;
  float step_;
  b3WorldId world_;
  b3ShapeDef surface_;
  std::vector<b3BodyId> bodies_, hand_;
};

using Box3dMaker = TableMaker<Box3dEngine, kSettings>;

}  // namespace
}  // namespace mrhi::benchmark

MRHI_ENGINE_MODULE(mrhi::benchmark::Box3dMaker)
