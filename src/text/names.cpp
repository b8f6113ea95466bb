#include "text.h"

namespace mrhi {

const char* const kNameIs = "1 to 64 letters, digits, '_' and '-', not first '-'";

bool is_name(const std::string& text) {
  const char* const known = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  return !text.empty() && text.size() <= 64 && text.front() != '-' &&
         text.find_first_not_of(known) == std::string::npos;
}

}  // namespace mrhi
