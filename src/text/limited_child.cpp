#include "limited_child.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <exception>
#include <fstream>
#include <new>
#include <stdexcept>

namespace mrhi {
namespace {

constexpr char kDone = 'd', kFailed = 'f';

// Sanitizers keep terabytes of addresses for themselves.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kMemoryIsLimited = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool kMemoryIsLimited = false;
#else
constexpr bool kMemoryIsLimited = true;
#endif
#else
constexpr bool kMemoryIsLimited = true;
#endif

/// Addresses that this process has in use.
rlim_t size_of_this() {
  std::ifstream pages("/proc/self/statm");
  rlim_t size = 0;
  pages >> size;
  return size * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

template <class Resource>
void limit(Resource resource, rlim_t most) {
  const rlimit both{most, most};
  setrlimit(resource, &both);
}

/// What a library has to say as it dies is of no use to anybody.
void be_silent() {
  const int nowhere = open("/dev/null", O_WRONLY);
  if (nowhere < 0) return;
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
}

void write_all(int to, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t written = write(to, text.data() + at, text.size() - at);
    if (written < 0 && errno != EINTR) return;
    if (written > 0) at += static_cast<std::size_t>(written);
  }
}

[[noreturn]] void be_child(int to, rlim_t memory, const ChildLimits& limits,
                           const std::function<std::string()>& work) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGSEGV, SIGABRT}) std::signal(signal, SIG_DFL);
  be_silent();
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, static_cast<rlim_t>(limits.seconds));
  if (kMemoryIsLimited) limit(RLIMIT_AS, memory);
  try {
    write_all(to, kDone + work());
  } catch (const std::bad_alloc&) {
    write_all(to, std::string(1, kFailed) + "takes more memory than is allowed");
  } catch (const std::exception& error) {
    write_all(to, kFailed + std::string(error.what()));
  }
  _exit(0);
}

/// All that comes until the other end is closed; less if it is too much or takes too long.
std::string read_all(int from, const ChildLimits& limits) {
  constexpr int kMilliseconds = 1000, kPatience = 4;
  std::string text;
  char part[1 << 16];
  while (text.size() <= limits.output) {
    pollfd ready{from, POLLIN, 0};
    const int told = poll(&ready, 1, kPatience * kMilliseconds * limits.seconds);
    if (told < 0 && errno == EINTR) continue;
    if (told <= 0) return "";
    const ssize_t got = read(from, part, sizeof part);
    if (got == 0) break;
    if (got > 0) text.append(part, static_cast<std::size_t>(got));
    if (got < 0 && errno != EINTR) return "";
  }
  return text.size() <= limits.output ? text : "";
}

}  // namespace

std::string run_in_child(const ChildLimits& limits, const std::function<std::string()>& work) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("cannot be read: no pipe to be had");
  const rlim_t memory = size_of_this() + limits.memory;
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    be_child(ends[1], memory, limits, work);
  }
  close(ends[1]);
  const std::string answer = child < 0 ? "" : read_all(ends[0], limits);
  close(ends[0]);
  if (child > 0) {
    kill(child, SIGKILL);  // done already, or to be ended
    while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (answer.empty())
    throw std::runtime_error("takes more time or memory than is allowed, or cannot be read");
  if (answer[0] == kDone) return answer.substr(1);
  throw std::runtime_error(answer.substr(1));
}

}  // namespace mrhi
