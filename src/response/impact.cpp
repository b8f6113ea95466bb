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

struct Strike {
  Contact* contact;
  double target;     // n.(c1' - c2') after the impact [m/s]
  double mass;       // effective along n [kg]
  double magnitude;  // j so far [N s]
};

std::size_t collect(ContactStep& step, std::array<Strike, kMaxStrikes>& strikes) {
  std::size_t count = 0;
  for (Contact& contact : step.contacts) {
    contact.impulse.setZero();
    const Body& body = step.scene.bodies[contact.key.body];
    if (body.fixed || count == kMaxStrikes) continue;
    const BodyState& state = step.bodies[contact.key.body];
    const double velocity = contact.normal.dot(relative_velocity(contact, body, state));
    if (!strikes_now(contact, velocity, step.step)) continue;
    const Matrix3 k = collision_matrix(body, state.pose.orientation, contact.point - state.pose.position);
    const double restitution = body.material.restitution;
    const double alone = newton_impulse(velocity, restitution, k, contact.normal);
    strikes[count++] = {&contact, -restitution * velocity, alone / (-(1.0 + restitution) * velocity), 0.0};
    contact.struck = true;
  }
  return count;
}

/// Moves one impact towards its target, never pulling; returns by how much its velocity was off [m/s].
double relax(const ContactStep& step, Strike& strike) {
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

}  // namespace

void impulse_phase(ContactStep& step) {
  std::array<Strike, kMaxStrikes> strikes;
  const std::size_t count = collect(step, strikes);
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double error = 0.0, scale = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      error = std::max(error, relax(step, strikes[i]));
      scale = std::max(scale, std::abs(strikes[i].magnitude) / strikes[i].mass);
    }
    if (error <= kConverged * scale) break;
  }
  for (std::size_t i = 0; i < count; ++i) {
    strikes[i].contact->impulse = -strikes[i].magnitude * strikes[i].contact->normal;
  }
}

}  // namespace mrhi
