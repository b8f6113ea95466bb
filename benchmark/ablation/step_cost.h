#pragma once

#include <string>
#include <vector>

#include "variant.h"

namespace mrhi::ablation {

/// The hand of scene (a) closes, and swings from 0.5 s on; a step a frame.
constexpr int kSteps = 4000;
void run_scene_a(const Variant& variant);

/// Median time of a step of scene (a) under each variant [ns]; they take turns, so that a machine that slows
/// down slows all.
std::vector<double> times_of_a_step(const std::vector<Variant>& variants);

/// Instructions of a step of scene (a): mean, as callgrind counts them in `program --steps REFINEMENT`.
/// Negative if there is no valgrind.
double instructions_of_a_step(const std::string& program, const std::string& refinement);

}  // namespace mrhi::ablation
