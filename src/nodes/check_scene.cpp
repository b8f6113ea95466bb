#include <algorithm>
#include <cstdio>
#include <iostream>

#include "../scene/solid_mesh.h"
#include "../text/command_line.h"
#include "../text/files.h"
#include "../text/text.h"
#include "exit_status.h"
#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/input_error.h"
#include "mr_hand_interaction/ros/package_paths.h"

namespace mrhi {
namespace {

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction check_scene [--density KG_PER_M3] [--picture FILE.svg] SCENE...

Loads scenes, by name or as URDF files, and prints their bodies with mass, volume and size, their joints, and
what was assumed. --picture draws the last scene. Exit status: 0 if all scenes load, 1 if one does not, 2 for
bad usage.
)";

std::string kind_of(const Scene& scene, std::size_t body) {
  if (scene.bodies[body].fixed) return "fixture";
  for (const Joint& joint : scene.joints)
    if (joint.child == static_cast<int>(body)) return "on joint";
  return "free";
}

void print(const std::string& file, const Scene& scene) {
  const std::size_t bodies = scene.bodies.size(), joints = scene.joints.size();
  std::printf("%s: %zu %s, %zu %s, gravity %s m/s^2, bounds %s to %s m\n", file.c_str(), bodies,
              bodies == 1 ? "body" : "bodies", joints, joints == 1 ? "joint" : "joints",
              text::vector(scene.gravity).c_str(), text::vector(scene.bounds.min).c_str(),
              text::vector(scene.bounds.max).c_str());
  std::printf("  %-24s %-8s %10s %12s %26s %7s %8s %11s\n", "body", "kind", "mass [g]", "volume [cm3]",
              "extent x, y, z [mm]", "shapes", "friction", "restitution");
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    Eigen::AlignedBox3d box;
    for (const PlacedShape& shape : body.shapes) box.extend(box_around(shape));
    const Vector3 size = body.shapes.empty() ? Vector3::Zero() : Vector3(1e3 * box.sizes());
    const std::string mass = body.fixed ? "" : text::format("%.4g", 1e3 * body.mass);
    const std::string extent = text::format("%.4g, %.4g, %.4g", size.x(), size.y(), size.z());
    std::printf("  %-24s %-8s %10s %12.4g %26s %7zu %8.3g %11.3g\n", body.name.c_str(),
                kind_of(scene, b).c_str(), mass.c_str(), 1e6 * moments_of(body.shapes).volume, extent.c_str(),
                body.shapes.size(), body.material.static_friction, body.material.restitution);
  }
  for (const Joint& joint : scene.joints)
    std::printf("  joint %-18s of '%s', %s, %s to %s %s\n", joint.name.c_str(),
                scene.bodies[joint.child].name.c_str(), joint.kind_name(), text::number(joint.lower).c_str(),
                text::number(joint.upper).c_str(), joint.unit());
  for (const std::string& warning : scene.warnings) std::printf("  warning: %s\n", warning.c_str());
}

/// Collision shapes, seen from above the front, farther triangles first.
class Picture {
 public:
  explicit Picture(const Scene& scene) {
    for (const Body& body : scene.bodies)
      for (const PlacedShape& shape : body.shapes)
        add(surface_of({shape.shape, body.start * shape.pose}), body.fixed ? 0.6 : 1.0);
    std::stable_sort(facets_.begin(), facets_.end(),
                     [](const Facet& a, const Facet& b) { return a.depth < b.depth; });
  }

  std::string svg() const {
    constexpr double kSize = 800.0;
    const double scale = kSize / std::max(1e-9, seen_.sizes().maxCoeff());
    std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-10 -10 820 820\">\n";
    for (const Facet& facet : facets_) {
      svg += "<path d=\"";
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector2d at = scale * (facet.corners[k] - seen_.min());
        svg += text::format("%c%.1f %.1f", k == 0 ? 'M' : 'L', at.x(), kSize - at.y());
      }
      const int shade = static_cast<int>(facet.shade);
      svg += text::format("Z\" fill=\"#%02x%02x%02x\"/>\n", shade, shade, std::min(255, shade + 20));
    }
    return svg + "</svg>\n";
  }

 private:
  struct Facet {
    std::array<Eigen::Vector2d, 3> corners;
    double depth, shade;
  };
  void add(const TriangleMesh& mesh, double light) {
    Matrix3 view;  // rows: unit vectors to the right, up and towards the viewer
    const Vector3 towards = Vector3(1.0, -2.0, 1.0).normalized(), right = Vector3(2.0, 1.0, 0.0).normalized();
    view << right.transpose(), towards.cross(right).transpose(), towards.transpose();
    for (const auto& t : mesh.triangles) {
      Facet facet{{}, 0.0, 0.0};
      std::array<Vector3, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = view * mesh.vertices[t[k]];
        facet.corners[k] = corners[k].head<2>();
        facet.depth += corners[k].z() / 3.0;
        seen_.extend(facet.corners[k]);
      }
      const Vector3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
      if (!(normal.z() > 0.0)) continue;
      facet.shade = light * (90.0 + 140.0 * normal.dot(Vector3(0.3, 0.5, 0.8).normalized()));
      facet.shade = std::min(std::max(facet.shade, 20.0), 235.0);
      facets_.push_back(facet);
    }
  }

  std::vector<Facet> facets_;
  Eigen::AlignedBox2d seen_;
};

int check(const std::vector<std::string>& words) {
  std::string picture;
  Configuration configuration;
  std::vector<std::string> files;
  CommandLine line;
  line.once("--picture", "FILE.svg", picture);
  line.once("--density", "KG_PER_M3",
            [&](const OptionValue& given) { configuration.density = given.number(0.1, 1e5); });
  line.words([&](const OptionValue& given) { files.push_back(given.text); });
  if (!line.read(words)) return std::cout << kUsage, 0;
  if (files.empty()) throw UsageError("no scene is given; --help shows the usage");
  int status = 0;
  for (const std::string& file : files) {
    try {
      const Scene scene = load_scene(find_scene_file(file, scene_folders()), scene_options(configuration));
      print(file, scene);
      if (!picture.empty()) write_file(picture, Picture(scene).svg());
    } catch (const std::exception& error) {
      print_error("check_scene", error);
      status = 1;
    }
  }
  return status;
}

}  // namespace
}  // namespace mrhi

int main(int argc, char** argv) {
  return mrhi::exit_status("check_scene", [&] { return mrhi::check({argv + 1, argv + argc}); });
}
