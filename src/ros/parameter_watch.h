#pragma once

#include <mr_hand_interaction/SimulationInput.h>

#include <map>
#include <string>
#include <vector>

#include "mr_hand_interaction/configuration.h"

namespace mrhi {

/// Follows the parameters of a running interaction_node by its `simulation_input`, whatever changes them:
/// services, sliders, or another start.
class ParameterWatch {
 public:
  struct Difference {
    std::string name, value;  ///< the value that there is now
    bool as_begun;            ///< it is again what it was to be
  };

  /// What they are to be. Of a BEGIN gravity is passed over: a session sets it after it has begun to listen.
  explicit ParameterWatch(const Configuration& configuration);

  /// What this message has changed against all that came before.
  std::vector<Difference> take(const mr_hand_interaction::SimulationInput& message);

 private:
  using Texts = std::map<std::string, std::string>;
  const Texts begun_;
  Configuration now_;
};

}  // namespace mrhi
