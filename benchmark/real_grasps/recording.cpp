#include "recording.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <utility>

#include "mr_hand_interaction/replay/recording_csv.h"
#include "mr_hand_interaction/synthetic/random.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "text/yaml.h"

namespace mrhi::real_grasps {
namespace {

namespace fs = std::filesystem;

Vector3 in_world(const std::optional<Vector3>& point) {
  if (!point) return Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
  return {point->x(), -point->z(), point->y()};
}

Sighting sighting(const HandJoints& hand, std::size_t frame, double time) {
  Sighting result{hand.id, frame, time, {}, in_world(hand.palm_centre)};
  for (std::size_t f = 0; f < kFingers; ++f)
    for (std::size_t j = 0; j < 5; ++j) result.joints[f][j] = in_world(hand.joints[f][j]);
  return result;
}

bool is_recording(const fs::path& file) {
  std::string header;
  return file.extension() == ".csv" && std::getline(std::ifstream(file), header) &&
         header.compare(0, 6, "time_s") == 0;
}

using Point = std::optional<Vector3>;

Point between(const Point& from, const Point& to, double part) {
  return from && to ? Point(*from + part * (*to - *from)) : std::nullopt;
}

HandJoints between(const HandJoints& from, const HandJoints& to, double part) {
  HandJoints hand = from;
  hand.palm_centre = between(from.palm_centre, to.palm_centre, part);
  hand.wrist = between(from.wrist, to.wrist, part);
  for (std::size_t f = 0; f < kFingers; ++f)
    for (std::size_t j = 0; j < 5; ++j) hand.joints[f][j] = between(from.joints[f][j], to.joints[f][j], part);
  return hand;
}

/// Interpolates the hands of both frames.
JointsFrame between(const JointsFrame& from, const JointsFrame& to, Nanoseconds stamp) {
  JointsFrame frame;
  frame.stamp = stamp;
  const double part = to_seconds(stamp - from.stamp) / to_seconds(to.stamp - from.stamp);
  for (const HandJoints& hand : from.hands) {
    for (const HandJoints& next : to.hands)
      if (next.id == hand.id) frame.hands.push_back(between(hand, next, part));
  }
  return frame;
}

std::vector<JointsFrame> resampled(const std::vector<JointsFrame>& frames, double rate) {
  std::vector<JointsFrame> result;
  const auto period = static_cast<Nanoseconds>(std::llround(1e9 / rate));
  Nanoseconds stamp = frames.front().stamp;
  for (std::size_t next = 1; next < frames.size(); ++next) {
    if (frames[next].stamp <= frames[next - 1].stamp) continue;
    for (; stamp <= frames[next].stamp; stamp += period)
      result.push_back(between(frames[next - 1], frames[next], stamp));
  }
  return result;
}

/// Object in a recording's description; empty if none. JSON is YAML.
std::string object_of(const fs::path& description) {
  if (!fs::exists(description)) return "";
  return read_yaml<RecordingError>(description.string(), [&]() -> std::string {
    const YAML::Node node = load_yaml_file(description.string())["object"];
    if (!node) return "";
    for (const char* object : kObjects)
      if (node.IsScalar() && node.Scalar() == object) return object;
    throw RecordingError(description.string() + ": object '" + yaml_text(node) +
                         "' is not allowed; allowed: none, seen, felt");
  });
}

void add_noise(HandJoints& hand, double noise, Random& random) {
  if (hand.palm_centre) *hand.palm_centre += random.gaussian_vector(noise);
  if (hand.wrist) *hand.wrist += random.gaussian_vector(noise);
  const bool empty_metacarpal = hand.joints[0][0] && hand.joints[0][0] == hand.joints[0][1];
  for (auto& finger : hand.joints)
    for (auto& joint : finger)
      if (joint) *joint += random.gaussian_vector(noise);
  if (empty_metacarpal) hand.joints[0][0] = hand.joints[0][1];  // as in Leap's model of the thumb
}

}  // namespace

Pose device_mount() {
  return default_device_mount();
}

Recording make_recording(std::string name, std::vector<JointsFrame> frames) {
  Recording recording{std::move(name), "", std::move(frames), {}, {}};
  std::vector<std::uint32_t> ids;
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    const JointsFrame& frame = recording.frames[i];
    recording.sightings.emplace_back();
    for (const HandJoints& hand : frame.hands) {
      const auto track = static_cast<std::size_t>(std::find(ids.begin(), ids.end(), hand.id) - ids.begin());
      if (track == ids.size()) ids.push_back(hand.id), recording.tracks.emplace_back();
      recording.sightings.back().push_back(sighting(hand, i, to_seconds(frame.stamp)));
      recording.tracks[track].push_back(recording.sightings.back().back());
    }
  }
  return recording;
}

Recording load_recording(const std::string& file) {
  Recording recording = make_recording(fs::path(file).stem().string(), read_recording_csv(file));
  recording.object = object_of(fs::path(file).replace_extension(".meta.json"));
  return recording;
}

std::vector<std::string> recording_files(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    if (!fs::is_directory(path)) {
      if (!fs::exists(path)) throw std::runtime_error(path + ": no such file or folder");
      files.push_back(path);
      continue;
    }
    const std::size_t first = files.size();
    for (const auto& entry : fs::directory_iterator(path))
      if (is_recording(entry.path())) files.push_back(entry.path().string());
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(first), files.end());
  }
  return files;
}

std::vector<JointsFrame> disturbed(const std::vector<JointsFrame>& frames, std::size_t first,
                                   std::size_t last, const Disturbance& disturbance) {
  const auto at = [&](std::size_t i) { return frames.begin() + static_cast<std::ptrdiff_t>(i); };
  std::vector<JointsFrame> result(at(first), at(last + 1));
  if (disturbance.rate) result = resampled(result, *disturbance.rate);
  if (disturbance.noise == 0.0) return result;
  Random random(disturbance.seed);
  for (JointsFrame& frame : result)
    for (HandJoints& hand : frame.hands) add_noise(hand, disturbance.noise, random);
  return result;
}

}  // namespace mrhi::real_grasps
