#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// The object of a parameter "grasp/OBJECT", or nothing for a name of parameters.h.
std::optional<std::string> grasp_parameter(const std::string& name);

/// A simulation whose scene and configuration can change between frames. Each change builds a simulation of
/// the new ones, which continues from the old one's state: held objects stay held. A rejected change changes
/// nothing.
class LiveSimulation {
 public:
  /// `scene`: without the configuration's gravity, which overrides it. Throws as Simulation does.
  LiveSimulation(Scene scene, const Configuration& configuration);

  /// Valid until the next change.
  Simulation& simulation() { return *simulation_; }
  const Simulation& simulation() const { return *simulation_; }

  /// Sets all values or none. Names are those of parameters.h, or "grasp/OBJECT"; values are YAML. Throws
  /// ParameterError.
  void set_parameters(const std::vector<std::pair<std::string, std::string>>& values);
  /// Returns such a value as YAML. Throws ParameterError for an unknown name.
  std::string parameter(const std::string& name) const;
  /// Adds a body. Throws std::invalid_argument for a name that is taken, and a place out of bounds or in
  /// another body.
  void add(const Body& body);
  /// Adds all bodies and joints of `part`, and nothing else of it.
  void add(const Scene& part);
  /// Removes a body with everything that hangs on it by joints. Throws std::invalid_argument for an unknown
  /// name.
  void remove(const std::string& name);
  /// Events with which hands would leave a body, and what hangs on it, if it were removed now. Throws
  /// likewise.
  std::vector<Event> events_if_removed(const std::string& name) const;
  /// Places a free body, at rest. Throws std::invalid_argument for an unknown name and a place out of bounds.
  void place(const std::string& name, const Pose& pose);
  /// Holds all operators that have a restraint, or releases them. Throws std::invalid_argument if none has
  /// one, or if an operator is out of its reach.
  void restrain(bool on);
  /// Puts everything back to its start. Hands are acquired again; a hand and a free body that overlap then do
  /// not push each other until they have separated.
  void reset();

 private:
  void go_on_with(const Scene& scene, const Configuration& configuration);

  std::unique_ptr<Simulation> simulation_;
};

}  // namespace mrhi
