#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "mr_hand_interaction/input_error.h"

namespace mrhi {

/// Value of an option on the command line, with conversions and error messages. Failed conversions throw
/// UsageError.
struct OptionValue {
  std::string option, form, text;

  /// "OPTION 'TEXT' is not allowed; allowed: ..."
  [[noreturn]] void refuse(const std::string& allowed) const;
  /// "OPTION TEXT: WHAT; allowed: OPTION FORM"
  [[noreturn]] void fail(const std::string& what) const;

  double number(double lowest, double highest) const;
  long whole(long lowest, long highest) const;
  const std::string& one_of(const std::vector<std::string>& names) const;
  std::pair<std::string, std::string> setting() const;  ///< KEY=VALUE
  /// Comma-separated fields from `first` on, which must be `count` finite numbers.
  std::vector<double> numbers(std::size_t first, std::size_t count) const;
};

/// The options of a program: for each its name, the form of its value, and its handler.
class CommandLine {
 public:
  using Take = std::function<void(const OptionValue&)>;

  CommandLine& flag(const std::string& name, bool& on);
  CommandLine& once(const std::string& name, const std::string& form, const Take& take);
  CommandLine& once(const std::string& name, const std::string& form, std::string& text);
  CommandLine& each(const std::string& name, const std::string& form, const Take& take);
  /// Handler of words that belong to no option; without it they are refused.
  CommandLine& words(const Take& take);

  /// Handles the words after the program's name, in order. Returns false at the first --help or -h. Throws
  /// UsageError for an unknown option, a missing value, or a repeated option that may appear once.
  bool read(const std::vector<std::string>& words) const;

 private:
  struct Option {
    std::string name, form;
    bool repeats;
    Take take;
  };
  const Option* find(const std::string& name) const;
  std::string names() const;

  std::vector<Option> options_;
  Take words_;
};

}  // namespace mrhi
