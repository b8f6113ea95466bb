#include "body_manifold.h"

#include <algorithm>

#include "contact_region.h"
#include "mesh_tree.h"

namespace mrhi {
namespace {

/// Smallest cosine between the normals of contacts in one region (20 degrees).
constexpr double kMinSameRegionCosine = 0.94;
constexpr double kSameDepth = 1e-6;
/// A corner this near to a side that it is not opposed to is flush with it [m].
constexpr double kFlush = 1e-5;
/// Such a corner is looked for in the face that it stands on no deeper than this [m].
constexpr double kMaxExit = 0.002;
/// Least cosine between the outward direction of a corner or an edge and the surface that it meets.
constexpr double kMinOpposed = 0.2;
/// Names in a byte: corners 0 to 99 and edges 100 to 127 of a in b, and from 128 on those of b in a.
constexpr int kCornerNames = 100, kEdgeNames = 28, kFirstNameOfB = 128;
/// Fraction of an edge at its ends that belongs to the corners: else one point would have two names.
constexpr double kEndMargin = 1e-6;
constexpr std::size_t kDirections = 8;
/// Edges of each mesh that stand for all beyond the budget. Each is measured with one of its corners.
constexpr std::size_t kSampledEdges = 24;

/// A corner (both ends the same) or an edge of a shape, in world.
struct Probe {
  Vector3 start, end;
  int name;
  int part = -1;  // of a mesh, as MeshSurface numbers it
  /// Outward normals of the faces that meet there; zero if there are fewer, or of a mesh.
  std::array<Vector3, 3> normals{{Vector3::Zero(), Vector3::Zero(), Vector3::Zero()}};

  bool is_corner() const { return start == end; }
  static Probe corner(const Vector3& place, int number) { return {place, place, number % kCornerNames}; }
  static Probe edge(const Vector3& start, const Vector3& end, int number) {
    return {start, end, kCornerNames + number % kEdgeNames};
  }
  Probe facing(const Vector3& first, const Vector3& second, const Vector3& third = Vector3::Zero()) const {
    return {start, end, name, part, {{first, second, third}}};
  }
  Probe of_mesh(int number) const { return {start, end, name, number, normals}; }
};

struct ProbeContact {
  Vector3 point, normal;
  double depth;
  std::uint8_t feature;
  bool flush = false;  // beside a surface that it does not face: carries nothing if anything else does
};

/// Measures corners and edges of one shape in the other. Normals point out of b, as a manifold's.
struct Probing {
  const ManifoldShape& of;
  const Pose& pose;
  const ManifoldShape& other;
  const Pose& other_pose;
  bool other_is_b;
  double margin;
  SearchBudget& budget;

  /// Closest features of the other shape, charged to the budget.
  std::optional<ClosestFeatures> search(const Capsule& local, double range) const {
    const auto features = other.closest(local, range);
    budget.spend(search_work(other, features ? features->distance : range));
    return features;
  }

  std::optional<ProbeContact> find_contact(const Probe& probe) const {
    const Vector3 middle = 0.5 * (probe.start + probe.end);
    const double reach = other.bounding_radius + margin + 0.5 * (probe.end - probe.start).norm();
    if ((middle - other_pose.position).squaredNorm() > reach * reach) return std::nullopt;
    auto features = search({other_pose.to_local(probe.start), other_pose.to_local(probe.end), 0.0}, margin);
    if (!features) return std::nullopt;
    // A part of the edge's length, not metres.
    const bool at_end = features->axis_parameter < kEndMargin || features->axis_parameter > 1.0 - kEndMargin;
    if (!probe.is_corner() && at_end) return std::nullopt;
    const auto opposes = [&](const Vector3& normal) { return is_opposed(probe, normal); };
    const bool closed = other.mesh == nullptr || other.mesh->shape().surface.closed();
    bool flush = closed && features->distance < kFlush && !opposes(features->normal);
    if (flush && probe.is_corner()) {
      const Vector3 place = other_pose.to_local(probe.start);
      const Vector3 inside = place - (kFlush + features->distance) * features->normal;
      if (const auto exit = exit_by_face(place, inside, opposes)) features = exit, flush = false;
    }
    const Vector3 normal = other_pose.orientation * features->normal;
    const Vector3 midway = features->point + 0.5 * features->distance * features->normal;
    return ProbeContact{other_pose * midway, other_is_b ? normal : Vector3(-normal), -features->distance,
                        static_cast<std::uint8_t>(other_is_b ? probe.name : kFirstNameOfB + probe.name),
                        flush};
  }

  /// True if a face beside the probe, or all of them together, look against the normal, which is in the other
  /// shape's frame. Else the shapes lie side by side there, as the flush sides of two stacked cubes do: the
  /// nearest surface of a corner of the upper one is the lower one's side, which carries nothing.
  bool is_opposed(const Probe& probe, const Vector3& normal) const {
    const Vector3 against = -(other_pose.orientation * normal);
    if (of.mesh != nullptr) {
      const MeshSurface& surface = of.mesh->shape().surface;
      return !surface.closed() ||
             surface.alignment(probe.part, pose.orientation.conjugate() * against) > kMinOpposed;
    }
    Vector3 sum = Vector3::Zero();
    for (const Vector3& face : probe.normals) {
      if (face.dot(against) > kMinOpposed) return true;
      sum += face;
    }
    return sum.dot(against) > kMinOpposed * sum.norm() || sum.isZero(0.0);
  }

  /// The shortest way of a place in the other shape, or beside it, out by a face whose normal `admits`; in
  /// its frame. `inside`: a place near it that is clear of the side.
  template <typename Admits>
  std::optional<ClosestFeatures> exit_by_face(const Vector3& place, const Vector3& inside,
                                              const Admits& admits) const {
    ClosestFeatures best{-kMaxExit, Vector3::Zero(), place, 0.5};
    const auto take = [&](double separation, const Vector3& normal) {
      if (separation <= best.distance || separation > kSameDepth || !admits(normal)) return;
      best.distance = separation, best.normal = normal, best.point = place - separation * normal;
    };
    if (other.mesh != nullptr) {
      const MeshShape& mesh = other.mesh->shape();
      const MeshSurface& surface = mesh.surface;
      const Segment segment({inside, inside, 0.0});
      const auto may_be_shorter = [&](const MeshTree::Node& node) {
        if (node.depth(segment) > kFlush - best.distance) return false;
        return surface.convex() ||
               (node.may_be_exit(segment) && node.distance(segment) <= kFlush - best.distance);
      };
      mesh.tree.visit(may_be_shorter, [&](int part) {
        if (part >= static_cast<int>(surface.faces().size())) return;
        const MeshSurface::Face& face = surface.faces()[part];
        const Interval over = surface.over(face, segment, 0.5);
        if (surface.convex() || over.s0 <= over.s1) take(face.normal.dot(place) - face.height, face.normal);
      });
      budget.spend(other.mesh->search_cost());
    } else if (other.prism) {
      const Prism prism(*other.prism, Pose());
      for (int i = prism.first_flat(); i < 3; ++i)
        for (const double side : {-1.0, 1.0}) take(side * place[i] - prism.half[i], side * Vector3::Unit(i));
      const Vector3 across = prism.across(place);
      if (prism.round && !across.isZero(0.0)) take(across.norm() - prism.half.x(), across.normalized());
    }
    if (best.normal.isZero(0.0)) return std::nullopt;
    return best;
  }

  /// Upper bound of the depth of a node's parts: r - D, with the centre at the signed distance D and all
  /// parts within r of it.
  double max_depth(const MeshTree::Node& node) const {
    const Vector3 centre = pose * node.centre;
    const double apart = (centre - other_pose.position).norm() - other.bounding_radius - node.radius;
    if (apart > margin) return -1e300;
    const Vector3 local = other_pose.to_local(centre);
    const auto features = search({local, local, 0.0}, margin + node.radius);
    return features ? node.radius - features->distance : -1e300;
  }
};

/// The corners and edges of a shape, always in the same order; of a mesh those in admitted nodes.
template <typename Admits, typename See>
struct Probes {
  const Probing& probing;
  const Admits& admits;
  const See& see;

  void each() const {
    if (probing.of.mesh != nullptr) {
      const MeshShape& mesh = probing.of.mesh->shape();
      mesh.tree.visit(admits, [&](int part) { of_mesh(mesh.surface, part); });
    } else if (probing.of.prism) {
      const Prism prism(*probing.of.prism, probing.pose);
      prism.round ? of_round(prism) : of_straight(prism);
    } else {
      of_other();
    }
  }

 private:
  /// Direction from a capsule inside this shape to the other; zero beyond reach. Features are of the other
  /// shape, with the normal out of it: the direction is its negative.
  Vector3 facing_from(const Capsule& inside, double reach) const {
    const Pose& other = probing.other_pose;
    const auto features = probing.other.closest(
        {other.to_local(inside.start), other.to_local(inside.end), inside.radius}, reach);
    return features ? Vector3(-(other.orientation * features->normal)) : Vector3::Zero();
  }
  /// Adds the support point of a shape without known corners or edges.
  void of_other() const {
    const Pose& pose = probing.pose;
    const Vector3 facing =
        facing_from({pose.position, pose.position, 0.0}, probing.of.bounding_radius + probing.margin);
    if (facing.isZero(0.0)) return;
    const Vector3 local = pose.orientation.conjugate() * facing;
    see(Probe::corner(
        pose * std::visit([&](const auto& shape) { return shape.farthest(local); }, probing.of.shape), 0));
  }
  void of_straight(const Prism& prism) const {
    const auto face = [&](int axis, int corner) {
      return Vector3(((corner >> axis & 1) != 0 ? 1.0 : -1.0) * prism.axes.col(axis));
    };
    for (int i = 0; i < kCorners; ++i)
      see(Probe::corner(prism.corner(i), i).facing(face(0, i), face(1, i), face(2, i)));
    for (int i = 0; i < kEdges; ++i) {
      const auto [low, high] = edge_ends(i);
      const int along = i / 4;
      see(Probe::edge(prism.corner(low), prism.corner(high), i)
              .facing(face((along + 1) % 3, low), face((along + 2) % 3, low)));
    }
  }
  /// Rims, and the side line that faces the other shape, as seen from the capsule inscribed in the cylinder.
  void of_round(const Prism& prism) const {
    for (const double side : {-1.0, 1.0}) {
      const FlatFace cap = face_towards(prism, side * prism.axis());
      int number = cap.corners[0];
      for (const double angle : rim_angles(cap.half[0], {{0.0, 0.0}})) {
        const Vector3 place = cap.on_circle(angle);
        see(Probe::corner(place, number++)
                .facing(side * prism.axis(), prism.across(place - prism.centre).normalized()));
      }
    }
    const double radius = prism.half.x(), length = prism.half.z();
    const Vector3 inner = std::max(0.0, length - radius) * prism.axis();
    const Vector3 facing = facing_from({prism.centre - inner, prism.centre + inner, std::min(radius, length)},
                                       probing.margin + radius + length);
    if (prism.across(facing).norm() < 0.01) return;
    const Line line = side_line(prism, facing);
    const Vector3 start = line.at(-line.half), end = line.at(line.half),
                  out = prism.across(facing).normalized();
    const Vector3 ahead = (end - start).normalized();
    see(Probe::corner(start, 8).facing(out, -ahead));
    see(Probe::corner(end, 9).facing(out, ahead));
    see(Probe::edge(start, end, 0).facing(out, out));
  }
  /// A corner belongs to the first of its edges, so that it is tested once.
  void of_mesh(const MeshSurface& surface, int part) const {
    const int index = part - static_cast<int>(surface.faces().size());
    if (index < 0) return;
    const MeshSurface::Edge& edge = surface.edges()[index];
    const Vector3 start = probing.pose * edge.start, end = probing.pose * Vector3(edge.start + edge.along);
    const auto see_corner = [&](const Vector3& place, int corner) {
      if (surface.is_first_edge(index, corner))
        see(Probe::corner(place, corner).of_mesh(surface.number(SurfacePart::corner, corner)));
    };
    see_corner(start, edge.corners[0]);
    see_corner(end, edge.corners[1]);
    see(Probe::edge(start, end, index).of_mesh(part));
  }
};

/// Contacts of the corners and edges of both shapes in the other, always in the same order. Beyond the budget
/// they are a subset: those that the first visit found, thinned evenly, the deepest of them, and those of
/// sampled edges.
class ProbeContacts {
 public:
  ProbeContacts(const Probing& of_a, const Probing& of_b) : both_{{of_a, of_b}}, budget_(of_a.budget) {
    const auto may_touch = [this](const Probing& probing, const MeshTree::Node& node) {
      return found_ <= kMaxKept && probing.max_depth(node) >= -probing.margin;
    };
    measure(may_touch, [this](const ProbeContact& contact) { remember(contact); });
    count_ = found_;
    if (is_exhausted()) use_subset();
  }

  bool is_exhausted() const { return budget_.left <= 0.0; }
  /// True if not all contacts count.
  bool is_subset() const { return subset_; }
  void use_subset() {
    subset_ = true;
    add_samples();
    if (deepest_.depth > -1e300) kept_[kept_count_++] = deepest_;
    count_ = kept_count_;
  }

  /// Calls `see(contact)` for all in nodes that it `admits(probing, node)`. Few are measured once, many each
  /// time.
  template <typename Admits, typename See>
  void each(const Admits& admits, const See& see) const {
    if (!subset_ && count_ > kMaxKept) return measure(admits, see);
    for (std::size_t i = 0; i < count_; ++i) see(kept_[i]);
  }
  /// Returns the first of the deepest of those that `fits` accepts and that are deeper than `least`.
  /// The bound grows with what is found: nodes that cannot exceed it are left out.
  template <typename Fits>
  std::optional<ProbeContact> deepest(double min_depth, const Fits& fits) const {
    double depth = min_depth;
    each([&](const Probing& probing, const MeshTree::Node& node) { return probing.max_depth(node) > depth; },
         [&](const ProbeContact& contact) {
           if (contact.depth > depth && fits(contact)) depth = contact.depth;
         });
    if (depth <= min_depth) return std::nullopt;
    depth -= kSameDepth;
    std::optional<ProbeContact> found;
    each([&](const Probing& probing,
             const MeshTree::Node& node) { return !found && probing.max_depth(node) >= depth; },
         [&](const ProbeContact& contact) {
           if (!found && contact.depth >= depth && fits(contact)) found = contact;
         });
    return found;
  }

 private:
  static constexpr std::size_t kMaxKept = 320, kSamples = 4 * kSampledEdges;

  /// Keeps all while they are few, later every 2^n-th.
  void remember(const ProbeContact& contact) {
    note_deepest(contact);
    if (found_++ % stride_ != 0) return;
    if (kept_count_ == kMaxKept) {
      for (std::size_t i = 0; 2 * i < kept_count_; ++i) kept_[i] = kept_[2 * i];
      kept_count_ /= 2;
      stride_ *= 2;
    }
    kept_[kept_count_++] = contact;
  }
  void add_samples() {
    for (const Probing& probing : both_) {
      if (probing.of.mesh == nullptr) continue;
      const std::vector<MeshSurface::Edge>& edges = probing.of.mesh->shape().surface.edges();
      const double limit = budget_.spent + budget_.sample;
      for (std::size_t i = 0; i < kSampledEdges && !edges.empty() && budget_.spent < limit; ++i) {
        const std::size_t index = sampled(i, edges.size());
        const MeshSurface::Edge& edge = edges[index];
        const Vector3 start = probing.pose * edge.start,
                      end = probing.pose * Vector3(edge.start + edge.along);
        const MeshSurface& surface = probing.of.mesh->shape().surface;
        const int number = static_cast<int>(index), corner = edge.corners[0];
        add_sample(probing,
                   Probe::corner(start, corner).of_mesh(surface.number(SurfacePart::corner, corner)));
        add_sample(probing,
                   Probe::edge(start, end, number).of_mesh(surface.number(SurfacePart::edge, number)));
      }
    }
  }
  void add_sample(const Probing& probing, const Probe& probe) {
    const auto contact = probing.find_contact(probe);
    if (!contact) return;
    note_deepest(*contact);
    kept_[kept_count_++] = *contact;
  }
  void note_deepest(const ProbeContact& contact) {
    if (contact.flush != deepest_.flush ? deepest_.flush : contact.depth > deepest_.depth) deepest_ = contact;
  }

  /// Until the budget is exhausted.
  template <typename Admits, typename See>
  void measure(const Admits& admits, const See& see) const {
    for (const Probing& probing : both_) {
      const auto wanted_here = [&](const MeshTree::Node& node) {
        return !is_exhausted() && admits(probing, node);
      };
      const auto try_out = [&](const Probe& probe) {
        if (is_exhausted()) return;
        if (const auto contact = probing.find_contact(probe)) see(*contact);
      };
      Probes<decltype(wanted_here), decltype(try_out)>{probing, wanted_here, try_out}.each();
    }
  }

  std::array<Probing, 2> both_;
  SearchBudget& budget_;
  std::array<ProbeContact, kMaxKept + kSamples + 1> kept_;
  std::size_t kept_count_ = 0, count_ = 0;
  std::size_t found_ = 0, stride_ = 1;
  ProbeContact deepest_{Vector3::Zero(), Vector3::UnitZ(), -1e300, 0, true};
  bool subset_ = false;
};

/// The contacts of the deepest one's region that are farthest in eight directions across its normal. The
/// first direction is 0.1 rad off u, so that none is along a box's sides, where rounding would decide between
/// two corners.
std::array<ProbeContact, kDirections> outermost(const ProbeContacts& contacts, const ProbeContact& deepest,
                                                const Vector3& u, const Vector3& v) {
  std::array<Vector3, kDirections> out;
  for (std::size_t k = 0; k < kDirections; ++k) {
    const double angle = 0.1 + 0.25 * 3.141592653589793 * static_cast<double>(k);
    out[k] = std::cos(angle) * u + std::sin(angle) * v;
  }
  std::array<double, kDirections> distances;
  distances.fill(-1e300);
  std::array<ProbeContact, kDirections> farthest;
  const auto may_be = [&](const Probing& probing, const MeshTree::Node& node) {
    const Vector3 offset = probing.pose * node.centre - deepest.point;
    // A contact is midway between the surfaces: half the margin from the part.
    const double around = node.radius + 0.5 * probing.margin + std::max(0.0, 0.5 * deepest.depth);
    bool farther = false;
    for (std::size_t k = 0; k < kDirections && !farther; ++k)
      farther = out[k].dot(offset) + around > distances[k] + kSameDepth;
    return farther && probing.max_depth(node) >= -probing.margin;
  };
  contacts.each(may_be, [&](const ProbeContact& contact) {
    if (contact.normal.dot(deepest.normal) < kMinSameRegionCosine) return;
    for (std::size_t k = 0; k < kDirections; ++k) {
      const double distance = out[k].dot(contact.point - deepest.point);
      if (distance > distances[k] + kSameDepth) distances[k] = distance, farthest[k] = contact;
    }
  });
  return farthest;
}

using Names = std::array<bool, 256>;

/// Adds the region of the deepest contact, in the plane of u and v. While points are sorted, their `feature`
/// is an index in `taken`. A name that is taken, as numbers are modulo 100 and 28, becomes the next free one.
void add_region(const ProbeContacts& contacts, const ProbeContact& deepest, int number, Names& named,
                Manifold& manifold) {
  const Vector3 u = deepest.normal.unitOrthogonal(), v = deepest.normal.cross(u);
  const auto farthest = outermost(contacts, deepest, u, v);
  std::array<const ProbeContact*, kDirections + 1> taken{};
  ContactRegion region;
  const auto take = [&](const ProbeContact& contact) {
    for (int i = 0; i < region.count; ++i)
      if (taken[i]->feature == contact.feature && taken[i]->point == contact.point) return;
    taken[region.count] = &contact;
    const Vector3 offset = contact.point - deepest.point;
    region.add({{{u.dot(offset), v.dot(offset)}}, contact.depth, static_cast<std::uint8_t>(region.count), 0});
  };
  take(deepest);
  for (const ProbeContact& contact : farthest) take(contact);
  region.sort_around();
  region.reduce();
  region.straighten();
  for (int i = 0; i < region.count; ++i) {
    const ProbeContact& contact = *taken[region[i].feature];
    std::uint8_t name = contact.feature;
    while (named[name]) ++name;
    named[name] = true;
    add_point(manifold, contact.point, contact.depth, name);
    (manifold.end() - 1)->region = static_cast<std::uint8_t>(number);
  }
}

/// Two convex shapes touch in one region. Elsewhere each further region begins with the deepest overlap whose
/// normal differs from the others'. Gaps begin none: beyond the rim of a table its nearest surface is its
/// side.
Manifold chosen(const ProbeContacts& contacts, bool convex) {
  Manifold manifold;
  Names named{};
  auto deepest = contacts.deepest(-1e300, [](const ProbeContact& contact) { return !contact.flush; });
  if (!deepest) deepest = contacts.deepest(-1e300, [](const ProbeContact&) { return true; });
  for (int region = 0; deepest; ++region) {
    (region == 0 ? manifold.normal : manifold.other_normals[region - 1]) = deepest->normal;
    add_region(contacts, *deepest, region, named, manifold);
    if (convex || region + 1 == Manifold::kMaxRegions) break;
    deepest = contacts.deepest(0.0, [&](const ProbeContact& contact) {
      if (contact.flush) return false;
      for (int k = 0; k <= region; ++k)
        if (contact.normal.dot(manifold.normal_of(k)) >= kMinSameRegionCosine) return false;
      return true;
    });
  }
  return manifold;
}

}  // namespace

Manifold mesh_manifold(const ManifoldShape& a, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin, SearchBudget& budget) {
  const auto is_convex = [](const ManifoldShape& shape) {
    return shape.mesh == nullptr || shape.mesh->shape().surface.convex();
  };
  const bool convex = is_convex(a) && is_convex(b);
  ProbeContacts contacts({a, pose_a, b, pose_b, true, margin, budget},
                         {b, pose_b, a, pose_a, false, margin, budget});
  const Manifold manifold = chosen(contacts, convex);
  if (contacts.is_subset() || !contacts.is_exhausted()) return manifold;
  contacts.use_subset();
  return chosen(contacts, convex);
}

}  // namespace mrhi
