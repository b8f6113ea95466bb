#include "skin_paint.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "../simulation/contact_phase.h"
#include "light.h"
#include "skin.h"

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

namespace {

constexpr double kYieldingForce = 2.0;  // force with which 63 % of the deepest compression is reached [N]
constexpr double kAround = 1.3;         // radii of the phalanx about the contact, in which skin is flattened

bool is_palm(int capsule) {
  return capsule == kPalm || bone_of(capsule) == 0;
}

bool same_part(int a, int b) {
  return is_palm(a) ? is_palm(b) : !is_palm(b) && finger_of(a) == finger_of(b);
}

/// Height h over the plane becomes 0 up to the depth d, h from 3 d on, and 3/2 (h - d) between.
double flattened(double height, double depth) {
  if (height >= 3.0 * depth) return height;
  return std::max(0.0, 1.5 * (height - depth));
}

}  // namespace

void press_flat(const std::vector<Contact>& contacts, const SimulationState& state, std::uint32_t hand,
                const Skin& skin, SkinSurface& surface) {
  for (const Contact& contact : contacts) {
    if (!contact.touching() || hand_id(contact, state) != hand) continue;
    const double force = std::abs(contact.normal.dot(contact.force));
    const double depth = kDeepestPress * (1.0 - std::exp(-force / kYieldingForce));
    const double around = kAround * contact.radius;
    for (std::size_t v = 0; v < skin.size(); ++v) {
      if (!same_part(contact.key.capsule, skin.model().looks[v].capsule)) continue;
      const Vector3 out = surface.vertices[v] - contact.point;
      const double height = contact.normal.dot(out);
      const bool near = height < 3.0 * depth && height > -depth && out.squaredNorm() < around * around;
      if (near) surface.vertices[v] += (flattened(height, depth) - height) * contact.normal;
    }
  }
}

namespace {

constexpr double kLidDepth = 0.01;  // from the rim to the lid's middle [m]

}  // namespace

/// The rim is one loop of edges. From its middle: the loop is jagged, and a fan from one of its own corners
/// would stand out between its teeth.
SkinWrist::SkinWrist(const Skin& skin) : skin_(skin) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : skin.triangles()) {
    const Triangle triangle{static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                            static_cast<std::uint32_t>(t[2])};
    const bool fades =
        std::any_of(triangle.begin(), triangle.end(), [this](std::uint32_t v) { return opacity(v) < 1.0f; });
    (fades ? fading_ : opaque_).push_back(triangle);
    for (std::size_t i = 0; i < 3 && !fades; ++i) {
      const std::uint32_t a = triangle[i], b = triangle[(i + 1) % 3];
      if (edges.erase({b, a}) == 0) edges.insert({a, b});
    }
  }
  for (const auto& [a, b] : edges) {
    opaque_.push_back({static_cast<std::uint32_t>(skin.size()), b, a});
    rim_.push_back(a);
  }
}

/// Within the wrist: level with the rim, flat stretches of skin would be above the lid. In the light that its
/// side of the hand is in: the end of a wrist looks round.
void SkinWrist::add_lid(SkinSurface& surface, std::vector<Rgb>& colours) const {
  Vector3 rim = Vector3::Zero(), faded = Vector3::Zero();
  Rgb colour = Rgb::Zero(), light = Rgb::Zero();
  for (const std::uint32_t vertex : rim_) {
    rim += surface.vertices[vertex] / static_cast<double>(rim_.size());
    colour += colours[vertex];
    light += light_on(surface.normals[vertex].cast<float>());
  }
  for (const Triangle& triangle : fading_)
    for (const std::uint32_t v : triangle)
      faded += surface.vertices[v] / (3.0 * static_cast<double>(fading_.size()));
  const Vector3 outward = (faded - rim).normalized();
  surface.vertices.push_back(rim + kLidDepth * outward);
  surface.normals.push_back(outward);
  colours.push_back((colour / light * light_on(outward.cast<float>())).min(1.0f));
}

}  // namespace mrhi
