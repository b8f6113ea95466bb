#include "shape_kinds.h"

#include <cmath>
#include <limits>
#include <locale>
#include <sstream>

#include "../text/text.h"
#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {
namespace {

using Sizes = std::vector<double>;

const std::string kPrefix = ":shape:";

Sizes sizes(const Box& box) {
  const Vector3 size = 2.0 * box.half_extents;
  return {size.x(), size.y(), size.z()};
}
Sizes sizes(const Sphere& sphere) {
  return {sphere.radius};
}
template <typename Long>
Sizes sizes(const Long& shape) {
  return {shape.radius, 2.0 * shape.half_length};
}

template <typename Kind>
std::optional<Sizes> sizes_if(const Shape& shape) {
  const Kind* const one = std::get_if<Kind>(&shape);
  return one == nullptr ? std::nullopt : std::optional<Sizes>(sizes(*one));
}

/// What was given, be it no number that a size may be.
double size_in(const std::string& word) {
  std::istringstream stream(word);
  stream.imbue(std::locale::classic());
  double size = 0.0;
  if (stream >> size && stream.eof()) return size;
  const std::optional<double> other = text::to_number(word);  // infinity, and what is beyond a double
  return other && std::isinf(*other) ? *other : std::numeric_limits<double>::quiet_NaN();
}

template <typename Long>
Shape make_long(const Sizes& s) {
  return Long{s[0], 0.5 * s[1]};
}

}  // namespace

const std::vector<ShapeKind>& shape_kinds() {
  static const std::vector<ShapeKind> kinds{
      {"box",
       {"x", "y", "z"},
       [](const Sizes& s) -> Shape { return Box{0.5 * Vector3(s[0], s[1], s[2])}; },
       sizes_if<Box>},
      {"sphere", {"radius"}, [](const Sizes& s) -> Shape { return Sphere{s[0]}; }, sizes_if<Sphere>},
      {"cylinder", {"radius", "length"}, make_long<Cylinder>, sizes_if<Cylinder>},
      {"capsule", {"radius", "length"}, make_long<Pill>, sizes_if<Pill>},
  };
  return kinds;
}

const ShapeKind* find_shape_kind(const std::string& name) {
  for (const ShapeKind& kind : shape_kinds()) {
    if (kind.name == name) return &kind;
  }
  return nullptr;
}

std::string shape_kind_names() {
  std::vector<std::string> names;
  for (const ShapeKind& kind : shape_kinds()) names.push_back(kind.name);
  return text::joined(names);
}

std::string ShapeKind::describe(const std::vector<double>& size) const {
  if (size.size() == 3) return name + " size " + text::vector(Vector3(size[0], size[1], size[2]));
  std::string all = name;
  for (std::size_t i = 0; i < size.size(); ++i)
    all += (i == 0 ? " " : " and ") + sizes[i] + " " + text::number(size[i]);
  return all;
}

std::string as_filename(const GivenShape& shape) {
  std::string name = kPrefix + shape.kind->name;
  for (const double size : shape.size) name += " " + text::exact(size);
  return name;
}

bool is_hull(const std::string& filename) {
  return filename.compare(0, std::string(kHullPrefix).size(), kHullPrefix) == 0;
}

std::string without_hull(const std::string& filename) {
  return is_hull(filename) ? filename.substr(std::string(kHullPrefix).size()) : filename;
}

std::optional<GivenShape> from_filename(const std::string& filename) {
  if (filename.compare(0, kPrefix.size(), kPrefix) != 0) return std::nullopt;
  std::istringstream words(filename.substr(kPrefix.size()));
  words.imbue(std::locale::classic());
  std::string name;
  words >> name;
  GivenShape given{find_shape_kind(name), {}};
  if (given.kind == nullptr) return std::nullopt;
  for (std::string word; words >> word;) given.size.push_back(size_in(word));
  given.size.resize(given.kind->sizes.size(), 0.0);
  return given;
}

double bounding_radius(const Shape& shape) {
  return std::visit([](const auto& asked) { return asked.bounding_radius(); }, shape);
}

}  // namespace mrhi
