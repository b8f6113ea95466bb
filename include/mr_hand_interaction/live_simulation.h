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

/// A simulation whose scene and configuration change while it runs, between frames: each change builds a
/// simulation of the new ones, which goes on from where the old one was. What is held stays held, what flies
/// flies on. A change that is refused changes nothing.
class LiveSimulation {
 public:
  /// `scene`: without the configuration's gravity, which overrides it. Throws as Simulation does.
  LiveSimulation(Scene scene, const Configuration& configuration);

  /// Until the next change.
  Simulation& simulation() { return *simulation_; }
  const Simulation& simulation() const { return *simulation_; }

  /// Names of parameters.h, or "grasp/OBJECT", and their values in YAML: all or none. Throws ParameterError.
  void set_parameters(const std::vector<std::pair<std::string, std::string>>& values);
  /// What such a value is now, as YAML. Throws ParameterError for an unknown name.
  std::string parameter(const std::string& name) const;
  /// Throws std::invalid_argument for a name that is taken, and a place out of bounds or in another body.
  void add(const Body& body);
  /// The same for all bodies of `part` and its joints; what else is in it does not count.
  void add(const Scene& part);
  /// With what hangs on it by joints. Both throw std::invalid_argument for a name that is not known.
  void remove(const std::string& name);
  /// The events with which hands would leave a body, and what hangs on it, if it were removed now.
  std::vector<Event> events_if_removed(const std::string& name) const;
  /// Puts a free body somewhere, at rest. Throws std::invalid_argument for a name that is not known and a
  /// place out of bounds.
  void place(const std::string& name, const Pose& pose);
  /// Lets restraints hold the operators who have one, or releases them. Throws std::invalid_argument if none
  /// has one, or if an operator is out of its reach.
  void restrain(bool on);
  /// Everything back to its start. Hands are found anew; of one that a free body comes back in neither is
  /// pushed aside until they have separated.
  void reset();

 private:
  void go_on_with(const Scene& scene, const Configuration& configuration);

  std::unique_ptr<Simulation> simulation_;
};

}  // namespace mrhi
