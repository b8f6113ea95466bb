#include "progress_bar.h"

#include <unistd.h>

#include <cstdio>

namespace mrhi {

ProgressBar::ProgressBar() : is_terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  wipe();
}

void ProgressBar::show(std::size_t position, std::size_t size) {
  constexpr int kWidth = 50;  // characters
  const int percent = size == 0 ? 100 : static_cast<int>(100 * position / size);
  if (!is_terminal_ || percent == percent_) return;
  percent_ = percent;
  const auto done = static_cast<std::size_t>(percent * kWidth / 100);
  const std::string bar = std::string(done, '#') + std::string(kWidth - done, '.');
  std::fprintf(stderr, "\r[%s] %3d %%", bar.c_str(), percent);
}

void ProgressBar::line(const std::string& text) {
  wipe();
  std::fprintf(stderr, "%s\n", text.c_str());
}

void ProgressBar::wipe() {
  if (percent_ >= 0) std::fputs("\r\033[K", stderr);
  percent_ = -1;
}

}  // namespace mrhi
