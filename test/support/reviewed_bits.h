#pragma once

#include <gnu/libc-version.h>
#include <gtest/gtest.h>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

#include "mr_hand_interaction/math.h"
#include "replay/replay_files.h"

namespace mrhi::test {

inline std::string hexadecimal(std::uint64_t number) {
  char text[17];
  std::snprintf(text, sizeof text, "%016" PRIx64, number);
  return text;
}

/// The oracle of a restructuring: bits of what runs gave, one line each, as they were when somebody last
/// looked at what had changed them. With MR_HAND_WRITE_BITS=1 in the environment the table is written anew.
class ReviewedBits {
 public:
  ReviewedBits(std::string file, const std::string& columns)
      : file_(std::move(file)),
        write_(std::getenv("MR_HAND_WRITE_BITS") != nullptr),
        table_("# " + platform() + "\n" + columns + "\n") {
    for (const std::string& line : lines_of(file_)) {
      if (line[0] == '#') made_with_ = line.substr(2);
      const std::size_t name = line.rfind(',', line.rfind(',') - 1);
      if (line[0] != '#') reviewed_[line.substr(0, name)] = line.substr(name + 1);
    }
    EXPECT_TRUE(write_ || reviewed_.size() > 1) << file_ << " has no lines";
  }
  /// Why nothing can be compared here; else empty.
  std::string made_elsewhere() const {
    return write_ || made_with_ == platform()
               ? ""
               : file_ + " was made with " + made_with_ + "; this is " + platform();
  }
  /// `bits`: two numbers, with a comma between them.
  void compare(const std::string& name, const std::string& bits) {
    table_ += name + "," + bits + "\n";
    ++all_;
    if (reviewed_[name] == bits) return;
    changed_ += "\n  " + name;
    ++count_;
  }
  /// `suite`: of tests.
  void check(const std::string& suite) const {
    if (write_) std::ofstream(file_) << table_;
    EXPECT_TRUE(write_ || count_ == 0)
        << count_ << " of " << all_ << " runs have other bits than " << file_ << ":" << changed_
        << "\nIf that is meant, MR_HAND_WRITE_BITS=1 scripts/test " << suite
        << " writes the table anew; say in the commit which figures moved.";
  }

 private:
  /// What bits depend on beside the code: roots and logarithms are the C library's, and those of a processor
  /// with fused multiplication may differ in the last bit.
  static std::string platform() {
#if defined(__x86_64__)
    const char* processor = __builtin_cpu_supports("fma") ? "x86_64 with fma" : "x86_64";
#else
    const char* processor = "another processor";
#endif
    return "g++ " + std::to_string(__GNUC__) + "; glibc " + gnu_get_libc_version() + "; Eigen " +
           std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "; " + processor;
  }

  std::string file_, made_with_;
  bool write_;
  std::map<std::string, std::string> reviewed_;
  std::string table_, changed_;
  int all_ = 0, count_ = 0;
};

}  // namespace mrhi::test
