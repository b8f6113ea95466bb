#include "touched_points.h"

#include <algorithm>
#include <fstream>
#include <iomanip>
#include <locale>
#include <sstream>

#include "../text/file_text.h"
#include "../text/safe_yaml.h"
#include "../text/text.h"
#include "../text/yaml_values.h"

namespace mrhi {
namespace {

constexpr double kLargestRadius = 0.03;  // [m]

/// One entry of the list, with its place for messages.
class PointReader {
 public:
  PointReader(const std::string& file, const YAML::Node& node) : file_(file), node_(node) {
    if (!node.IsMap()) refuse(node, "point", "a map with " + text::joined(kKeys));
    for (const auto& entry : node) {
      const std::string key = yaml_text(entry.first);
      if (std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end())
        fail(entry.first, "unknown key '" + key + "'; allowed: " + text::joined(kKeys));
    }
  }

  TouchedPoint read(std::size_t number) const {
    TouchedPoint point;
    point.name = node_["name"] ? yaml_text(node_["name"]) : std::to_string(number);
    const auto world = vector("world");
    if (!world) fail(node_, "point " + point.name + ": world is missing");
    point.world = *world;
    if (const auto normal = vector("normal")) {
      if (normal->norm() < 1e-6) refuse(node_["normal"], "normal", "a direction other than [0, 0, 0]");
      point.normal = normal->normalized();
    }
    point.device = vector("device");
    if (const YAML::Node radius = node_["radius"]) point.radius = radius_of(radius);
    return point;
  }

 private:
  inline static const std::vector<std::string> kKeys{"name", "world", "normal", "device", "radius"};

  [[noreturn]] void fail(const YAML::Node& at, const std::string& what) const {
    throw PointsError(yaml_place(file_, at.Mark()) + ": " + what);
  }
  [[noreturn]] void refuse(const YAML::Node& at, const std::string& what, const std::string& allowed) const {
    fail(at, what + ": " + yaml_text(at) + " is not allowed; allowed: " + allowed);
  }
  std::optional<Vector3> vector(const std::string& key) const {
    const YAML::Node given = node_[key];
    if (!given) return {};
    const auto value = yaml_vector(given);
    if (!value) refuse(given, key, "three finite numbers [x, y, z]");
    return value;
  }
  double radius_of(const YAML::Node& given) const {
    const Range range{0.0, kLargestRadius};
    const auto value = yaml_number(given);
    if (!value || !range.contains(*value)) refuse(given, "radius", range.describe() + " [m]");
    return *value;
  }

  const std::string& file_;
  YAML::Node node_;
};

std::ostringstream plain_stream(int digits) {
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream << std::fixed << std::setprecision(digits);
  return stream;
}

std::string list(const Vector3& v) {
  auto stream = plain_stream(6);
  stream << '[' << v.x() << ", " << v.y() << ", " << v.z() << ']';
  return stream.str();
}

}  // namespace

std::vector<TouchedPoint> read_points(const std::string& file) {
  return read_yaml<PointsError>(file, [&] {
    const YAML::Node root = load_yaml_file(file);
    const YAML::Node list = root.IsMap() ? root["points"] : YAML::Node();
    if (!list || !list.IsSequence()) throw PointsError(file + ": no list named points");
    std::vector<TouchedPoint> points;
    for (const auto& node : list) points.push_back(PointReader(file, node).read(points.size() + 1));
    return points;
  });
}

void write_points(const std::string& file, const std::vector<TouchedPoint>& points) {
  std::ofstream out = file_to_write(file);
  out << "points:\n";
  for (const TouchedPoint& point : points) {
    YAML::Emitter name;
    name << YAML::DoubleQuoted << point.name;
    out << "  - {name: " << name.c_str() << ", world: " << list(point.world);
    if (!point.normal.isZero()) out << ", normal: " << list(point.normal);
    if (point.device)
      out << ", device: " << list(*point.device) << ", radius: " << text::number(point.radius);
    out << "}\n";
  }
  out.flush();
  if (!out) throw PointsError(file + ": cannot be written");
}

RigidFit fit_mount(const std::vector<TouchedPoint>& points) {
  std::vector<PointPair> pairs;
  for (const TouchedPoint& point : points) {
    if (!point.device) throw FitError("point " + point.name + " has not been touched");
    pairs.push_back({*point.device, point.tip_in_world()});
  }
  return fit_rigid(pairs);
}

void check_places(const std::vector<TouchedPoint>& points) {
  std::vector<PointPair> pairs;
  pairs.reserve(points.size());
  for (const TouchedPoint& point : points) pairs.push_back({point.world, point.world});
  fit_rigid(pairs);
}

namespace {

constexpr double kClearly = 0.5;  // of the rms with all points

struct OddOne {
  const TouchedPoint* point;
  double rms_without;
};

/// The point without which the others fit best. It draws the fit towards itself, so that the largest residual
/// may be at another one. Nothing for fewer than five points: four of them would tell too little.
std::optional<OddOne> odd_one_out(const std::vector<TouchedPoint>& points) {
  constexpr std::size_t kFewestLeft = 5;
  if (points.size() < kFewestLeft) return {};
  std::optional<OddOne> odd;
  for (const TouchedPoint& point : points) {
    std::vector<TouchedPoint> others;
    for (const TouchedPoint& other : points)
      if (&other != &point) others.push_back(other);
    try {
      const double rms = fit_mount(others).rms;
      if (!odd || rms < odd->rms_without) odd = OddOne{&point, rms};
    } catch (const FitError&) {
      // On one line without it: it is needed, and nothing is known of it.
    }
  }
  return odd;
}

}  // namespace

void check_residual(const std::vector<TouchedPoint>& points, const RigidFit& fit, double largest) {
  if (fit.rms <= largest) return;
  const auto worst = std::max_element(fit.residuals.begin(), fit.residuals.end());
  const TouchedPoint& point = points[static_cast<std::size_t>(worst - fit.residuals.begin())];
  auto stream = plain_stream(1);
  stream << "the residual is too large: rms " << 1e3 * fit.rms << " mm, ";
  if (const auto odd = odd_one_out(points); odd && odd->rms_without < kClearly * fit.rms) {
    stream << "but " << 1e3 * odd->rms_without << " mm without " << odd->point->name;
  } else {
    stream << 1e3 * *worst << " mm at " << point.name;
  }
  stream << "; allowed: rms " << 1e3 * largest
         << " mm (are the points in metres, and touched in their order?)";
  throw FitError(stream.str());
}

std::string residual_table(const std::vector<TouchedPoint>& points, const RigidFit& fit) {
  auto stream = plain_stream(2);
  for (std::size_t i = 0; i < points.size(); ++i)
    stream << "residual of " << points[i].name << ": " << 1e3 * fit.residuals[i] << " mm\n";
  stream << "rms: " << 1e3 * fit.rms << " mm\n";
  return stream.str();
}

std::string mount_text(const Pose& device_in_world) {
  const Vector3& p = device_in_world.position;
  Quaternion q = device_in_world.orientation;
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  auto stream = plain_stream(6);
  for (const double value : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z()}) stream << value << ' ';
  stream << q.w();
  return stream.str();
}

}  // namespace mrhi
