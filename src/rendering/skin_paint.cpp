#include "skin_paint.h"

#include <algorithm>
#include <cmath>

#include "light.h"
#include "skin_rig.h"

namespace mrhi {
namespace {

// A touch is seen around its middle as far as this, in radii of what presses.
constexpr double kSpot = 2.0, kSpotCore = 1.1;
constexpr double kLightTouch = 0.8;  // how red it is without force
constexpr double kFirm = 6.0;        // and with this force it is as red as it gets [N]
constexpr float kOcclusion = 0.7f, kDarkest = 0.4f;

/// A sphere for each phalanx, as large as the phalanx is seen from its side, in arrays that vector
/// instructions like; the last one is nothing.
constexpr int kSpheres = 16;
using Floats = Eigen::Array<float, kSpheres, 1>;

constexpr int sphere_of(int finger, int bone) {
  return finger * (kBonesPerFinger - 1) + bone - 1;
}

/// Seen from its side a capsule is 2 r l + pi r^2 large, as is a disc of R^2 = 2 r l / pi + r^2.
struct Occluders {
  Floats x = Floats::Zero(), y = Floats::Zero(), z = Floats::Zero(), squared = Floats::Zero();

  explicit Occluders(const Hand& hand) {
    for (int f = 0; f < kFingers; ++f) {
      for (int b = 1; b < kBonesPerFinger; ++b) {
        const Capsule& capsule = hand.capsules[static_cast<std::size_t>(capsule_index(f, b))];
        const Vector3 centre = capsule.centre();
        const double length = (capsule.end - capsule.start).norm(), r = capsule.radius;
        const int i = sphere_of(f, b);
        x[i] = static_cast<float>(centre.x());
        y[i] = static_cast<float>(centre.y());
        z[i] = static_cast<float>(centre.z());
        squared[i] = static_cast<float>(2.0 / M_PI * r * length + r * r);
      }
    }
  }

  /// Share of the light from all around that is left; `counts` is 0 for the spheres that do not count. A
  /// sphere of radius R at the distance d takes (n.d / |d|) (R / |d|)^2 of the light that comes evenly from
  /// the half space of n, while it is above the horizon; several are summed, as if none covered another. 1e-6
  /// m^2 keeps one about the place itself from dividing by 0.
  float left(const Eigen::Vector3f& p, const Eigen::Vector3f& n, const Floats& counts) const {
    const Floats dx = x - p.x(), dy = y - p.y(), dz = z - p.z();
    const Floats d = dx * dx + dy * dy + dz * dz + 1e-6f;
    const Floats facing = (dx * n.x() + dy * n.y() + dz * n.z()).max(0.0f);
    return std::max(kDarkest, 1.0f - kOcclusion * (counts * squared * facing / (d * d.sqrt())).sum());
  }
};

/// A phalanx is not covered by itself and its neighbours, nor the palm by what grows out of it.
std::array<Floats, kCapsules> make_counts() {
  std::array<Floats, kCapsules> counts;
  for (int own = 0; own < kCapsules; ++own) {
    Floats& row = counts[static_cast<std::size_t>(own)];
    row.setZero();
    for (int f = 0; f < kFingers; ++f) {
      for (int b = 1; b < kBonesPerFinger; ++b) {
        const bool palm = own == kPalm || bone_of(own) == 0;
        const bool near = palm ? b == 1 : finger_of(own) == f && std::abs(bone_of(own) - b) <= 1;
        row[sphere_of(f, b)] = near ? 0.0f : 1.0f;
      }
    }
  }
  return counts;
}

}  // namespace

/// How much of the touching colour a vertex takes: of the touches of its own finger, or the palm's.
float SkinPaint::redness(std::size_t vertex, const Vector3& place, const RenderedHand& rendered,
                         const std::vector<int>& touched) const {
  const int own = skin_.model().looks[vertex].capsule;
  double red = 0.0;
  for (const int c : touched) {
    const bool palm = c == kPalm || bone_of(c) == 0, on_palm = own == kPalm || bone_of(own) == 0;
    if (palm != on_palm || (!palm && finger_of(c) != finger_of(own))) continue;
    const auto i = static_cast<std::size_t>(c);
    const double radius = rendered.hand.capsules[i].radius;
    const double away = (place - rendered.pressed[i].point).norm();
    const double firm = kLightTouch + (1.0 - kLightTouch) * std::min(1.0, rendered.pressed[i].force / kFirm);
    red = std::max(red, firm * smooth_step(kSpot * radius, kSpotCore * radius, away));
  }
  return static_cast<float>(red);
}

void SkinPaint::paint(const RenderedHand& rendered, const SkinSurface& surface, std::vector<Rgb>& colours,
                      const SkinTone& tone) const {
  static const std::array<Floats, kCapsules> counts = make_counts();
  const Occluders occluders(rendered.hand);
  std::vector<int> touched;
  for (int c = 0; c < kCapsules; ++c) {
    if (rendered.touching[static_cast<std::size_t>(c)]) touched.push_back(c);
  }
  colours.resize(surface.vertices.size());
  for (std::size_t v = 0; v < colours.size(); ++v) {
    const SkinModel::Look& look = skin_.model().looks[v];
    const float red = redness(v, surface.vertices[v], rendered, touched);
    const Rgb skin = tone.skin * look.colour;
    const Rgb colour = skin + red * (tone.touching - skin);
    const Eigen::Vector3f normal = surface.normals[v].cast<float>();
    const float around = occluders.left(surface.vertices[v].cast<float>(), normal,
                                        counts[static_cast<std::size_t>(look.capsule)]);
    colours[v] = (colour * light_on(normal, around)).min(1.0f);
  }
}

}  // namespace mrhi
