#include "node.h"

#include <ros/init.h>

#include <iostream>
#include <string>
#include <vector>

namespace mrhi {

std::optional<int> status_of_arguments(int argc, char** argv, const char* usage) {
  std::vector<std::string> words;
  ros::removeROSArgs(argc, argv, words);
  if (words.size() < 2) return std::nullopt;
  if (words[1] == "--help" || words[1] == "-h") {
    std::cout << usage;
    return 0;
  }
  const std::string name = words[0].substr(words[0].rfind('/') + 1);
  std::cerr << name << ": unknown argument '" << words[1]
            << "'; allowed: --help; parameters and topics are set as _NAME:=VALUE and TOPIC:=OTHER\n";
  return 2;
}

}  // namespace mrhi
