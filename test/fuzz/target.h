#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

// A target is a function of bytes that ends, without an exception, whatever they are. libFuzzer calls it
// under its own name; test_corpus.cpp, which has all of them in one program, by theirs.
#ifdef MRHI_CORPUS_TEST
#define FUZZ_TARGET(name)                                                   \
  static void fuzz_##name(const std::uint8_t* data, std::size_t size);      \
  static const mrhi::fuzzing::Registered kFuzz_##name{#name, &fuzz_##name}; \
  static void fuzz_##name(const std::uint8_t* data, std::size_t size)
#else
#define FUZZ_TARGET(name)                                                             \
  static void fuzz(const std::uint8_t* data, std::size_t size);                       \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    fuzz(data, size);                                                                 \
    return 0;                                                                         \
  }                                                                                   \
  static void fuzz(const std::uint8_t* data, std::size_t size)
#endif

namespace mrhi::fuzzing {

struct Target {
  std::string name;
  void (*run)(const std::uint8_t* data, std::size_t size);
};

inline std::vector<Target>& targets() {
  static std::vector<Target> all;
  return all;
}

struct Registered {
  Registered(const char* name, void (*run)(const std::uint8_t*, std::size_t)) {
    targets().push_back({name, run});
  }
};

/// No std::exception, so that nothing but test_corpus.cpp catches it.
struct Broken {
  std::string what;
};

/// What must hold whatever the input.
inline void require(bool holds, const std::string& what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what.c_str());
  throw Broken{what};
}

inline void require_one_line(const std::string& message) {
  require(!message.empty() && message.find('\n') == std::string::npos && message.size() < 2000,
          "an error is one line: " + message);
}

/// Texts that make one input, apart at lines of "%%"; missing ones are empty.
inline std::vector<std::string> parts_of(const std::uint8_t* data, std::size_t size, std::size_t count) {
  static const std::string kLine = "\n%%\n";
  const std::string all(reinterpret_cast<const char*>(data), size);
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end; parts.size() + 1 < count && (end = all.find(kLine, begin)) != std::string::npos;
       begin = end + kLine.size())
    parts.push_back(all.substr(begin, end - begin + 1));
  parts.push_back(all.substr(begin));
  parts.resize(count);
  return parts;
}

/// Numbers out of bytes; zero once they are used up.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  bool left() const { return at_ < size_; }
  std::uint8_t byte() { return at_ < size_ ? data_[at_++] : std::uint8_t{0}; }
  int below(int count) { return byte() % count; }
  bool one_in(int count) { return below(count) == count - 1; }
  double between(double least, double most) { return least + (most - least) * byte() / 255.0; }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

/// A folder of this process, for readers that take files; gone at its end.
class Folder {
 public:
  Folder() : path_(std::filesystem::temp_directory_path() / ("mrhi_fuzz_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary | std::ios::trunc) << text;
    return file(name);
  }
  void remove(const std::string& name) const { std::filesystem::remove_all(path_ / name); }

 private:
  std::filesystem::path path_;
};

inline const Folder& folder() {
  static const Folder only;
  return only;
}

}  // namespace mrhi::fuzzing
