#include "grip_springs.h"

#include "side_by_side.h"
#include "spring_contact.h"

namespace mrhi {

// With no normal and no depth the spring acts in all directions, and what it bears is the bond alone: a
// Coulomb contact whose limit does not hang on a push.
void make_grip_spring(const ContactStep& step, const ContactConfiguration& configuration, const Grip& grip,
                      int point, SpringContact<double>& result) {
  const auto i = static_cast<std::size_t>(point);
  const Pose& pose = step.bodies[grip.body].pose;
  const Vector3 on_body = pose * grip.in_body[i];
  result = SpringContact<double>();
  result.spring.stretch = triple(grip.point[i] - on_body);
  result.spring.ahead = look_ahead(step.step, configuration.damping);
  result.spring.stiffness = grip.stiffness;
  result.spring.yields = HandStrength::kUnlimited;
  result.spring.bond = grip.bond;
  result.arm = triple(on_body - pose.position);
  result.drive = triple(grip.velocity[i]);
}

void settle_grip(const ContactStep& step, const SpringContact<double>& solved, int point, Grip& grip) {
  const Spring<double>& spring = solved.spring;
  const SpringResponse<double>& response = solved.response;
  const Vector3 force = vector(response.force);
  if (point == 0) {
    grip.force.setZero();
    grip.slips = false;
  }
  grip.force += force;
  if (response.wanted_squared <= spring.slip_limit * spring.slip_limit) return;
  grip.slips = true;
  // Ideal plasticity: the end on the body goes after by what the force at the limit does not stretch, as far
  // as the step goes of the time that the spring looks ahead.
  const double followed = step.step / spring.ahead;
  const Vector3 yielded = followed * (vector(response.drawn) - force / spring.stiffness);
  const Pose& pose = step.bodies[grip.body].pose;
  Vector3& end = grip.in_body[static_cast<std::size_t>(point)];
  end = pose.to_local(pose * end + yielded);
}

}  // namespace mrhi
