#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "../collision/closest_features.h"
#include "contact_step.h"
#include "impact.h"
#include "penetration_model.h"

namespace mrhi {
namespace {

constexpr int kAlong = 5, kAcross = 3, kPads = kAlong * kAcross;
/// Distance between pads, over the phalanx's radius.
constexpr double kSpacing = 0.5;
/// Damping of a pad over its stiffness [s].
constexpr double kPadRelaxation = 0.01;
/// Largest angle from the normal at which a phalanx has no direction along the surface [rad].
constexpr double kMinTilt = 1e-6;

/// Geometry of the phalanx at its contact point: axes along the surface and across.
struct Skin {
  explicit Skin(const Contact& contact)
      : radius(contact.radius), s(contact.axis_parameter), rise(contact.normal.dot(contact.axis)) {
    const Vector3 flat = contact.axis - rise * contact.normal;
    run = flat.norm();
    if (run <= kMinTilt * contact.axis.norm()) run = 0.0;
    slope = run > 0.0 ? rise / std::hypot(run, rise) : 0.0;
    along = run > 0.0 ? Vector3(flat / run) : contact.normal.unitOrthogonal();
    across = contact.normal.cross(along);
  }

  /// Distance of the skin at (x, y) behind the contact point, along n; none beside the phalanx.
  ///
  ///     sag(x, y) = R + u rise - sqrt(R^2 - (x - u run)^2 - y^2)            of the sphere u of the axis on
  ///     least over u:     x - u run = sqrt(R^2 - y^2) slope,   slope = rise / hypot(run, rise)
  ///
  /// from d sag / du = rise - (x - u run) run / sqrt(...) = 0, with u limited to the axis. x is along the
  /// surface from the contact point; run and rise are the components of the whole axis along the surface and
  /// along n.
  std::optional<double> sag(double x, double y) const {
    // u is the axis parameter of the capsule's sphere with the deepest skin at (x, y), relative to the
    // contact's.
    double u = 0.0;
    if (run > 0.0) {
      const double rim = std::sqrt(std::max(0.0, radius * radius - y * y));
      u = std::clamp((x - rim * slope) / run, -s, 1.0 - s);
    }
    const double from_middle = x - u * run;
    const double cap = radius * radius - from_middle * from_middle - y * y;
    if (cap < 0.0) return std::nullopt;
    return radius + u * rise - std::sqrt(cap);
  }

  double radius, s;
  double rise, run;  // of the whole axis, along n and along the surface [m]
  double slope;      // sine of the axis's tilt
  Vector3 along, across;
};

struct Pad {
  Vector3 offset;       // from the contact point, along the surface
  Vector3 surface;      // point of the object under the pad
  double normal_force;  // normal force [N]
};

/// The pads of one contact point.
class PadGrid {
 public:
  PadGrid(const Contact& contact, const Body& body, const BodyState& state, double step)
      : n_(contact.normal), material_(body.material), step_(step) {
    stiffness_ = material_.stiffness * contact.share / kPads;
    damping_ = stiffness_ * kPadRelaxation;
    const Vector3 velocity = relative_velocity(contact, body, state);
    normal_velocity_ = n_.dot(velocity);
    slide_ = velocity - normal_velocity_ * n_;
    spin_ = contact.hand_spin - n_.dot(twist_of(body, state).angular);
    place(contact, body, state);
  }

  /// Moves the god object and reduces the twist where friction is exceeded.
  ///
  ///     s <- f_T / k_p where the deepest pad slips,     theta <- clamp(theta + h w_n, -+mu N / (k_p l))
  ///
  /// k_p is a pad's stiffness and l the distance between pads: a twist theta shears adjacent pads by l theta.
  /// The integration is explicit, so the stored values are bounded by what friction supports.
  void drag(const BodyState& state, Contact& contact) {
    stretch_ = stretch_of(contact);
    const Vector3 deepest =
        tangential_force(material_, stiffness_, damping_ * slide_, max_normal_force_, state, contact);
    const bool sticks = contact.friction == Friction::sticking;
    friction_ = sticks ? material_.static_friction : material_.dynamic_friction;
    if (!sticks) stretch_ = deepest / stiffness_;
    // Beyond this twist the pads next to the centre slip too.
    const double max_twist = friction_ * max_normal_force_ / (stiffness_ * kSpacing * contact.radius);
    contact.twist = std::clamp(contact.twist + step_ * spin_, -max_twist, max_twist);
    unturn_ = Eigen::AngleAxisd(-contact.twist, n_);
  }

  /// Applies the pads' forces to the object; returns their sum [N].
  ///
  ///     q_i = s + r_i - R(-theta) r_i           shear of the pad at r_i: about theta n x r_i, and s
  ///     f_i = disc(k_p q_i + b_p (w_t + w_n n x r_i), mu N_i) - N_i n,      N_i = max(0, k_p d_i - b_p v_n)
  ///
  /// They act where the pad sticks to the object, q_i behind it. The torque about n results from the pads'
  /// arms.
  Vector3 act(bool fixed, BodyState& state) const {
    Vector3 sum = Vector3::Zero();
    for (int i = 0; i < count_; ++i) {
      const Pad& pad = pads_[i];
      const Vector3 sheared = stretch_ + pad.offset - unturn_ * pad.offset;
      Vector3 force = stiffness_ * sheared + damping_ * (slide_ + spin_ * n_.cross(pad.offset));
      const double limit = friction_ * pad.normal_force, size = force.norm();
      if (size > limit) force *= limit / size;
      force -= pad.normal_force * n_;
      if (!fixed) apply_impulse(step_ * force, pad.surface - sheared, state);
      sum += force;
    }
    return sum;
  }

  bool is_loaded() const { return max_normal_force_ > 0.0; }

 private:
  void place(const Contact& contact, const Body& body, const BodyState& state) {
    const Skin skin(contact);
    const PlacedShape& placed = body.shapes[contact.key.shape];
    const Pose pose = state.pose * placed.pose;
    const Vector3 normal = pose.orientation.conjugate() * contact.normal;
    // Along n, as all pads of a phalanx leave by the face of entry; 0 beside the object. A mesh counts as
    // flat around the contact point.
    const auto depth_of = [&](const Vector3& point) {
      if (std::holds_alternative<Mesh>(placed.shape)) return contact.normal.dot(contact.point - point);
      return exit_distance(placed.shape, pose.to_local(point), normal).value_or(0.0);
    };
    const double spacing = kSpacing * contact.radius;
    for (int i = 0; i < kPads; ++i) {
      const int along = i % kAlong - kAlong / 2;
      const int across = i / kAlong - kAcross / 2;
      const double x = spacing * along, y = spacing * across;
      const std::optional<double> sag = skin.sag(x, y);
      if (!sag) continue;
      const Vector3 offset = x * skin.along + y * skin.across;
      const Vector3 point = contact.hand_point + offset + *sag * n_;
      const double depth = depth_of(point);
      if (depth <= 0.0) continue;
      const double normal_force = std::max(0.0, stiffness_ * depth - damping_ * normal_velocity_);
      pads_[count_++] = {offset, point + depth * n_, normal_force};
      max_normal_force_ = std::max(max_normal_force_, normal_force);
    }
  }

  Vector3 n_;
  const Material& material_;
  double step_;
  double stiffness_, damping_;  // of one pad [N/m], [N s/m]
  double normal_velocity_;      // of the phalanx relative to the object at the contact point [m/s]
  Vector3 slide_;               // likewise along the surface [m/s]
  double spin_;                 // likewise about n [rad/s]
  double friction_ = 0.0;
  double max_normal_force_ = 0.0;  // largest normal force of a pad [N]
  Vector3 stretch_ = Vector3::Zero();
  Matrix3 unturn_ = Matrix3::Identity();
  std::array<Pad, kPads> pads_;
  int count_ = 0;
};

/// A reduced stand-in for the soft hand of the paper's reference [20] (CLAP), without its deformable flesh.
/// Around each contact point the skin has a grid of pads on springs, five along the phalanx and three across.
/// Each pad has its own depth, along the normal of entry, and its own friction. The state is the contact's
/// god object and twist about the normal, which shear the pads. So single pads slip without creep, and the
/// grip slides once its deepest pad does. Explicit.
class SoftPadModel : public ContactModel {
 public:
  // All pads of a body use its state at the start of the step (`before`), so their order has no effect.
  void respond(ContactStep& step) override {
    BodyState before;
    std::size_t current = step.bodies.size();
    for (Contact& contact : step.contacts) {
      contact.force.setZero();
      const std::size_t index = contact.key.body;
      const Body& body = step.scene.bodies[index];
      if (index != current) before = step.bodies[current = index];
      if (!contact.touching() || body.material.stiffness * contact.share <= 0.0) continue;
      PadGrid pads(contact, body, before, step.step);
      if (!pads.is_loaded()) continue;
      pads.drag(before, contact);
      contact.force = pads.act(body.fixed, step.bodies[index]);
    }
  }
};

}  // namespace

/// The default stiffness is that of all pads of a phalanx together.
extern const ContactModelEntry soft_pad_model{"soft_pad", 5, 500.0, make_model<SoftPadModel>};

}  // namespace mrhi
