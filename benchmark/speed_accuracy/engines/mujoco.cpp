#include <mujoco/mujoco.h>

#include <cmath>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "../engine.h"

namespace mrhi::benchmark {
namespace {

struct Setting {
  const char* name;
  const char* option;    // attributes of <option>
  bool feed_forward;     // the hand's acceleration is applied as a force
  double time_constant;  // solref [s], at least two steps (MuJoCo's limit); 0: MuJoCo's default 0.02
  bool direct;           // solref by stiffness and damping, with the damping from the restitution
};

// The hand's parts are heavy free bodies whose pose and velocity are set in every step: MuJoCo's mocap bodies
// have no velocity, so their friction could not drag anything.
constexpr Setting kSettings[] = {
    {"default", "", false, 0.0, false},
    {"hand acceleration given; solref 0.004 or 2 steps; noslip 3; elliptic cone; implicit integrator",
     "noslip_iterations=\"3\" cone=\"elliptic\" integrator=\"implicit\"", true, 0.004, false},
    {"RK4; elliptic cone", "cone=\"elliptic\" integrator=\"RK4\"", false, 0.0, false},
    {"direct solref from restitution; elliptic cone; hand acceleration given", "cone=\"elliptic\"", true, 0.0,
     true},
};

constexpr double kHandMass = 1e4;     // [kg]
constexpr double kHandInertia = 1e3;  // [kg m^2]

std::string text(const Vector3& v) {
  std::ostringstream out;
  out.precision(17);
  out << v.x() << ' ' << v.y() << ' ' << v.z();
  return out.str();
}
std::string text(const Quaternion& q) {
  std::ostringstream out;
  out.precision(17);
  out << q.w() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z();
  return out.str();
}
std::string place(const Pose& pose) {
  return " pos=\"" + text(pose.position) + "\" quat=\"" + text(pose.orientation) + "\"";
}

std::string mesh_name(std::size_t body) {
  return "mesh_" + std::to_string(body);
}

/// MuJoCo replaces a mesh by its convex hull.
std::string meshes(const World& world) {
  std::string text_of_all;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Mesh* mesh = std::get_if<Mesh>(&world.bodies[i].shape);
    if (mesh == nullptr) continue;
    text_of_all += "<mesh name=\"" + mesh_name(i) + "\" vertex=\"";
    for (const Vector3& vertex : mesh->triangles->vertices) text_of_all += text(vertex) + " ";
    text_of_all += "\"/>";
  }
  return text_of_all.empty() ? "" : "<asset>" + text_of_all + "</asset>";
}

std::string geometry(const BodySpec& spec, std::size_t body) {
  if (std::holds_alternative<Mesh>(spec.shape)) return "<geom type=\"mesh\" mesh=\"" + mesh_name(body) + "\"";
  if (const Box* box = std::get_if<Box>(&spec.shape))
    return "<geom type=\"box\" size=\"" + text(box->half_extents) + "\"";
  return "<geom type=\"sphere\" size=\"" + std::to_string(std::get<Sphere>(spec.shape).radius) + "\"";
}

std::string inertial(double mass, const Vector3& inertia) {
  return "<inertial pos=\"0 0 0\" mass=\"" + std::to_string(mass) + "\" diaginertia=\"" + text(inertia) +
         "\"/>";
}

/// Damping ratio for a coefficient of restitution.
double damping_ratio(double restitution) {
  if (restitution <= 1e-3) return 1.0;
  const double l = std::log(restitution);
  return -l / std::sqrt(M_PI * M_PI + l * l);
}

std::string solref(const Setting& setting, const World& world, double step) {
  std::ostringstream out;
  if (setting.direct) {
    // As stiff as the step resolves: half a period of contact is eight steps.
    const double rate = M_PI / (8.0 * step);
    out << " solref=\"" << -rate * rate << ' ' << -2.0 * damping_ratio(world.restitution) * rate << "\"";
  } else if (setting.time_constant > 0.0) {
    out << " solref=\"" << std::max(setting.time_constant, 2.0 * step) << " 1\"";
  }
  return out.str();
}

/// Working memory, up to half a gigabyte.
std::string size(const World& world) {
#if mjVERSION_HEADER < 300
  // Capacity for constraints, which MuJoCo stores as dense rows: four contacts of four rows on the floor.
  const std::size_t rows = world.gravity.isZero() ? 4 : 16;
  // In numbers: some matrices of all degrees of freedom.
  const std::size_t freedoms = 6 * (world.bodies.size() + world.kinematics.size());
  const std::size_t stack = std::min<std::size_t>(400'000 + 16 * freedoms * freedoms, 64'000'000);
  return "<size njmax=\"" + std::to_string(1000 + rows * world.bodies.size()) + "\" nconmax=\"" +
         std::to_string(200 + 10 * world.bodies.size()) + "\" nstack=\"" + std::to_string(stack) + "\"/>";
#else
  return world.bodies.size() < 100 ? "<size memory=\"64M\"/>" : "<size memory=\"512M\"/>";
#endif
}

/// Joint of a body: free, or its hinge. In its own frame.
std::string freedom(const World& world, std::size_t body) {
  for (const HingeSpec& hinge : world.hinges) {
    if (hinge.body != body) continue;
    const Pose& pose = world.bodies[body].pose;
    return "<joint type=\"hinge\" pos=\"" + text(pose.to_local(hinge.anchor)) + "\" axis=\"" +
           text(Vector3(pose.orientation.conjugate() * hinge.axis)) + "\" frictionloss=\"" +
           std::to_string(hinge.friction) + "\"/>";
  }
  return "<freejoint/>";
}

std::string xml(const Setting& setting, const World& world, double step) {
  std::ostringstream out;
  out.precision(17);
  out << "<mujoco><option timestep=\"" << step << "\" gravity=\"" << text(world.gravity) << "\" "
      << setting.option << "/>" << size(world) << "<default><geom friction=\"" << world.friction
      << " 0.005 0.0001\"" << solref(setting, world, step) << "/></default>" << meshes(world)
      << "<worldbody>";
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const BodySpec& spec = world.bodies[i];
    if (spec.fixed) {
      out << geometry(spec, i) << place(spec.pose) << " contype=\"1\" conaffinity=\"1\"/>";
    } else {
      out << "<body" << place(spec.pose) << ">" << freedom(world, i) << inertial(spec.mass, spec.inertia)
          << geometry(spec, i) << " contype=\"1\" conaffinity=\"3\"/></body>";
    }
  }
  for (const KinematicSpec& spec : world.kinematics) {
    out << "<body" << place(spec.pose) << "><freejoint/>"
        << inertial(kHandMass, Vector3::Constant(kHandInertia));
    for (const Capsule& capsule : spec.capsules) {
      out << "<geom type=\"capsule\" size=\"" << capsule.radius << "\" fromto=\"" << text(capsule.start)
          << ' ' << text(capsule.end) << "\" contype=\"2\" conaffinity=\"0\"/>";
    }
    out << "</body>";
  }
  out << "</worldbody></mujoco>";
  return out.str();
}

mjModel* load(const std::string& text) {
  mju_user_error = [](const char* message) { throw std::runtime_error(message); };
  mju_user_warning = [](const char*) {};
  auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
#if mjVERSION_HEADER < 300
  mj_makeEmptyFileVFS(files.get(), "world.xml", static_cast<int>(text.size()));
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), "world.xml")], text.data(), text.size());
#else
  mj_addBufferVFS(files.get(), "world.xml", text.data(), static_cast<int>(text.size()));
#endif
  char error[500] = "";
  mjModel* model = mj_loadXML("world.xml", files.get(), error, sizeof(error));
  mj_deleteVFS(files.get());
  if (model == nullptr) throw std::runtime_error(error);
  return model;
}

class MujocoEngine final : public Engine {
 public:
  static constexpr bool kHinges = true, kMeshes = true;
  MujocoEngine(const Setting& setting, const World& world, double step)
      : setting_(setting),
        step_(step),
        hinged_(!world.hinges.empty()),
        gravity_(world.gravity),
        model_(load(xml(setting, world, step))),
        data_(mj_makeData(model_)) {
    int joint = 0;
    for (const BodySpec& spec : world.bodies) {
      joints_.push_back(spec.fixed ? -1 : joint++);
      if (!spec.fixed && is_free(joints_.back()))
        set_twist(joints_.back(), spec.pose.orientation, spec.twist);
    }
    for (std::size_t i = 0; i < world.kinematics.size(); ++i) {
      hand_.push_back(joint++);
      last_.push_back({});
    }
    mj_forward(model_, data_);
  }
  ~MujocoEngine() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }

  void move(std::size_t kinematic, const Pose& now, const Pose& next) override {
    const int joint = hand_[kinematic];
    mjtNum* q = data_->qpos + model_->jnt_qposadr[joint];
    Eigen::Map<Vector3> position(q);
    position = now.position;
    q[3] = now.orientation.w(), q[4] = now.orientation.x(), q[5] = now.orientation.y(),
    q[6] = now.orientation.z();
    const Twist twist = twist_between(now, next, step_);
    mjtNum* force = data_->xfrc_applied + 6 * model_->jnt_bodyid[joint];
    Eigen::Map<Vector3> linear(force), angular(force + 3);
    linear = -kHandMass * gravity_;
    if (!setting_.feed_forward) {
      set_twist(joint, now.orientation, twist);
      return;
    }
    // From the velocity of the last step to that of this one, at its start and end.
    Twist& last = last_[kinematic];
    set_twist(joint, now.orientation, last);
    linear += kHandMass / step_ * (twist.linear - last.linear);
    angular = kHandInertia / step_ * (twist.angular - last.angular);
    last = twist;
  }

  void step() override { mj_step(model_, data_); }

  void after_step() override {
    // MuJoCo resets an unstable world to its start and continues, and drops what its memory has no place for.
    for (const int kind : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC})
      if (data_->warning[kind].number > 0) throw std::runtime_error("unstable");
    for (const int kind : {mjWARN_CONTACTFULL, mjWARN_CNSTRFULL})
      if (data_->warning[kind].number > 0) throw std::runtime_error("out of memory");
    if (hinged_) mj_kinematics(model_, data_);  // a step leaves poses as at its start
  }

  Motion motion(std::size_t index) const override {
    const int joint = joints_[index];
    if (joint < 0) return {};
    const mjtNum* v = data_->qvel + model_->jnt_dofadr[joint];
    if (!is_free(joint)) return hinged(joint, *v);
    const mjtNum* q = data_->qpos + model_->jnt_qposadr[joint];
    const Quaternion turn(q[3], q[4], q[5], q[6]);
    return {{{q[0], q[1], q[2]}, turn}, {{v[0], v[1], v[2]}, turn * Vector3(v[3], v[4], v[5])}};
  }

  double pressing(std::size_t kinematic) const override {
    const int body = model_->jnt_bodyid[hand_[kinematic]];
    double sum = 0.0;
    for (int i = 0; i < data_->ncon; ++i) {
      const mjContact& contact = data_->contact[i];
      if (model_->geom_bodyid[contact.geom1] != body && model_->geom_bodyid[contact.geom2] != body) continue;
      mjtNum force[6];  // in the contact's frame; the first three are forces
      mj_contactForce(model_, data_, i, force);
      sum += Vector3(force[0], force[1], force[2]).norm();
    }
    return sum;
  }

 private:
  bool is_free(int joint) const { return model_->jnt_type[joint] == mjJNT_FREE; }
  Motion hinged(int joint, double speed) const {
    const int body = model_->jnt_bodyid[joint];
    const mjtNum *p = data_->xpos + 3 * body, *q = data_->xquat + 4 * body;
    const Eigen::Map<const Vector3> position(p), anchor(data_->xanchor + 3 * joint),
        axis(data_->xaxis + 3 * joint);
    const Vector3 spin = speed * axis;
    return {{position, Quaternion(q[0], q[1], q[2], q[3])}, {spin.cross(position - anchor), spin}};
  }

  /// MuJoCo stores a free body's angular velocity in body axes.
  void set_twist(int joint, const Quaternion& turn, const Twist& twist) {
    mjtNum* v = data_->qvel + model_->jnt_dofadr[joint];
    Eigen::Map<Vector3> linear(v), angular(v + 3);
    linear = twist.linear;
    angular = turn.conjugate() * twist.angular;
  }

  Setting setting_;
  double step_;
  bool hinged_;
  Vector3 gravity_;
  mjModel* model_;
  mjData* data_;
  std::vector<int> joints_, hand_;
  std::vector<Twist> last_;
};

using MujocoMaker = TableMaker<MujocoEngine, kSettings>;

}  // namespace
}  // namespace mrhi::benchmark

MRHI_ENGINE_MODULE(mrhi::benchmark::MujocoMaker)
