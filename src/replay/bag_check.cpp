
#include <ros/exception.h>
#include <rosbag/exceptions.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <new>
#include <optional>

#include "../text/file_text.h"
#include "../text/text.h"
#include "bag_input.h"

namespace mrhi {
namespace {

const char* const kWhole = "; allowed: a whole bag (rosbag reindex or rosbag fix may save one)";
const std::string kMagic = "#ROSBAG V2.0\n";
constexpr std::uint32_t kLongestHeader = 1u << 20, kLargestChunk = 1u << 30;
enum Op : unsigned char { kIndex = 0x04, kChunk = 0x05, kChunkInfo = 0x06 };

using Fields = std::map<std::string, std::string>;

std::uint32_t number_at(const char* bytes) {
  std::uint32_t value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

std::optional<std::uint32_t> number_in(const Fields& fields, const char* name) {
  const auto field = fields.find(name);
  if (field == fields.end() || field->second.size() != 4) return {};
  return number_at(field->second.data());
}

/// "length, name=value" one after the other; nothing if they do not fill the header.
std::optional<Fields> fields_of(const std::string& header) {
  Fields fields;
  for (std::size_t at = 0; at < header.size();) {
    if (header.size() - at < 4) return {};
    const std::uint32_t length = number_at(&header[at]);
    at += 4;
    if (length > header.size() - at) return {};
    const std::string field = header.substr(at, length);
    const std::size_t equals = field.find('=');
    if (equals == std::string::npos || equals == 0) return {};
    fields[field.substr(0, equals)] = field.substr(equals + 1);
    at += length;
  }
  return fields;
}

class Walk {
 public:
  explicit Walk(const std::string& file) : file_(file), stream_(file, std::ios::binary) {
    stream_.seekg(0, std::ios::end);
    size_ = static_cast<std::uint64_t>(stream_.tellg());
  }

  void all() {
    if (bytes(0, kMagic.size()) != kMagic)
      throw BagError(file_ + ": is no bag; allowed: a bag of format 2.0");
    for (at_ = kMagic.size(); at_ < size_;) record();
  }

 private:
  void record() {
    const std::uint64_t begin = at_;
    const std::string header = bytes(begin + 4, length(begin, kLongestHeader));
    const std::uint64_t data = begin + 4 + header.size() + 4;
    const std::uint32_t data_length = length(data - 4, size_);
    const auto fields = fields_of(header);
    if (!fields || fields->count("op") == 0 || fields->at("op").size() != 1) fail(begin, "a header");
    const auto op = static_cast<unsigned char>(fields->at("op")[0]);
    if (op == kChunk) chunk(*fields, data, data_length);
    if (op == kIndex) index(*fields, data, data_length);
    if (op == kChunkInfo) chunk_info(*fields, data_length, begin);
    at_ = data + data_length;
  }

  void chunk(const Fields& fields, std::uint64_t data, std::uint32_t data_length) {
    const auto size = number_in(fields, "size");
    const auto compression = fields.find("compression");
    if (!size || *size > kLargestChunk || compression == fields.end()) fail(data, "a chunk");
    plain_ = compression->second == "none";
    if (plain_ && *size != data_length) fail(data, "a chunk's size");
    chunk_size_ = *size;
    chunk_ = plain_ ? bytes(data, data_length) : "";
  }

  void index(const Fields& fields, std::uint64_t data, std::uint32_t data_length) {
    constexpr std::uint32_t kEntry = 12;
    const auto count = number_in(fields, "count");
    if (!count || std::uint64_t(*count) * kEntry != data_length) fail(data, "an index");
    const std::string entries = bytes(data, data_length);
    for (std::uint32_t i = 0; i < *count; ++i) message(number_at(&entries[i * kEntry + 8]), data);
  }

  void message(std::uint64_t offset, std::uint64_t place) {
    if (offset >= chunk_size_) fail(place, "an index");
    if (!plain_) return;
    for (int part = 0; part < 2; ++part) {  // header, data
      if (chunk_.size() - offset < 4) fail(place, "a message");
      const std::uint64_t length = number_at(&chunk_[offset]);
      if (length > chunk_.size() - offset - 4) fail(place, "a message");
      if (part == 0 && !fields_of(chunk_.substr(offset + 4, length))) fail(place, "a message");
      offset += 4 + length;
    }
  }

  void chunk_info(const Fields& fields, std::uint32_t data_length, std::uint64_t begin) {
    const auto count = number_in(fields, "count");
    const auto place = fields.find("chunk_pos");
    if (!count || std::uint64_t(*count) * 8 != data_length || place == fields.end() ||
        place->second.size() != 8)
      fail(begin, "a chunk's place");
    std::uint64_t at;
    std::memcpy(&at, place->second.data(), sizeof at);
    if (at >= size_) fail(begin, "a chunk's place");
  }

  std::uint32_t length(std::uint64_t at, std::uint64_t most) {
    const std::uint32_t length = number_at(bytes(at, 4).data());
    if (length > most || length > size_ - at - 4) fail(at, "a length");
    return length;
  }

  std::string bytes(std::uint64_t at, std::uint64_t count) {
    if (at > size_ || count > size_ - at) fail(at, "the end of the file");
    std::string all(count, '\0');
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(at));
    if (!stream_.read(&all[0], static_cast<std::streamsize>(count))) fail(at, "the end of the file");
    return all;
  }

  [[noreturn]] void fail(std::uint64_t at, const std::string& what) const {
    throw BagError(file_ + ": is corrupt: " + what + " at byte " + std::to_string(at) + kWhole);
  }

  const std::string& file_;
  std::ifstream stream_;
  std::uint64_t size_ = 0, at_ = 0;
  std::string chunk_;  // of the last chunk record, if it is not compressed
  std::uint64_t chunk_size_ = 0;
  bool plain_ = false;
};

}  // namespace

void check_bag(const std::string& file) {
  Walk(file).all();
}

/// The bag library says no more than that it cannot open it.
void check_readable(const std::string& file) {
  const std::string why = why_unreadable(file);
  if (!why.empty()) throw BagError(file + ": " + why + "; allowed: a bag that may be read");
  check_bag(file);
}

void refuse_bag(const std::string& file) {
  try {
    throw;
  } catch (const rosbag::BagException& error) {
    throw BagError(file + ": is corrupt: " + text::one_line(error.what()) + kWhole);
  } catch (const ros::Exception& error) {
    throw BagError(file + ": is corrupt: " + text::one_line(error.what()) + kWhole);
  } catch (const std::bad_alloc&) {
    throw BagError(file + ": is corrupt: it asks for more memory than there is" + kWhole);
  }
}

}  // namespace mrhi
