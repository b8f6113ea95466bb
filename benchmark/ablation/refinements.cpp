#include "variant.h"

namespace mrhi::ablation {
namespace {

constexpr double kHard = 2e5;  // stiffness of a nearly rigid finger [N/m]

Refinement part(const std::string& name, bool ContactConfiguration::*refinement) {
  return {name, [=](Variant& variant) { variant.configuration.contact.*refinement = false; }};
}

}  // namespace

const std::vector<Refinement>& refinements() {
  static const std::vector<Refinement> all{
      {"compliance", [](Variant& variant) { variant.pinch.stiffness = kHard; }},
      part("anchors", &ContactConfiguration::anchors),
      part("torsion", &ContactConfiguration::torsion),
      part("two_points", &ContactConfiguration::two_points),
      part("damping", &ContactConfiguration::damping),
      part("release_fade", &ContactConfiguration::release_fade),
      part("edge_grip", &ContactConfiguration::edge_grip),
      part("entry_face", &ContactConfiguration::entry_face),
      part("swing_back", &ContactConfiguration::swing_back),
      part("sweep", &ContactConfiguration::sweep),
      part("impact_friction", &ContactConfiguration::impact_friction),
  };
  return all;
}

}  // namespace mrhi::ablation
