#pragma once

#include <ros/ros.h>

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "../text/text.h"

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

/// A main() whose node is an object that is made of its handles, and works while ROS spins.
template <class Node>
int run_node(int argc, char** argv, const char* name, const char* usage) {
  return run_node(argc, argv, name, usage, [](const auto& node, const auto& private_node) {
    const Node running(node, private_node);
    ros::spin();
  });
}

/// The private parameters of a node, each said once: its name, what it may be, and where its value goes.
class NodeParameters {
 public:
  /// Takes the YAML text of a parameter; false if it is not allowed.
  using Take = std::function<bool(const std::string& name, const std::string& text)>;

  /// `allowed`: for messages. A name that ends with / stands for all parameters below it.
  NodeParameters& add(const std::string& name, const std::string& allowed, const Take& take);
  NodeParameters& text(const std::string& name, std::string& value);
  /// A list of `min` to `max` texts, which are `what`.
  NodeParameters& texts(const std::string& name, std::size_t min, std::size_t max, const std::string& what,
                        std::vector<std::string>& values);
  /// From `min` to `max`; `more` is said behind the limits in messages.
  NodeParameters& number(const std::string& name, double min, double max, double& value,
                         const std::string& more = "");
  NodeParameters& truth(const std::string& name, bool& value);

  template <class T>
  NodeParameters& choice(const std::string& name, const std::vector<std::pair<std::string, T>>& choices,
                         T& value) {
    std::vector<std::string> words;
    for (const auto& [word, meaning] : choices) words.push_back(word);
    return add(name, text::joined(words), [choices, &value](const std::string&, const std::string& text) {
      for (const auto& [word, meaning] : choices)
        if (text == word) return value = meaning, true;
      return false;
    });
  }

  /// A whole number of at least `min`.
  template <class Integer>
  NodeParameters& whole(const std::string& name, int min, Integer& value) {
    constexpr int kMax = std::numeric_limits<int>::max();
    const std::string allowed = "a whole number from " + std::to_string(min) + " to " + std::to_string(kMax);
    return add(name, allowed, [min, &value](const std::string&, const std::string& text) {
      const auto number = text::to_number(text);
      if (!number || !(*number >= min && *number <= kMax) || *number != static_cast<int>(*number))
        return false;
      value = static_cast<int>(*number);
      return true;
    });
  }

  /// Sets what the parameter server has. Throws ParameterError naming one that is unknown or not allowed.
  void read(const ros::NodeHandle& private_node) const;

 private:
  struct Entry {
    std::string name, allowed;
    Take take;
  };
  void take(const std::string& name, const std::string& text) const;
  void take_all(const std::string& prefix, XmlRpc::XmlRpcValue& values) const;

  std::vector<Entry> entries_;
};

}  // namespace mrhi
