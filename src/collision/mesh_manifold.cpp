#include "body_manifold.h"

#include <algorithm>

#include "contact_region.h"
#include "mesh_tree.h"

namespace mrhi {
namespace {

/// Smallest cosine between the normals of contacts in one region (20 degrees).
constexpr double kMinSameRegionCosine = 0.94;
constexpr double kSameDepth = 1e-6;
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

  static Probe corner(const Vector3& place, int number) { return {place, place, number % kCornerNames}; }
  static Probe edge(const Vector3& start, const Vector3& end, int number) {
    return {start, end, kCornerNames + number % kEdgeNames};
  }
};

struct ProbeContact {
  Vector3 point, normal;
  double depth;
  std::uint8_t feature;
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
    const auto features =
        search({other_pose.to_local(probe.start), other_pose.to_local(probe.end), 0.0}, margin);
    if (!features) return std::nullopt;
    // A part of the edge's length, not metres.
    const bool at_end = features->axis_parameter < kEndMargin || features->axis_parameter > 1.0 - kEndMargin;
    if (probe.start != probe.end && at_end) return std::nullopt;
    const Vector3 normal = other_pose.orientation * features->normal;
    const Vector3 midway = features->point + 0.5 * features->distance * features->normal;
    return ProbeContact{other_pose * midway, other_is_b ? normal : Vector3(-normal), -features->distance,
                        static_cast<std::uint8_t>(other_is_b ? probe.name : kFirstNameOfB + probe.name)};
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
    for (int i = 0; i < kCorners; ++i) see(Probe::corner(prism.corner(i), i));
    for (int i = 0; i < kEdges; ++i) {
      const auto [low, high] = edge_ends(i);
      see(Probe::edge(prism.corner(low), prism.corner(high), i));
    }
  }
  /// Rims, and the side line that faces the other shape, as seen from the capsule inscribed in the cylinder.
  void of_round(const Prism& prism) const {
    for (const double side : {-1.0, 1.0}) {
      const FlatFace cap = face_towards(prism, side * prism.axis());
      int number = cap.corners[0];
      for (const double angle : rim_angles(cap.half[0], {{0.0, 0.0}}))
        see(Probe::corner(cap.on_circle(angle), number++));
    }
    const double radius = prism.half.x(), length = prism.half.z();
    const Vector3 inner = std::max(0.0, length - radius) * prism.axis();
    const Vector3 facing = facing_from({prism.centre - inner, prism.centre + inner, std::min(radius, length)},
                                       probing.margin + radius + length);
    if (prism.across(facing).norm() < 0.01) return;
    const Line line = side_line(prism, facing);
    see(Probe::corner(line.at(-line.half), 8));
    see(Probe::corner(line.at(line.half), 9));
    see(Probe::edge(line.at(-line.half), line.at(line.half), 0));
  }
  /// A corner belongs to the first of its edges, so that it is tested once.
  void of_mesh(const MeshSurface& surface, int part) const {
    const int index = part - static_cast<int>(surface.faces().size());
    if (index < 0) return;
    const MeshSurface::Edge& edge = surface.edges()[index];
    const Vector3 start = probing.pose * edge.start, end = probing.pose * Vector3(edge.start + edge.along);
    if (surface.is_first_edge(index, edge.corners[0])) see(Probe::corner(start, edge.corners[0]));
    if (surface.is_first_edge(index, edge.corners[1])) see(Probe::corner(end, edge.corners[1]));
    see(Probe::edge(start, end, index));
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
    if (contact.depth > deepest_.depth) deepest_ = contact;
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
        add_sample(probing, Probe::corner(start, edge.corners[0]));
        add_sample(probing, Probe::edge(start, end, static_cast<int>(index)));
      }
    }
  }
  void add_sample(const Probing& probing, const Probe& probe) {
    const auto contact = probing.find_contact(probe);
    if (!contact) return;
    if (contact->depth > deepest_.depth) deepest_ = *contact;
    kept_[kept_count_++] = *contact;
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
  ProbeContact deepest_{Vector3::Zero(), Vector3::UnitZ(), -1e300, 0};
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
  auto deepest = contacts.deepest(-1e300, [](const ProbeContact&) { return true; });
  for (int region = 0; deepest; ++region) {
    (region == 0 ? manifold.normal : manifold.other_normals[region - 1]) = deepest->normal;
    add_region(contacts, *deepest, region, named, manifold);
    if (convex || region + 1 == Manifold::kMaxRegions) break;
    deepest = contacts.deepest(0.0, [&](const ProbeContact& contact) {
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
