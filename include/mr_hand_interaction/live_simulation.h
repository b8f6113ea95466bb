#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// The object of a parameter "grasp/OBJECT"; empty for a name of parameters.h.
std::optional<std::string> grasp_parameter(const std::string& name);

/// A simulation whose scene and configuration may change between frames. Each change builds a new simulation
/// that continues from the state of the old one: held objects stay held, moving ones move on. A rejected
/// change has no effect.
class LiveSimulation {
 public:
  /// `scene`: without the configuration's gravity, which overrides its own. Throws as Simulation does.
  LiveSimulation(Scene scene, const Configuration& configuration);

  /// Valid until the next change.
  Simulation& simulation() { return *simulation_; }
  const Simulation& simulation() const { return *simulation_; }

  /// Names of parameters.h, or "grasp/OBJECT", and their values in YAML: sets all or none. Throws
  /// ParameterError.
  void set_parameters(const std::vector<std::pair<std::string, std::string>>& values);
  /// Present value of such a parameter, as YAML. Throws ParameterError for an unknown name.
  std::string parameter(const std::string& name) const;
  /// Throws std::invalid_argument if the name is in use, or the place is out of bounds or inside another
  /// body.
  void add(const Body& body);
  /// Adds all bodies and joints of `part`, and nothing else of it. Throws likewise.
  void add(const Scene& part);
  /// Removes a body with its descendants by joints. Throws std::invalid_argument for an unknown name.
  void remove(const std::string& name);
  /// Events by which hands would leave a body and its descendants if it were removed now. Throws likewise.
  std::vector<Event> events_if_removed(const std::string& name) const;
  /// Events by which hands would leave all bodies if everything were reset now.
  std::vector<Event> events_if_reset() const;
  /// Places a free body, at rest. Throws std::invalid_argument for an unknown name or a place out of bounds.
  void place(const std::string& name, const Pose& pose);
  /// Engages or releases the operators' restraints. Throws std::invalid_argument if there are none, or if an
  /// operator is out of its restraint's range.
  void restrain(bool on);
  /// Resets everything to its start. Hands are re-acquired. A hand and a free body that overlap then do not
  /// act on each other until they have separated. Throws std::invalid_argument if bodies would overlap, as
  /// one that was spawned where another starts.
  void reset();

 private:
  std::vector<Event> events_if_left(const std::vector<std::size_t>& bodies) const;
  void continue_with(const Scene& scene, const Configuration& configuration);

  std::unique_ptr<Simulation> simulation_;
};

}  // namespace mrhi
