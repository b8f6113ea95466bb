#pragma once

#include <memory>
#include <vector>

#include "mr_hand_interaction/configuration.h"

namespace mrhi {

class ContactModel;

/// What there is of a contact model before it is made. The file src/response/NAME_model.cpp defines
/// NAME_model; the build finds it, and all else asks contact_models().
struct ContactModelEntry {
  const char* name;
  int place;         ///< in lists
  double stiffness;  ///< its own: of bodies that the scene says nothing about [N/m]
  std::unique_ptr<ContactModel> (*make)(const ContactConfiguration&);
  bool of_objects = false;  ///< it answers touches between objects too
};

/// In the order of their places.
const std::vector<const ContactModelEntry*>& contact_models();

/// Material of bodies that the scene says nothing about. Its stiffness, if not set, is the contact model's
/// own.
Material default_material(const Configuration& configuration);

}  // namespace mrhi
