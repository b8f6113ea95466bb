#pragma once

#include <memory>
#include <vector>

#include "mr_hand_interaction/configuration.h"

namespace mrhi {

class ContactModel;

/// Registration of a contact model. The file src/response/NAME_model.cpp defines NAME_model; the build finds
/// it, and all other code uses contact_models().
struct ContactModelEntry {
  const char* name;
  int place;         ///< position in lists
  double stiffness;  ///< default, for bodies without a stiffness in the scene [N/m]
  std::unique_ptr<ContactModel> (*make)(const ContactConfiguration&);
  bool of_objects = false;  ///< also handles contacts between objects
};

/// All models, in the order of their positions.
const std::vector<const ContactModelEntry*>& contact_models();

/// Material of bodies without one in the scene. Its stiffness, if not set, is the contact model's default.
Material default_material(const Configuration& configuration);

}  // namespace mrhi
