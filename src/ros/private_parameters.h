#pragma once

#include <ros/ros.h>

#include <set>
#include <stdexcept>
#include <string>

namespace mrhi {

/// A private parameter of the node, if it is set. Throws std::invalid_argument if it is of another type.
template <class T>
void read_parameter(const ros::NodeHandle& parameters, const std::string& name, const char* type, T& value) {
  if (!parameters.hasParam(name) || parameters.getParam(name, value)) return;
  throw std::invalid_argument("parameter " + parameters.resolveName(name) + " must be " + type);
}

/// Throws std::invalid_argument that lists the known ones.
void refuse_unknown(const ros::NodeHandle& parameters, const std::set<std::string>& known);

/// Parameter seed, a whole number of at least 0.
std::uint64_t read_seed(const ros::NodeHandle& parameters, std::uint64_t otherwise);

}  // namespace mrhi
