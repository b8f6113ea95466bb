#include "mr_hand_interaction/scene/scene_loader.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <filesystem>

#include "../collision/overlap.h"
#include "../text/files.h"
#include "../text/text.h"
#include "../text/untrusted_input.h"
#include "limits.h"
#include "solid_mesh.h"
#include "urdf.h"

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

constexpr std::size_t kMaxShapes = 255;  // a contact's key has 8 bits for the shape

/// Tolerance of a + b >= c for principal moments, which files round. A thin plate has a + b = c.
constexpr double kMomentTolerance = 0.01;
/// Plausible moments of inertia, over mass times radius squared. Others are probably in another unit.
constexpr Range kPlausibleMoment{0.003, 3.0};
/// Above the density of every solid (osmium: 22 590) [kg/m^3].
constexpr double kMaxDensity = 25000.0;
/// Plausible lengths of objects for hands [m].
constexpr Range kPlausibleLength{1e-3, 10.0};
/// Plausible centres of mass are at least this fraction of the size inside the bounding box.
constexpr double kCentreMargin = 0.05;
/// A principal moment below this fraction of the largest counts as missing in the file.
constexpr double kMissingMoment = 1e-12;

/// Gives its inertia to a link that has neither an inertia nor a shape.
const Sphere kShapelessLink{0.01};

/// Mass, centre and inertia about it, in the frame of a body's first link.
struct Weight {
  double mass = 0.0;
  Vector3 centre = Vector3::Zero();
  Matrix3 inertia = Matrix3::Zero();
};

/// Parallel axes: I = sum of I_i + m_i (d^2 1 - d d^T), with d from the common centre to the part's.
Weight sum_of(const std::vector<Weight>& parts) {
  if (parts.size() == 1) return parts.front();
  Weight all;
  for (const Weight& part : parts) all.mass += part.mass, all.centre += part.mass * part.centre;
  all.centre /= all.mass;
  for (const Weight& part : parts) {
    const Vector3 d = part.centre - all.centre;
    all.inertia += part.inertia + part.mass * (d.squaredNorm() * Matrix3::Identity() - d * d.transpose());
  }
  return all;
}

std::vector<PlacedShape> moved(std::vector<PlacedShape> shapes, const Pose& pose) {
  for (PlacedShape& shape : shapes) shape.pose = pose * shape.pose;
  return shapes;
}

class BodyReader {
 public:
  BodyReader(const std::string& source, const SceneOptions& options, ShapeReader& shapes,
             UrdfDocument& document)
      : source_(source), options_(options), shapes_(shapes), document_(document) {}

  Body read(const LinkedBody& linked) {
    const std::vector<LinkPart>& parts = linked.parts;
    const urdf::Link& link = linked.link();
    if (!is_name(link.name)) fail(link, std::string("this name is not allowed; allowed: ") + kNameIs);
    Body body;
    body.name = link.name;
    body.fixed = linked.fixed;
    body.material = options_.default_material;
    read_collisions(parts, body);
    for (const LinkPart& part : parts) read_friction(part.link->name, body);
    if (!body.fixed) weigh(parts, body);
    body.start = linked.in_world * body.link_in_body.inverse();
    for (const LinkPart& part : parts) read_visuals(part, body);
    if (body.visuals.empty())
      for (const PlacedShape& shape : body.shapes) body.visuals.push_back({shape.shape, shape.pose});
    body.shapes = with_meshes_joined(body.shapes);
    if (body.shapes.size() > kMaxShapes)
      fail(link, std::to_string(body.shapes.size()) + " collisions; allowed: at most 255");
    finish(body);
    return body;
  }

 private:
  /// Reads the collision shapes into the first link's frame, also by part, for the parts' inertias.
  void read_collisions(const std::vector<LinkPart>& parts, Body& body) {
    of_parts_.assign(parts.size(), {});
    left_out_ = false;
    add_shapes(parts, &urdf::Link::collision_array, "collision ", body);
    if (body.fixed || !body.shapes.empty()) return;
    add_shapes(parts, &urdf::Link::visual_array, "visual ", body);
    if (!body.shapes.empty())
      return document_.warnings.add("links without a collision touch with their visuals",
                                    "'" + body.name + "'");
    if (!moves(*parts[0].link))  // else a link of a mechanism, which needs no shape
      fail(*parts[0].link,
           "a body that moves has no collision with a volume" +
               std::string(left_out_ ? ", as flat sheets and very small shapes are left out" : "") +
               "; allowed: 1 to 255 shapes");
  }

  template <class Elements>
  void add_shapes(const std::vector<LinkPart>& parts, Elements urdf::Link::*elements, const char* kind,
                  Body& body) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      int number = 0;
      for (const auto& element : *parts[i].link.*elements) {
        const std::string where = "link '" + parts[i].link->name + "' " + kind + std::to_string(++number);
        const auto shape = shapes_.read(*element->geometry, where, true);
        left_out_ = left_out_ || !shape;
        if (shape) of_parts_[i].push_back({*shape, parts[i].pose * to_pose(element->origin)});
      }
      body.shapes.insert(body.shapes.end(), of_parts_[i].begin(), of_parts_[i].end());
    }
  }

  /// Sets both frictions to the one coefficient, as the simulators do that have one.
  void read_friction(const std::string& link, Body& body) const {
    const auto found = document_.friction.find(link);
    if (found == document_.friction.end()) return;
    const Range& range = material_fields()[1].range;
    const double friction = std::clamp(found->second, range.min, range.max);
    if (friction != found->second)
      document_.warnings.add("friction is held to " + range.describe(),
                             "'" + link + "' " + text::number(found->second));
    body.material.static_friction = body.material.dynamic_friction = friction;
    body.own_material.static_friction = body.own_material.dynamic_friction = true;
  }

  /// Sums the masses of the links. If no link has one, the volume of the shapes determines it.
  void weigh(const std::vector<LinkPart>& parts, Body& body) {
    std::vector<Weight> weights;
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (parts[i].link->inertial && parts[i].link->inertial->mass != 0.0)
        weights.push_back(weight_of(parts[i], of_parts_[i]));
    const Weight all = weights.empty() ? weight_of_volume(body) : sum_of(weights);
    body.mass = all.mass;
    body.inertia = all.inertia;
    body.link_in_body.position = -all.centre;
    body.shapes = moved(std::move(body.shapes), body.link_in_body);
  }

  /// Replaces an inertia that lacks a moment by the shapes': some of PyBullet's files have such inertias,
  /// which PyBullet ignores.
  Weight weight_of(const LinkPart& part, const std::vector<PlacedShape>& shapes) const {
    const urdf::Inertial& inertial = *part.link->inertial;
    const Pose origin = part.pose * to_pose(inertial.origin);
    const Matrix3 to_link = origin.orientation.toRotationMatrix();
    Matrix3 inertia;
    inertia << inertial.ixx, inertial.ixy, inertial.ixz, inertial.ixy, inertial.iyy, inertial.iyz,
        inertial.ixz, inertial.iyz, inertial.izz;
    inertia = to_link * inertia * to_link.transpose();
    Weight weight{inertial.mass, origin.position, 0.5 * (inertia + inertia.transpose())};
    const bool none = weight.inertia.isZero(0.0);
    const Vector3 moments = Eigen::SelfAdjointEigenSolver<Matrix3>(weight.inertia).eigenvalues();
    const bool part_only = !none && std::abs(moments[0]) <= kMissingMoment * moments[2];
    if (part_only)
      document_.warnings.add("inertias that lack a moment are replaced by those of the shapes",
                             "'" + part.link->name + "' " + text::vector(moments) + " kg m^2");
    if (none || part_only)
      weight.inertia = shapes.empty() ? inertia_of({{kShapelessLink, Pose{}}}, inertial.mass)
                                      : inertia_of(moved(shapes, {-origin.position, Quaternion::Identity()}),
                                                   inertial.mass);
    return weight;
  }

  Weight weight_of_volume(const Body& body) const {
    if (body.shapes.empty()) {
      document_.warnings.add("links without mass and shape weigh 1 g", "'" + body.name + "'");
      return {0.001, Vector3::Zero(), inertia_of({{kShapelessLink, Pose{}}}, 0.001)};
    }
    const SolidMoments moments = moments_of(body.shapes);
    Weight weight;
    weight.mass = options_.density * moments.volume;
    weight.centre = moments.first / moments.volume;
    const Matrix3 second = moments.second - moments.volume * weight.centre * weight.centre.transpose();
    weight.inertia = options_.density * (second.trace() * Matrix3::Identity() - second);
    document_.warnings.add("masses are volumes times scene/density, " + text::number(options_.density) +
                               " kg/m^3, as the file gives none",
                           "'" + body.name + "' " + text::number(weight.mass) + " kg");
    return weight;
  }

  void read_visuals(const LinkPart& part, Body& body) {
    for (std::size_t i = 0; i < part.link->visual_array.size(); ++i) {
      const urdf::Visual& element = *part.link->visual_array[i];
      const std::string where = "link '" + part.link->name + "' visual " + std::to_string(i + 1);
      const std::optional<Shape> shape = shapes_.read(*element.geometry, where, false);
      if (!shape) continue;
      Visual visual{*shape, body.link_in_body * (part.pose * to_pose(element.origin))};
      if (element.material && element.material->texture_filename.empty()) {
        const urdf::Color& color = element.material->color;
        visual.rgba = {{color.r, color.g, color.b, color.a}};
        check_color(source_ + ": " + where, visual.rgba);
        visual.has_color = true;
      }
      body.visuals.push_back(visual);
    }
  }

  void finish(Body& body) const {
    rethrown<SceneError, std::invalid_argument>(source_ + ": ", [&] { complete(body); });
    if (body.fixed) return;
    const Vector3 moments = Eigen::SelfAdjointEigenSolver<Matrix3>(body.inertia).eigenvalues();
    if (moments[0] + moments[1] < (1 - kMomentTolerance) * moments[2])
      throw SceneError(
          source_ + ": body '" + body.name + "': no rigid body has the principal moments of inertia " +
          text::vector(moments) +
          " kg m^2; allowed: the largest at most the sum of the others, or no <inertia> for that "
          "of the shapes");
    if (!body.shapes.empty()) warn_of_units(body, moments[2]);
  }

  /// Warns of implausible values, and names the likely mistake.
  void warn_of_units(const Body& body, double moment) const {
    const auto warn = [&](const char* what, const std::string& value) {
      document_.warnings.add(what, "'" + body.name + "' " + value);
    };
    Eigen::AlignedBox3d box;  // about the centre of mass
    for (const PlacedShape& shape : body.shapes) box.extend(box_around(shape));
    const double size = box.sizes().maxCoeff(), unit = body.mass * std::pow(body.bounding_radius, 2);
    if (size > kPlausibleLength.max)
      return warn(
          "very large objects; are they in millimetres? <mesh scale=\"0.001 0.001 0.001\"> makes metres of "
          "them",
          "measures " + text::number(size) + " m");
    if (size < kPlausibleLength.min)
      return warn("very small objects; are they in metres, so that they need no scale?",
                  "measures " + text::number(size) + " m");
    const Vector3 within = kCentreMargin * box.sizes();
    if ((box.min() + within).maxCoeff() > 0.0 || (box.max() - within).minCoeff() < 0.0)
      warn("centres of mass are not inside of the shapes; <origin> in <inertial> places them, in metres",
           text::vector(-body.link_in_body.position) + " m, the middle is " +
               text::vector(box.center() - body.link_in_body.position) + " m");
    if (body.mass > kMaxDensity * box.volume())
      warn("masses are too large for their sizes; are they in grams?", text::number(body.mass) + " kg");
    if (!kPlausibleMoment.contains(moment / unit))
      warn(
          "inertias do not fit their masses and sizes; is the unit kg m^2? Without <inertia> that of the "
          "shapes is taken",
          text::number(moment) + " kg m^2, from " + text::number(kPlausibleMoment.min * unit) + " to " +
              text::number(unit) + " is possible");
  }

  [[noreturn]] void fail(const urdf::Link& link, const std::string& what) const {
    throw SceneError(source_ + ": link " + text::quoted(link.name) + ": " + what);
  }

  const std::string& source_;
  const SceneOptions& options_;
  ShapeReader& shapes_;
  UrdfDocument& document_;
  bool left_out_ = false;                           // a shape of the current body has no volume
  std::vector<std::vector<PlacedShape>> of_parts_;  // of the current body, in its first link's frame
};

void read_bodies(const std::string& source, const std::string& folder, UrdfDocument& document,
                 const std::vector<LinkedBody>& bodies, const SceneOptions& options, Scene& scene) {
  ShapeReader shapes(source, folder, options, document.warnings);
  BodyReader reader(source, options, shapes, document);
  shapes.prepare(bodies);
  for (const LinkedBody& body : bodies)
    if (!body.fixed || body.has_shape()) scene.bodies.push_back(reader.read(body));
  scene.mesh_files = shapes.files();
}

namespace fs = std::filesystem;

void check_starts_in_bounds(const std::string& file, const Scene& scene) {
  for (const Body& body : scene.bodies) {
    const Vector3& start = body.start.position;
    if (body.fixed || scene.bounds.contains(start)) continue;
    throw SceneError(file + ": body '" + body.name + "': start " + text::vector(start) +
                     " m is out of bounds; allowed: " + text::vector(scene.bounds.min) + " to " +
                     text::vector(scene.bounds.max));
  }
}

/// Widens the default bounds so that they contain the start of every body that moves.
void widen_bounds(Scene& scene) {
  constexpr double kMargin = 1.0;  // [m]
  Bounds wide = scene.bounds;
  for (const Body& body : scene.bodies) {
    const Vector3 margin = Vector3::Constant(kMargin + body.bounding_radius), &start = body.start.position;
    if (body.fixed || scene.bounds.contains(start)) continue;
    wide.min = wide.min.cwiseMin(start - margin), wide.max = wide.max.cwiseMax(start + margin);
  }
  if (wide.min == scene.bounds.min && wide.max == scene.bounds.max) return;
  scene.bounds = wide;
  scene.warnings.push_back(
      "bodies start out of the usual bounds, which are widened: " + text::vector(wide.min) + " to " +
      text::vector(wide.max) + " m; the YAML's 'bounds' sets others");
}

}  // namespace

void read_urdf(const std::string& source, const std::string& folder, const std::string& xml,
               const SceneOptions& options, Scene& scene) {
  UrdfDocument document = parse_urdf(source, xml);
  read_bodies(source, folder, document, linked_bodies(source, document), options, scene);
  if (scene.bodies.empty()) throw SceneError(source + ": no bodies; allowed: at least one link with a shape");
  scene.joints = read_joints(source, document, scene);
  scene.warnings = document.warnings.lines();
}

void read_body(const std::string& source, const std::string& folder, UrdfDocument& document,
               const LinkedBody& linked, const SceneOptions& options, Scene& scene) {
  read_bodies(source, folder, document, {linked}, options, scene);
  scene.warnings = document.warnings.lines();
}

LinkedBody only_body(const std::string& source, UrdfDocument& document) {
  std::vector<LinkedBody> found;
  for (const LinkedBody& body : linked_bodies(source, document))
    if (body.has_shape()) found.push_back(body);
  if (found.size() != 1)
    throw SceneError(source + ": this URDF has " + (found.empty() ? "no link" : "several links") +
                     " with a shape; allowed: one");
  const urdf::Link& link = found.front().link();
  if (moves(link))
    throw SceneError(source + ": joint " + text::quoted(link.parent_joint->name) +
                     " turns or slides; allowed: floating, fixed");
  return found.front();
}

void join_bodies(const std::string& source, Scene& scene) {
  rethrown<SceneError, std::invalid_argument>(source + ": ", [&] { arrange_joints(scene); });
}

/// Refuses bodies that overlap at the start: they would repel each other violently, and many of them would
/// take longer than a step may. Those that overlap by little are moved apart.
void check_overlaps(const std::string& file, Scene& scene) {
  Warnings warnings;
  for (const auto& [a, b] : overlaps_in_mechanisms(scene))
    warnings.add("links of one mechanism that overlap where they start do not touch each other",
                 "'" + scene.bodies[b].name + "' and '" + scene.bodies[a].name + "'");
  const std::string overlaps = overlaps_at_start(scene);
  if (!overlaps.empty())
    throw SceneError(file + ": " + text::one_line(overlaps, 400) + "; allowed: at most " +
                     text::number(kOverlap) + " m");
  const std::vector<double> moved = part_at_start(scene);
  constexpr double kTold = 1e-5;  // [m]
  for (std::size_t b = 0; b < moved.size(); ++b)
    if (moved[b] > kTold)
      warnings.add("objects that overlap where they start are moved apart",
                   "'" + scene.bodies[b].name + "' by " + text::number(moved[b]) + " m");
  for (const std::string& line : warnings.lines()) scene.warnings.push_back(line);
}

std::string find_scene_file(const std::string& scene, const std::vector<std::string>& directories) {
  return find_named_file("scene", scene, ".urdf", directories);
}

Scene load_scene(const std::string& urdf_file, const SceneOptions& options) {
  Scene scene;
  scene.name = fs::path(urdf_file).stem().string();
  const std::optional<std::string> xml = file_text(urdf_file, kMaxXmlBytes + 1);
  if (!xml) throw SceneError(urdf_file + ": cannot be read; allowed: a readable URDF file");
  if (xml->empty()) throw SceneError(urdf_file + ": this file is empty; allowed: a URDF");
  read_urdf(urdf_file, fs::absolute(urdf_file).parent_path().string(), *xml, options, scene);
  const Bounds usual = scene.bounds;
  const fs::path settings = fs::path(urdf_file).replace_extension(".yaml");
  if (fs::exists(settings)) apply_scene_yaml(settings.string(), scene);
  if (options.gravity) scene.gravity = *options.gravity;
  join_bodies(urdf_file, scene);
  if (usual.min == scene.bounds.min && usual.max == scene.bounds.max) widen_bounds(scene);
  check_starts_in_bounds(urdf_file, scene);
  check_overlaps(urdf_file, scene);
  return scene;
}

}  // namespace mrhi
