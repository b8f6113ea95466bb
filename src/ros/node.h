#pragma once

#include <ros/ros.h>

#include <functional>
#include <set>
#include <stdexcept>
#include <string>

namespace mrhi {

/// A node's handles: of its namespace and of its private one.
using NodeBody = std::function<void(const ros::NodeHandle& node, const ros::NodeHandle& private_node)>;

/// A node's main(): prints the usage for --help, refuses arguments that are not roslaunch's with one line and
/// 2, then runs `body`, which ends with the node; an exception's text is logged as fatal, and 1 returned.
/// SIGTERM, SIGHUP and SIGQUIT end ros::spin() as SIGINT does. Logs when the ROS master is gone or has been
/// started anew.
int run_node(int argc, char** argv, const char* name, const char* usage, const NodeBody& body);

/// The same without a look at arguments.
int run_node(int argc, char** argv, const char* name, const NodeBody& body);

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
