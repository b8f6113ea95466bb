#include <ode/ode.h>

#include <array>
#include <cmath>
#include <deque>

#include "../engine.h"

namespace mrhi::benchmark {
namespace {

struct Setting {
  const char* name;
  bool dantzig;      // dWorldStep; false: dWorldQuickStep
  int iterations;    // of QuickStep, 20 by default
  double stiffness;  // of contacts [N/m], 0: rigid with ODE's own error reduction
  double damping;    // [N s/m]
  bool aligned;      // the friction pyramid has an edge along the sliding direction
};

// Coulomb friction (dContactApprox1) throughout: ODE's default takes mu as a force in newtons. Soft: the best
// on pinch, creep and catch of 1000 to 50000 N/m with 3 to 150 N s/m; none is best at every step.
constexpr Setting kSettings[] = {
    {"QuickStep default; Coulomb pyramid", false, 20, 0.0, 0.0, false},
    {"Dantzig default; Coulomb pyramid", true, 0, 0.0, 0.0, false},
    {"Dantzig; Coulomb pyramid along the sliding", true, 0, 0.0, 0.0, true},
    {"Dantzig; soft contact 2000 N/m 10 N s/m", true, 0, 2000.0, 10.0, false},
    {"Dantzig; soft contact 10000 N/m 3 N s/m", true, 0, 10000.0, 3.0, false},
    {"Dantzig; soft contact 50000 N/m 10 N s/m", true, 0, 50000.0, 10.0, false},
    {"QuickStep 100 iterations; soft contact 2000 N/m 10 N s/m", false, 100, 2000.0, 10.0, false},
};

constexpr int kMaxContacts = 16;  // of one pair

Vector3 from_ode(const dReal* v) {
  return {v[0], v[1], v[2]};
}

/// ODE is started and stopped once per process.
struct Library {
  Library() { dInitODE2(0); }
  ~Library() { dCloseODE(); }
};

class OdeEngine final : public Engine {
 public:
  static constexpr bool kHinges = true, kMeshes = true;
  OdeEngine(const Setting& setting, const World& world, double step)
      : setting_(setting), step_(step), friction_(world.friction), restitution_(world.restitution) {
    static const Library library;
    world_ = dWorldCreate();
    space_ = dHashSpaceCreate(nullptr);
    contacts_ = dJointGroupCreate(0);
    dWorldSetGravity(world_, world.gravity.x(), world.gravity.y(), world.gravity.z());
    if (!setting.dantzig) dWorldSetQuickStepNumIterations(world_, setting.iterations);
    for (const BodySpec& spec : world.bodies) add(spec);
    for (const KinematicSpec& spec : world.kinematics) add(spec);
    for (const HingeSpec& spec : world.hinges) add(spec);
  }
  ~OdeEngine() override {
    dJointGroupDestroy(contacts_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
    for (const MeshData& data : meshes_) dGeomTriMeshDataDestroy(data.id);
  }

  void move(std::size_t kinematic, const Pose& now, const Pose& next) override {
    const dBodyID body = hand_[kinematic];
    place(body, now);
    const Twist twist = twist_between(now, next, step_);
    dBodySetLinearVel(body, twist.linear.x(), twist.linear.y(), twist.linear.z());
    dBodySetAngularVel(body, twist.angular.x(), twist.angular.y(), twist.angular.z());
  }

  void step() override {
    dJointGroupEmpty(contacts_);
    feedback_.clear();
    dSpaceCollide(space_, this,
                  [](void* self, dGeomID a, dGeomID b) { static_cast<OdeEngine*>(self)->collide(a, b); });
    if (setting_.dantzig) {
      dWorldStep(world_, step_);
    } else {
      dWorldQuickStep(world_, step_);
    }
  }

  Motion motion(std::size_t index) const override {
    const dBodyID body = bodies_[index];
    if (body == nullptr) return {};
    const dReal* q = dBodyGetQuaternion(body);
    return {{from_ode(dBodyGetPosition(body)), Quaternion(q[0], q[1], q[2], q[3])},
            {from_ode(dBodyGetLinearVel(body)), from_ode(dBodyGetAngularVel(body))}};
  }

  void watch_forces() override { watched_ = true; }
  double pressing(std::size_t kinematic) const override {
    double force = 0.0;
    for (const Feedback& contact : feedback_)
      if (contact.first == hand_[kinematic] || contact.second == hand_[kinematic])
        force += from_ode(contact.force.f1).norm();
    return force;
  }

 private:
  struct MeshData {
    std::vector<double> vertices;
    std::vector<dTriIndex> indices;
    dTriMeshDataID id = nullptr;
  };
  struct Feedback {
    dBodyID first, second;
    dJointFeedback force;
  };

  static void place(dBodyID body, const Pose& pose) {
    const Quaternion& q = pose.orientation;
    const dQuaternion turn = {q.w(), q.x(), q.y(), q.z()};
    dBodySetPosition(body, pose.position.x(), pose.position.y(), pose.position.z());
    dBodySetQuaternion(body, turn);
  }

  /// ODE keeps the arrays.
  dGeomID mesh_of(const TriangleMesh& mesh) {
    meshes_.emplace_back();
    MeshData& data = meshes_.back();
    for (const Vector3& v : mesh.vertices) data.vertices.insert(data.vertices.end(), {v.x(), v.y(), v.z()});
    for (const auto& triangle : mesh.triangles) {
      for (const int corner : triangle) data.indices.push_back(static_cast<dTriIndex>(corner));
    }
    data.id = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildDouble(data.id, data.vertices.data(), 3 * sizeof(double),
                                static_cast<int>(mesh.vertices.size()), data.indices.data(),
                                static_cast<int>(data.indices.size()), 3 * sizeof(dTriIndex));
    return dCreateTriMesh(space_, data.id, nullptr, nullptr, nullptr);
  }

  void add(const BodySpec& spec) {
    dGeomID geometry;
    if (const Mesh* mesh = std::get_if<Mesh>(&spec.shape)) {
      geometry = mesh_of(*mesh->triangles);
    } else if (const Box* box = std::get_if<Box>(&spec.shape)) {
      const Vector3 size = 2.0 * box->half_extents;
      geometry = dCreateBox(space_, size.x(), size.y(), size.z());
    } else {
      geometry = dCreateSphere(space_, std::get<Sphere>(spec.shape).radius);
    }
    bodies_.push_back(nullptr);
    if (spec.fixed) {
      const Vector3& p = spec.pose.position;
      dGeomSetPosition(geometry, p.x(), p.y(), p.z());
      return;
    }
    const dBodyID body = bodies_.back() = dBodyCreate(world_);
    dMass mass;
    dMassSetParameters(&mass, spec.mass, 0, 0, 0, spec.inertia.x(), spec.inertia.y(), spec.inertia.z(), 0, 0,
                       0);
    dBodySetMass(body, &mass);
    place(body, spec.pose);
    const Twist& twist = spec.twist;
    dBodySetLinearVel(body, twist.linear.x(), twist.linear.y(), twist.linear.z());
    dBodySetAngularVel(body, twist.angular.x(), twist.angular.y(), twist.angular.z());
    dGeomSetBody(geometry, body);
  }

  void add(const KinematicSpec& spec) {
    const dBodyID body = dBodyCreate(world_);
    dBodySetKinematic(body);
    place(body, spec.pose);
    for (const Capsule& capsule : spec.capsules) {
      const Vector3 axis = capsule.end - capsule.start, centre = capsule.centre();
      const dGeomID geometry = dCreateCapsule(space_, capsule.radius, axis.norm());
      dGeomSetBody(geometry, body);
      dGeomSetOffsetPosition(geometry, centre.x(), centre.y(), centre.z());
      const Quaternion q = Quaternion::FromTwoVectors(Vector3::UnitZ(), axis);
      const dQuaternion turn = {q.w(), q.x(), q.y(), q.z()};
      dGeomSetOffsetQuaternion(geometry, turn);
    }
    hand_.push_back(body);
  }

  /// Friction is a motor with target speed zero.
  void add(const HingeSpec& spec) {
    const dJointID hinge = dJointCreateHinge(world_, nullptr);
    dJointAttach(hinge, bodies_[spec.body], nullptr);
    dJointSetHingeAnchor(hinge, spec.anchor.x(), spec.anchor.y(), spec.anchor.z());
    dJointSetHingeAxis(hinge, spec.axis.x(), spec.axis.y(), spec.axis.z());
    if (spec.friction > 0.0) dJointSetHingeParam(hinge, dParamFMax, spec.friction);
  }

  static bool is_free(dBodyID body) { return body != nullptr && !dBodyIsKinematic(body); }

  void collide(dGeomID a, dGeomID b) {
    const dBodyID first = dGeomGetBody(a), second = dGeomGetBody(b);
    if (!is_free(first) && !is_free(second)) return;
    std::array<dContact, kMaxContacts> found;
    const int count = dCollide(a, b, kMaxContacts, &found[0].geom, sizeof(dContact));
    for (int i = 0; i < count; ++i) {
      dContact& contact = found[static_cast<std::size_t>(i)];
      contact.surface = surface();
      if (setting_.aligned) align(first, second, contact);
      const dJointID joint = dJointCreateContact(world_, contacts_, &contact);
      dJointAttach(joint, first, second);
      if (!watched_) continue;
      feedback_.push_back({first, second, {}});
      dJointSetFeedback(joint, &feedback_.back().force);
    }
  }

  static Vector3 velocity(dBodyID body, const dReal* point) {
    if (body == nullptr) return Vector3::Zero();
    dVector3 result;
    dBodyGetPointVel(body, point[0], point[1], point[2], result);
    return from_ode(result);
  }
  static void align(dBodyID first, dBodyID second, dContact& contact) {
    const Vector3 n = from_ode(contact.geom.normal);
    const Vector3 v = velocity(first, contact.geom.pos) - velocity(second, contact.geom.pos);
    const Vector3 sliding = v - n.dot(v) * n;
    if (sliding.norm() < 1e-6) return;
    contact.surface.mode |= dContactFDir1;
    Eigen::Map<Vector3>(contact.fdir1) = sliding.normalized();
  }

  dSurfaceParameters surface() const {
    dSurfaceParameters surface{};
    surface.mode = dContactApprox1;
    surface.mu = friction_;
    if (restitution_ > 0.0) {
      surface.mode |= dContactBounce;
      surface.bounce = restitution_;
    }
    if (setting_.stiffness > 0.0) {
      surface.mode |= dContactSoftERP | dContactSoftCFM;
      const double stiff = step_ * setting_.stiffness;
      surface.soft_erp = stiff / (stiff + setting_.damping);
      surface.soft_cfm = 1.0 / (stiff + setting_.damping);
    }
    return surface;
  }

  Setting setting_;
  double step_, friction_, restitution_;
  dWorldID world_;
  dSpaceID space_;
  dJointGroupID contacts_;
  std::vector<dBodyID> bodies_, hand_;
  std::deque<MeshData> meshes_;  // a deque, as ODE keeps their addresses
  bool watched_ = false;
  std::deque<Feedback> feedback_;
};

using OdeMaker = TableMaker<OdeEngine, kSettings>;

}  // namespace
}  // namespace mrhi::benchmark

MRHI_ENGINE_MODULE(mrhi::benchmark::OdeMaker)
