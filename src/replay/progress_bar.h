#pragma once

#include <cstddef>
#include <string>

namespace mrhi {

/// A progress bar on stderr if that is a terminal; lines written through it stay readable.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();

  void show(std::size_t position, std::size_t size);
  void line(const std::string& text);

 private:
  void wipe();

  bool is_terminal_;
  int percent_ = -1;
};

}  // namespace mrhi
