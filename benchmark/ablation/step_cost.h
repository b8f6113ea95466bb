#pragma once

#include <string>
#include <vector>

#include "variant.h"

namespace mrhi::ablation {

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
