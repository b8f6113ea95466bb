#include "untrusted_input.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <exception>
#include <fstream>
#include <new>
#include <stdexcept>

namespace mrhi {
namespace {

constexpr int kMaxXmlDepth = 32;
constexpr std::size_t kMaxElements = 100'000;
constexpr std::size_t kMaxAttributes = 64;  // per element: libraries compare each with all before it

bool has_control_characters(const std::string& xml) {
  return std::any_of(xml.begin(), xml.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\r' && c != '\t';
  });
}

/// Scans tags without building a document.
class Tags {
 public:
  explicit Tags(const std::string& xml) : xml_(xml) {}

  void follow() {
    while ((at_ = xml_.find('<', at_)) != std::string::npos) {
      if (begins("<!--")) {
        skip_to("-->", 4);
      } else if (begins("<![CDATA[")) {
        skip_to("]]>", 9);
      } else if (begins("<?xml")) {
        instruction();
      } else if (begins("<!")) {
        declares = true;
        skip_to(">", 2);
      } else if (at_ + 1 < xml_.size() && begins_name(xml_[at_ + 1])) {
        tag();
      } else {
        strange = true;
        ++at_;
      }
    }
  }

  std::size_t elements = 0, attributes = 0;  ///< of all tags; the largest number of one
  int deepest = 0;
  bool declares = false;  ///< a document type
  bool strange = false;   ///< a '<' that begins nothing known

 private:
  bool begins(const char* text) const { return xml_.compare(at_, std::string(text).size(), text) == 0; }

  /// True if it begins the tag of an element or its closing tag.
  static bool begins_name(char c) {
    return c == '/' || c == '_' || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           static_cast<unsigned char>(c) >= 0x80;
  }

  /// Searches behind the opening: "<!-->" does not close itself.
  void skip_to(const char* end, std::size_t opening) {
    const std::size_t found = xml_.find(end, at_ + opening);
    at_ = found == std::string::npos ? xml_.size() : found + 1;
  }

  /// TinyXML ends an instruction at its first '>', other libraries at the first "?>": both must be the same
  /// place.
  void instruction() {
    skip_to(">", 5);
    if (at_ < 2 || xml_[at_ - 2] != '?') strange = true;
  }

  /// A '>' in quotes does not end a tag.
  void tag() {
    const bool closes = begins("</");
    char quote = 0;
    std::size_t here = 0;
    for (++at_; at_ < xml_.size() && (quote || xml_[at_] != '>'); ++at_) {
      if (!quote && xml_[at_] == '=') ++here;
      if (quote ? xml_[at_] == quote : xml_[at_] == '"' || xml_[at_] == '\'') quote = quote ? 0 : xml_[at_];
    }
    attributes = std::max(attributes, here);
    if (closes) {
      depth_ = std::max(0, depth_ - 1);
      return;
    }
    ++elements;
    deepest = std::max(deepest, depth_ + 1);
    if (xml_[at_ - 1] != '/') ++depth_;
  }

  const std::string& xml_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

constexpr char kResultMark = 'd', kErrorMark = 'f';

// Sanitizers reserve terabytes of address space.
#ifndef __has_feature  // clang's
#define __has_feature(name) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || __has_feature(address_sanitizer) || \
    __has_feature(thread_sanitizer)
constexpr bool kMemoryIsLimited = false;
#else
constexpr bool kMemoryIsLimited = true;
#endif

/// Address space in use by this process.
rlim_t own_address_space() {
  std::ifstream pages("/proc/self/statm");
  rlim_t size = 0;
  pages >> size;
  return size * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

template <class Resource>
void limit(Resource resource, rlim_t value) {
  const rlimit both{value, value};
  setrlimit(resource, &both);
}

/// Suppresses a library's output when the child process dies.
void discard_output() {
  const int null_device = open("/dev/null", O_WRONLY);
  if (null_device < 0) return;
  dup2(null_device, STDOUT_FILENO);
  dup2(null_device, STDERR_FILENO);
}

void write_all(int to, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t written = write(to, text.data() + at, text.size() - at);
    if (written < 0 && errno != EINTR) return;
    if (written > 0) at += static_cast<std::size_t>(written);
  }
}

[[noreturn]] void run_and_exit(int to, rlim_t memory, const ChildLimits& limits,
                               const std::function<std::string()>& work) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGSEGV, SIGABRT, SIGALRM}) std::signal(signal, SIG_DFL);
  itimerval time{};  // ends it by SIGALRM, also while it waits
  time.it_value.tv_sec = static_cast<time_t>(limits.seconds);
  time.it_value.tv_usec =
      std::max<suseconds_t>(1, static_cast<suseconds_t>(1e6 * (limits.seconds - std::floor(limits.seconds))));
  setitimer(ITIMER_REAL, &time, nullptr);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  discard_output();
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, static_cast<rlim_t>(std::ceil(limits.seconds)));
  if (kMemoryIsLimited) limit(RLIMIT_AS, memory);
  try {
    write_all(to, kResultMark + work());
  } catch (const std::bad_alloc&) {
    write_all(to, std::string(1, kErrorMark) + "takes more memory than is allowed");
  } catch (const std::exception& error) {
    write_all(to, kErrorMark + std::string(error.what()));
  }
  _exit(0);
}

/// Reads until the other end is closed; empty if a limit is exceeded, or once it is cancelled.
std::string read_all(int from, const ChildLimits& limits, const std::function<bool()>& is_cancelled) {
  constexpr int kPeriod = 100;  // between two questions whether it is cancelled [ms]
  std::string text;
  char part[1 << 16];
  while (text.size() <= limits.output) {
    if (is_cancelled && is_cancelled()) return "";
    pollfd ready{from, POLLIN, 0};
    const int count = poll(&ready, 1, kPeriod);
    if (count == 0 || (count < 0 && errno == EINTR)) continue;
    if (count < 0) return "";
    const ssize_t got = read(from, part, sizeof part);
    if (got == 0) return text;
    if (got > 0) text.append(part, static_cast<std::size_t>(got));
    if (got < 0 && errno != EINTR) return "";
  }
  return "";
}

}  // namespace

std::size_t utf8_length(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[at + i]); };
  const unsigned char lead = byte(0);
  const std::size_t length = lead < 0x80 ? 1 : lead < 0xC2 ? 0 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  if (lead > 0xF4 || at + length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  return length;
}

bool is_utf8(const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    if (length == 0) return false;
    at += length;
  }
  return true;
}

std::optional<std::string> xml_danger(const std::string& xml) {
  if (xml.size() > kMaxXmlBytes)
    return "is longer than " + std::to_string(kMaxXmlBytes) + " bytes; allowed: at most that";
  if (has_control_characters(xml) || !is_utf8(xml))
    return "is no text; allowed: UTF-8 or ISO-8859-1 without control characters";
  Tags tags(xml);
  tags.follow();
  if (tags.declares) return "has a document type; allowed: none";
  if (tags.strange)
    return "has a '<' that begins nothing known; allowed: elements, comments, CDATA and <?xml ...?>";
  if (tags.deepest > kMaxXmlDepth)
    return "elements are nested deeper than " + std::to_string(kMaxXmlDepth) +
           " levels; allowed: at most that";
  if (tags.elements > kMaxElements)
    return std::to_string(tags.elements) + " elements; allowed: at most " + std::to_string(kMaxElements);
  if (tags.attributes > kMaxAttributes)
    return "an element has " + std::to_string(tags.attributes) + " attributes; allowed: at most " +
           std::to_string(kMaxAttributes);
  return {};
}

std::string run_in_child(const ChildLimits& limits, const std::function<std::string()>& work,
                         const std::function<bool()>& is_cancelled) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("cannot be read: no pipe to be had");
  const rlim_t memory = own_address_space() + limits.memory;
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    run_and_exit(ends[1], memory, limits, work);
  }
  close(ends[1]);
  const std::string output = child < 0 ? "" : read_all(ends[0], limits, is_cancelled);
  close(ends[0]);
  if (child > 0) {
    kill(child, SIGKILL);  // finished, or to be ended
    while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (output.empty() && is_cancelled && is_cancelled()) throw std::runtime_error("is cancelled");
  if (output.empty())
    throw std::runtime_error("takes more time or memory than is allowed, or cannot be read");
  if (output[0] == kResultMark) return output.substr(1);
  throw std::runtime_error(output.substr(1));
}

}  // namespace mrhi
