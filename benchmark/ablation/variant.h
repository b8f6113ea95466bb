#pragma once

#include <functional>
#include <string>
#include <vector>

#include "support/pinch_scene.h"

namespace mrhi::ablation {

/// `implicit` with the paper's hand, or with one refinement turned off. Without grasp assist, which would
/// hide losses of contact.
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

/// By the parameter names `contact/...`; "compliance" off is 200 000 N/m instead of 2000.
const std::vector<Refinement>& refinements();

/// A measure that shows the benefit of a refinement.
struct Measure {
  std::string refinement, what, unit;
  std::function<double(const Variant&)> of;
};
const std::vector<Measure>& measures();

/// `seed`, or with seed/literal the paper as printed, in scene (a) and others.
Variant paper(bool as_printed);
/// What differs between the two; the first of each pair is for our reading.
struct PrintedDifference {
  std::string equations, what, unit;
  std::function<double(bool as_printed)> of;
};
const std::vector<PrintedDifference>& printed_differences();

/// The hand of scene (a) closes, and swings from 0.5 s on; one step per frame.
constexpr int kSteps = 4000;
void run_scene_a(const Variant& variant);

/// Median step time of scene (a) for each variant [ns]. Variants alternate, so that other load affects all
/// alike.
std::vector<double> times_of_a_step(const std::vector<Variant>& variants);

/// Mean instructions per step of scene (a), counted by callgrind in `program --steps REFINEMENT`. Negative
/// without valgrind.
double instructions_of_a_step(const std::string& program, const std::string& refinement);

}  // namespace mrhi::ablation
