#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace mrhi {

/// Counts messages that have not arrived (a queue was full, or the way was), by the numbers that ROS gives
/// those of a publisher.
class SequenceWatch {
 public:
  /// How many are missing before this one. A number that goes back, or far ahead, begins anew.
  std::uint64_t missing(const std::string& publisher, std::uint32_t sequence) {
    constexpr std::uint32_t kFar = 1'000'000;
    const auto [known, is_new] = last_.emplace(publisher, sequence);
    const std::uint32_t step = sequence - known->second;
    known->second = sequence;
    return is_new || step == 0 || step > kFar ? 0 : step - 1;
  }

 private:
  std::map<std::string, std::uint32_t> last_;
};

}  // namespace mrhi
