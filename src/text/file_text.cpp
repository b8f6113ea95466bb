#include "file_text.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>

namespace mrhi {

std::optional<std::string> file_text(const std::string& file, std::size_t most) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return {};
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  if (!stream || error) return {};
  std::string text(static_cast<std::size_t>(std::min<std::uintmax_t>(size, most)), '\0');
  stream.read(&text[0], static_cast<std::streamsize>(text.size()));
  if (stream.bad()) return {};
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

}  // namespace mrhi
