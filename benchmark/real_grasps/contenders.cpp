#include "contenders.h"

#include <filesystem>
#include <utility>

#include "../speed_accuracy/engine_module.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "text/text.h"

namespace mrhi::real_grasps {
namespace {

struct OurSetting {
  const char* model;
  double stiffness;          // [N/m], 0: the model's default
  bool papers_hand = false;  // unlimited, rigid, without grasp assist
};

constexpr OurSetting kOurs[] = {
    {"implicit", 0.0},       {"implicit", 500.0},        {"implicit", 1000.0},
    {"implicit", 5000.0},    {"implicit", 20000.0},      {"seed", 0.0},
    {"seed", 500.0},         {"seed", 2000.0},           {"penetration", 0.0},
    {"soft_pad", 0.0},       {"soft_pad", 2000.0},       {"soft_pad", 5000.0},
    {"virtual_spring", 0.0}, {"virtual_spring", 2000.0}, {"implicit", 500.0, true},
    {"implicit", 0.0, true}, {"implicit", 20000.0, true}};

std::string named(const Configuration& configuration) {
  const bool assisted = configuration.contact.grasp_assist;
  const bool papers = configuration.contact.hand.finger == HandStrength::kUnlimited && !assisted;
  return text::format("%s%s; %g N/m", parameter_text(configuration, "contact_model").c_str(),
                      papers ? ", the paper's hand" : "", default_material(configuration).stiffness);
}

}  // namespace

Contender ours(const Configuration& configuration) {
  return {"mr_hand_interaction", named(configuration), configuration,
          [configuration](const std::vector<JointsFrame>& frames, const Closing& closing, const Row& row) {
            return play_ours(frames, closing, row, configuration);
          }};
}

std::vector<Contender> our_settings(const Configuration& configuration) {
  std::vector<Contender> contenders;
  for (const OurSetting& setting : kOurs) {
    Configuration next = configuration;
    set_parameter(next, "contact_model", setting.model);
    if (setting.stiffness > 0.0) next.stiffness = setting.stiffness;
    if (setting.papers_hand) {
      next.contact.hand = HandStrength();
      next.contact.grasp_assist = false;
    }
    contenders.push_back(ours(next));
  }
  return contenders;
}

std::vector<Contender> peer_settings(const std::string& module, const Configuration& configuration) {
  const benchmark::EngineMaker& maker = benchmark::load(module);
  std::vector<Contender> contenders;
  for (const std::string& setting : maker.settings()) {
    contenders.push_back({engine_name(module), setting, configuration,
                          [&maker, setting, configuration](const std::vector<JointsFrame>& frames,
                                                           const Closing& closing, const Row& row) {
                            return play_peer(frames, closing, row, configuration, maker, setting);
                          }});
  }
  return contenders;
}

std::string engine_name(const std::string& module) {
  const std::string prefix = "speed_accuracy_", stem = std::filesystem::path(module).stem().string();
  return stem.compare(0, prefix.size(), prefix) == 0 ? stem.substr(prefix.size()) : stem;
}

}  // namespace mrhi::real_grasps
