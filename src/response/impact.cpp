#include "mr_hand_interaction/response/impact.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mr_hand_interaction/collision/god_object.h"

namespace mrhi {

Matrix3 collision_matrix(const Body& body, const Quaternion& orientation, const Vector3& r) {
  const Matrix3 arm = cross_matrix(r);
  return Matrix3::Identity() / body.mass - arm * world_inverse_inertia(body, orientation) * arm;
}

double newton_impulse(double normal_velocity, double restitution, const Matrix3& k, const Vector3& normal) {
  return -(1.0 + restitution) * normal_velocity / normal.dot(k * normal);
}

void apply_impulse(const Vector3& impulse, const Vector3& point, BodyState& state) {
  state.linear_momentum += impulse;
  state.angular_momentum += (point - state.pose.position).cross(impulse);
}

Vector3 relative_velocity(const Contact& contact, const Body& body, const BodyState& state) {
  return contact.hand_velocity - object_velocity(twist_of(body, state), state.pose.position, contact.point);
}

bool strikes_now(const Contact& contact, double normal_velocity, double step) {
  return !contact.ignored && !contact.struck && classify(normal_velocity) == Approach::colliding &&
         contact.depth - normal_velocity * step > 0.0;
}

namespace {

constexpr std::size_t kMaxStrikes = 128;  // in one step
constexpr int kMaxSweeps = 500;
constexpr double kConverged = 1e-13;  // of the approach velocity
constexpr double kPressed =
    4.0;  // impulses that grow beyond this multiple of what one blow needs have no end

struct Strike {
  Contact* contact;
  double target;                      // n.(c1' - c2') after the impact [m/s]
  double mass;                        // effective along n [kg]
  double magnitude = 0.0;             // j so far [N s]
  double friction = 0.0;              // Coulomb's coefficient
  Eigen::Matrix<double, 3, 2> along;  // unit vectors across n
  Eigen::Matrix2d along_mass;         // effective across n [kg]
  Vector3 drag = Vector3::Zero();     // tangential impulse so far [N s]
};

Strike make_strike(const Body& body, const BodyState& state, double velocity, ImpactFriction friction,
                   Contact& contact) {
  const Matrix3 k = collision_matrix(body, state.pose.orientation, contact.point - state.pose.position);
  const double restitution = body.material.restitution;
  Strike strike;
  strike.contact = &contact;
  strike.target = -restitution * velocity;
  strike.mass = newton_impulse(velocity, restitution, k, contact.normal) / (-(1.0 + restitution) * velocity);
  if (friction == ImpactFriction::coulomb) {
    strike.friction = body.material.static_friction;
    strike.along.col(0) = contact.normal.unitOrthogonal();
    strike.along.col(1) = contact.normal.cross(strike.along.col(0));
    strike.along_mass = (strike.along.transpose() * k * strike.along).inverse();
  }
  return strike;
}

struct Strikes {
  std::array<Strike, kMaxStrikes> all;
  std::size_t count = 0;
  double most = 0.0;  // sum of the magnitudes that one body can need [N s]
};

/// Adds those of contacts[first..last), all on one body, that strike now.
void collect(ContactStep& step, std::size_t first, std::size_t last, ImpactFriction friction,
             Strikes& strikes) {
  for (std::size_t i = first; i < last && strikes.count < kMaxStrikes; ++i) {
    Contact& contact = step.contacts[i];
    const Body& body = step.scene.bodies[contact.key.body];
    const BodyState& state = step.bodies[contact.key.body];
    const double velocity = contact.normal.dot(relative_velocity(contact, body, state));
    if (!strikes_now(contact, velocity, step.step)) continue;
    strikes.all[strikes.count++] = make_strike(body, state, velocity, friction, contact);
    strikes.most = std::max(strikes.most, -(1.0 + body.material.restitution) * velocity * body.mass);
    contact.struck = true;
    contact.time_of_impact = std::max(0.0, contact.depth / velocity);
  }
}

/// Moves one impact towards its target, never pulling; returns by how much its velocity was off [m/s].
double relax_normal(const ContactStep& step, Strike& strike) {
  const Contact& contact = *strike.contact;
  BodyState& state = step.bodies[contact.key.body];
  const double velocity =
      contact.normal.dot(relative_velocity(contact, step.scene.bodies[contact.key.body], state));
  const double wanted = std::max(0.0, strike.magnitude + strike.mass * (strike.target - velocity));
  const double change = wanted - strike.magnitude;
  strike.magnitude = wanted;
  apply_impulse(-change * contact.normal, contact.point, state);
  return std::abs(change) / strike.mass;
}

/// Stops the sliding at one impact as far as Coulomb's law lets it; returns the change of the impulse over
/// the normal's effective mass [m/s].
double relax_tangential(const ContactStep& step, Strike& strike) {
  if (strike.friction <= 0.0) return 0.0;
  const Contact& contact = *strike.contact;
  BodyState& state = step.bodies[contact.key.body];
  const Vector3 sliding = relative_velocity(contact, step.scene.bodies[contact.key.body], state);
  Vector3 wanted =
      strike.drag + strike.along * (strike.along_mass * (strike.along.transpose() * sliding)).eval();
  const double most = strike.friction * strike.magnitude, length = wanted.norm();
  if (length > most) wanted *= most / length;
  const Vector3 change = wanted - strike.drag;
  strike.drag = wanted;
  apply_impulse(change, contact.point, state);
  return change.norm() / strike.mass;
}

}  // namespace

namespace {

/// Impulses that together give every strike its velocity; false if there are none.
bool solve(const ContactStep& step, Strikes& strikes) {
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double error = 0.0, scale = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < strikes.count; ++i) {
      Strike& strike = strikes.all[i];
      error = std::max({error, relax_normal(step, strike), relax_tangential(step, strike)});
      scale = std::max(scale, strike.magnitude / strike.mass);
      sum += strike.magnitude;
    }
    if (error <= kConverged * scale) return true;
    if (sum > kPressed * strikes.most) return false;
  }
  return true;
}

void strike_body(ContactStep& step, std::size_t first, std::size_t last, ImpactFriction friction) {
  Strikes strikes;
  collect(step, first, last, friction, strikes);
  if (strikes.count == 0) return;
  BodyState& state = step.bodies[step.contacts[first].key.body];
  const BodyState before = state;
  if (!solve(step, strikes)) {
    // Fingers that close from both sides press the body, they do not strike it: Newton's law has no solution,
    // and the springs take over.
    state = before;
    return;
  }
  for (std::size_t i = 0; i < strikes.count; ++i) {
    const Strike& strike = strikes.all[i];
    strike.contact->impulse = strike.drag - strike.magnitude * strike.contact->normal;
  }
}

}  // namespace

void impulse_phase(ContactStep& step, ImpactFriction friction) {
  std::vector<Contact>& contacts = step.contacts;
  for (Contact& contact : contacts) contact.impulse.setZero();
  std::size_t first = 0;
  while (first < contacts.size()) {
    const std::size_t body = contacts[first].key.body;
    std::size_t last = first;
    while (last < contacts.size() && contacts[last].key.body == body) ++last;
    if (!step.scene.bodies[body].fixed) strike_body(step, first, last, friction);
    first = last;
  }
}

void delay_impacts(ContactStep& step) {
  for (const Contact& contact : step.contacts) {
    if (contact.impulse == Vector3::Zero() || contact.time_of_impact <= 0.0) continue;
    const Body& body = step.scene.bodies[contact.key.body];
    Pose& pose = step.bodies[contact.key.body].pose;
    const Vector3 spin = world_inverse_inertia(body, pose.orientation) *
                         (contact.point - pose.position).cross(contact.impulse);
    const Vector3 turned = -contact.time_of_impact * spin;
    const double angle = turned.norm();
    pose.position -= (contact.time_of_impact / body.mass) * contact.impulse;
    if (angle > 0.0) {
      pose.orientation =
          (Quaternion(Eigen::AngleAxisd(angle, turned / angle)) * pose.orientation).normalized();
    }
  }
}

}  // namespace mrhi
