#pragma once

#include <functional>
#include <string>
#include <vector>

#include "support/pinch_scene.h"

namespace mrhi::ablation {

/// `implicit` with the paper's hand, or with one refinement turned off. Without help, which would hold what
/// contact alone loses.
struct Variant {
  Variant() { configuration.contact.grasp_assist = false; }

  Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
  testing::PinchScene pinch;  // scene (a)
};

struct Refinement {
  std::string name;
  std::function<void(Variant&)> turn_off;

  Variant without() const {
    Variant variant;
    turn_off(variant);
    return variant;
  }
};

/// By the names of the parameters `contact/...`; "compliance" off is 200 000 N/m instead of 2000.
const std::vector<Refinement>& refinements();

/// A figure that shows what a refinement is good for.
struct Measure {
  std::string refinement, what, unit;
  std::function<double(const Variant&)> of;
};
const std::vector<Measure>& measures();

}  // namespace mrhi::ablation
