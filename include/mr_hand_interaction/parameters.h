#pragma once

#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "mr_hand_interaction/configuration.h"

namespace mrhi {

/// Error of an invalid parameter. what() is one line: its name, the value, and what is allowed.
class ParameterError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Sets one parameter by its public name ("filter/window") from YAML text ("3", "[0, 0, -9.81]"). Throws
/// ParameterError for an unknown name, a wrong type or a value out of range; the configuration is then
/// unchanged.
void set_parameter(Configuration& configuration, const std::string& name, const std::string& yaml_value);

/// Sets every parameter of a YAML file; nested maps and slashes both work. Throws ParameterError.
void load_parameters(Configuration& configuration, const std::string& yaml_file);

/// Checks every value against its limits, also those set in code, and conditions between values (dynamic
/// friction at most static). Throws ParameterError.
void validate(const Configuration& configuration);

/// Present value of a parameter, as YAML for set_parameter(). Throws ParameterError for an unknown name.
std::string parameter_text(const Configuration& configuration, const std::string& name);

/// Present values of all parameters, likewise, by their names.
std::map<std::string, std::string> parameter_texts(const Configuration& configuration);

/// Limits of a number, and of a slider for it.
struct ParameterLimits {
  double min, max;  ///< both allowed
  double slider_min, slider_max;
};

/// Limits of a number, or of each number of a vector; empty for other parameters. Throws ParameterError for
/// an unknown name.
std::optional<ParameterLimits> parameter_limits(const std::string& name);

/// All public names, sorted.
std::vector<std::string> parameter_names();

}  // namespace mrhi
