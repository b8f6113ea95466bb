#pragma once

namespace mrhi {

/// How an object's surface answers a touch.
struct Material {
  double restitution = 0.3;       ///< epsilon of Newton's impact law (Eq. 10), 0..1
  double static_friction = 0.8;   ///< mu, Coulomb's cone while sticking (Eq. 19)
  double dynamic_friction = 0.6;  ///< phi, while sliding (Eq. 20); at most static_friction
  double stiffness = 100.0;       ///< gamma of the penetration force (Eq. 16) [N/m]
};

/// Which of a material's numbers a scene gives itself; the others follow the parameters.
struct OwnMaterial {
  bool restitution = false, static_friction = false, dynamic_friction = false, stiffness = false;
};

}  // namespace mrhi
