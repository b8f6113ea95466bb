#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "../text/text.h"

namespace mrhi {

/// What a loader assumed: one line for each kind of assumption, with the things that it concerns.
class Warnings {
 public:
  /// `what` is the line's beginning, `item` a thing and its value.
  void add(const std::string& what, const std::string& item) {
    auto line = std::find_if(lines_.begin(), lines_.end(), [&](const auto& l) { return l.first == what; });
    if (line == lines_.end()) line = lines_.insert(line, {what, {}});
    if (std::find(line->second.begin(), line->second.end(), item) == line->second.end())
      line->second.push_back(item);
  }

  std::vector<std::string> lines() const {
    constexpr std::size_t kNamed = 4;
    std::vector<std::string> all;
    for (const auto& [what, items] : lines_) {
      std::vector<std::string> named(items.begin(), items.begin() + long(std::min(kNamed, items.size())));
      if (items.size() > kNamed) named.push_back("and " + std::to_string(items.size() - kNamed) + " more");
      all.push_back(text::one_line(what + ": " + text::joined(named), 600));
    }
    return all;
  }

 private:
  std::vector<std::pair<std::string, std::vector<std::string>>> lines_;
};

}  // namespace mrhi
