#pragma once

#include <ros/ros.h>

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "../text/text.h"

namespace mrhi {

/// Body of a node, with its public and private handles.
using NodeBody = std::function<void(const ros::NodeHandle& node, const ros::NodeHandle& private_node)>;

/// main() of a node. Prints the usage for --help; one line, and returns 2, for arguments that are not
/// roslaunch's. Runs `body`, which ends with the node; an exception is logged as fatal, and 1 returned.
/// SIGTERM, SIGHUP and SIGQUIT end ros::spin() like SIGINT. Logs a lost or restarted ROS master.
int run_node(int argc, char** argv, const char* name, const char* usage, const NodeBody& body);

/// main() of a node that is an object, made from its handles and `Parameters`, while ROS spins.
template <class Node, class Parameters>
int run_node(int argc, char** argv, const char* name, const char* usage) {
  return run_node(argc, argv, name, usage, [](const auto& node, const auto& private_node) {
    const Node running(node, private_node, Parameters(private_node));
    ros::spin();
  });
}

/// Offers a service. `answer` takes the request and fills the response.
template <class Service, class Answer>
ros::ServiceServer serve(ros::NodeHandle& node, const char* name, const Answer& answer) {
  using Request = typename Service::Request;
  using Response = typename Service::Response;
  const auto handler = [answer](Request& request, Response& response) {
    answer(request, response);
    return true;
  };
  return node.advertiseService<Request, Response>(name, boost::function<bool(Request&, Response&)>(handler));
}

/// The private parameters of a node: for each its name, its allowed values, and its destination.
class NodeParameters {
 public:
  /// Parses the YAML text of a parameter; returns false if it is not allowed.
  using Take = std::function<bool(const std::string& name, const std::string& text)>;

  /// `allowed`: for messages. A name that ends with / stands for all parameters below it.
  NodeParameters& add(const std::string& name, const std::string& allowed, const Take& take);
  NodeParameters& text(const std::string& name, std::string& value);
  /// A text that must not be empty.
  NodeParameters& required(const std::string& name, const std::string& allowed, std::string& value);
  /// A number from `min` to `max`; messages append `more` to the limits.
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

  /// An integer of at least `min`.
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

  /// Reads all from the parameter server. Throws ParameterError with one that is unknown or invalid.
  void read(const ros::NodeHandle& private_node) const;

 private:
  struct Entry {
    std::string name, allowed;
    Take take;
    const std::string* required = nullptr;

    [[noreturn]] void refuse(const std::string& as, const std::string& text) const;
  };
  void take(const std::string& name, const std::string& text) const;
  void take_all(const std::string& prefix, XmlRpc::XmlRpcValue& values) const;

  std::vector<Entry> entries_;
};

}  // namespace mrhi
