#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "mr_hand_interaction/input_error.h"

namespace mrhi {

/// What a command line gives for an option: for reading it, and for saying what is wrong with it. What
/// refuses throws UsageError.
struct Given {
  std::string option, form, text;

  /// "OPTION 'TEXT' is not allowed; allowed: ..."
  [[noreturn]] void refuse(const std::string& allowed) const;
  /// "OPTION TEXT: WHAT; allowed: OPTION FORM"
  [[noreturn]] void fail(const std::string& what) const;

  double number(double lowest, double highest) const;
  long whole(long lowest, long highest) const;
  const std::string& one_of(const std::vector<std::string>& names) const;
  std::pair<std::string, std::string> setting() const;  ///< KEY=VALUE
  /// All between the commas from field `first` on, which are so many finite numbers.
  std::vector<double> numbers(std::size_t first, std::size_t count) const;
};

/// The options of a program, each said once: its name, the form of its value, and what takes it.
class CommandLine {
 public:
  using Take = std::function<void(const Given&)>;

  CommandLine& flag(const std::string& name, bool& on);
  CommandLine& once(const std::string& name, const std::string& form, const Take& take);
  CommandLine& once(const std::string& name, const std::string& form, std::string& text);
  CommandLine& each(const std::string& name, const std::string& form, const Take& take);
  /// Words that are no option's, which else are refused.
  CommandLine& words(const Take& take);

  /// Takes the words after the program's name, in their order. False as soon as one asks for --help or -h.
  /// Throws UsageError for what is not known, lacks its value, or is given twice where once is allowed.
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
