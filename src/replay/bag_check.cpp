#include <ros/exception.h>
#include <rosbag/bag.h>
#include <rosbag/exceptions.h>
#include <rosbag/view.h>

#include <filesystem>
#include <new>
#include <vector>

#include "../text/file_text.h"
#include "../text/limited_child.h"
#include "../text/text.h"
#include "bag_input.h"

namespace mrhi {
namespace {

const char* const kWhole = "; allowed: a whole bag (rosbag reindex or rosbag fix may save one)";

/// Reads every message, as a replay of all topics would.
std::string read_all(const std::string& file) {
  const rosbag::Bag bag(file, rosbag::bagmode::Read);
  std::vector<std::uint8_t> bytes;
  rosbag::View view(bag);
  for (const rosbag::MessageInstance& message : view) {
    bytes.resize(message.size());
    ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    message.write(stream);
  }
  return "";
}

ChildLimits limits_for(const std::string& file) {
  constexpr std::size_t kMemory = std::size_t{2} << 30, kOutput = 1 << 16;
  constexpr std::uintmax_t kSlowest = 10u << 20;  // bytes a second, compressed
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  return {30 + static_cast<int>(error ? 0 : size / kSlowest), kMemory, kOutput};
}

}  // namespace

/// The bag library takes every length on trust, and says no more than that it cannot open a file.
void check_readable(const std::string& file) {
  const std::string why = why_unreadable(file);
  if (!why.empty()) throw BagError(file + ": " + why + "; allowed: a bag that may be read");
  try {
    run_in_child(limits_for(file), [&file] { return read_all(file); });
  } catch (const std::runtime_error& error) {
    throw BagError(file + ": is corrupt: " + text::one_line(error.what()) + kWhole);
  }
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
