#include "urdf.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "../text/text.h"
#include "limits.h"
#include "shape_inertia.h"

namespace mrhi {

void check_color(const std::string& element, const std::array<float, 4>& rgba) {
  const Range& range = body_limits::kColor;
  if (std::all_of(rgba.begin(), rgba.end(), [&](float part) { return range.contains(double(part)); })) return;
  std::string shown;
  for (const float part : rgba) shown += (shown.empty() ? "" : ", ") + text::number(double(part));
  throw SceneError(element + ": color [" + shown +
                   "] is not allowed; allowed: red, green, blue and opacity, each " + range.describe());
}

namespace {

constexpr std::size_t kMostShapes = 255;  // a contact's key has 8 bits for the shape

/// A rigid body's principal moments obey a + b >= c. Files round them: a thin plate just meets it.
constexpr double kTriangleSlack = 0.01;

class BodyReader {
 public:
  BodyReader(const std::string& file, const SceneOptions& options)
      : file_(file), options_(options), shapes_(file, options) {}

  Body read(const PlacedLink& placed) {
    const urdf::Link& link = *placed.link;
    check_name(link);
    Body body;
    body.name = link.name;
    body.fixed = placed.fixed;
    body.material = options_.default_material;
    if (!body.fixed) read_inertial(link, body);
    body.start = placed.in_world * body.link_in_body.inverse();
    read_collisions(link, body);
    if (!body.fixed && body.inertia.isZero(0.0)) body.inertia = inertia_of(body.shapes, body.mass);
    read_visuals(link, body);
    finish(body);
    return body;
  }

 private:
  void check_name(const urdf::Link& link) const {
    if (!is_name(link.name)) fail(link, std::string("this name is not allowed; allowed: ") + kNameIs);
  }

  void read_inertial(const urdf::Link& link, Body& body) const {
    if (!link.inertial) fail(link, "a free body has no inertial; allowed: an inertial with mass and inertia");
    const urdf::Inertial& given = *link.inertial;
    const Pose origin = to_pose(given.origin);
    const Matrix3 to_link = origin.orientation.toRotationMatrix();
    Matrix3 inertia;
    inertia << given.ixx, given.ixy, given.ixz, given.ixy, given.iyy, given.iyz, given.ixz, given.iyz,
        given.izz;
    body.mass = given.mass;
    body.inertia = to_link * inertia * to_link.transpose();
    body.inertia = (0.5 * (body.inertia + body.inertia.transpose())).eval();
    body.link_in_body.position = -origin.position;
  }

  void read_collisions(const urdf::Link& link, Body& body) {
    const auto& collisions = link.collision_array;
    if (!body.fixed && collisions.empty()) fail(link, "a free body has no collision; allowed: 1 to 255");
    if (collisions.size() > kMostShapes) {
      fail(link, std::to_string(collisions.size()) + " collisions; allowed: at most 255");
    }
    for (std::size_t i = 0; i < collisions.size(); ++i) {
      const std::string element = "link '" + link.name + "' collision " + std::to_string(i + 1);
      body.shapes.push_back({shapes_.read(*collisions[i]->geometry, element, true),
                             body.link_in_body * to_pose(collisions[i]->origin)});
    }
  }

  void read_visuals(const urdf::Link& link, Body& body) {
    for (std::size_t i = 0; i < link.visual_array.size(); ++i) {
      const urdf::Visual& given = *link.visual_array[i];
      const std::string element = "link '" + link.name + "' visual " + std::to_string(i + 1);
      Visual visual{shapes_.read(*given.geometry, element, false), body.link_in_body * to_pose(given.origin)};
      if (!given.material && !given.material_name.empty()) {
        throw SceneError(file_ + ": " + element + ": material '" + given.material_name +
                         "' is not defined; allowed: a material with a color in this file");
      }
      if (given.material && given.material->texture_filename.empty()) {
        const urdf::Color& color = given.material->color;
        visual.rgba = {{color.r, color.g, color.b, color.a}};
        check_color(file_ + ": " + element, visual.rgba);
        visual.has_color = true;
      }
      body.visuals.push_back(visual);
    }
    if (!body.visuals.empty()) return;
    for (const PlacedShape& placed : body.shapes) body.visuals.push_back({placed.shape, placed.pose});
  }

  void finish(Body& body) const {
    try {
      complete(body);
    } catch (const std::invalid_argument& error) {
      throw SceneError(file_ + ": " + error.what());
    }
    if (body.fixed) return;
    const Vector3 moments = Eigen::SelfAdjointEigenSolver<Matrix3>(body.inertia).eigenvalues();
    if (moments[0] + moments[1] >= (1 - kTriangleSlack) * moments[2]) return;
    throw SceneError(file_ + ": body '" + body.name +
                     "': no rigid body has the principal moments of inertia " + text::vector(moments) +
                     " kg m^2; allowed: the largest at most the sum of the others");
  }

  [[noreturn]] void fail(const urdf::Link& link, const std::string& what) const {
    throw SceneError(file_ + ": link '" + text::one_line(link.name, 60) + "': " + what);
  }

  const std::string& file_;
  const SceneOptions& options_;
  ShapeReader shapes_;
};

bool has_shape(const urdf::Link& link) {
  return !link.collision_array.empty() || !link.visual_array.empty();
}

}  // namespace

namespace {

void read_document(const std::string& urdf_file, const UrdfDocument& document, const SceneOptions& options,
                   Scene& scene) {
  BodyReader reader(urdf_file, options);
  for (const PlacedLink& placed : place_links(urdf_file, document)) {
    if (!placed.fixed || has_shape(*placed.link)) scene.bodies.push_back(reader.read(placed));
  }
  if (scene.bodies.empty())
    throw SceneError(urdf_file + ": no bodies; allowed: at least one link joined to the root");
  scene.joints = read_joints(urdf_file, document, scene);
}

}  // namespace

void read_urdf(const std::string& urdf_file, const SceneOptions& options, Scene& scene) {
  read_document(urdf_file, parse_urdf_file(urdf_file), options, scene);
}

void read_urdf_text(const std::string& source, const std::string& xml, const SceneOptions& options,
                    Scene& scene) {
  read_document(source, parse_urdf(source, xml), options, scene);
}

Body read_body(const std::string& source, const PlacedLink& placed, const SceneOptions& options) {
  return BodyReader(source, options).read(placed);
}

PlacedLink only_link(const std::string& source, const std::string& xml) {
  const UrdfDocument document = parse_urdf(source, xml);
  std::vector<PlacedLink> found;
  const urdf::LinkConstSharedPtr root = document.model->getRoot();
  if (has_shape(*root)) {
    found.push_back({root, false, Pose{}});
    if (document.links.size() > 1) found.push_back(found.front());  // whatever hangs on it
  } else {
    for (const PlacedLink& placed : place_links(source, document)) {
      if (has_shape(*placed.link)) found.push_back(placed);
    }
  }
  if (found.size() == 1 && found.front().link->parent_joint && moves(*found.front().link->parent_joint)) {
    throw SceneError(source + ": joint '" + text::one_line(found.front().link->parent_joint->name, 60) +
                     "' turns or slides; allowed: floating, fixed");
  }
  if (found.size() == 1) return found.front();
  throw SceneError(source + ": this URDF has " + (found.empty() ? "no link" : "several links") +
                   " with a shape; allowed: one");
}

}  // namespace mrhi
