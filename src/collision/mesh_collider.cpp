#include <atomic>
#include <map>
#include <mutex>

#include "../scene/solid_mesh.h"
#include "mesh_collision.h"
#include "mesh_nearest.h"
#include "mesh_tree.h"

namespace mrhi {
namespace {

constexpr double kUnlimited = 1e300;
/// Shortest length on which a finger lies flat on a face [m]; shorter faces are parts of a curved surface.
constexpr double kMinFlatLength = 0.002;

/// The parts of a mesh whose parts may overlap; none of another.
std::vector<MeshShape> parts_of(const TriangleMesh& mesh) {
  std::vector<MeshShape> parts;
  if (mesh.parts.size() < 2) return parts;
  for (std::size_t p = 0; p < mesh.parts.size(); ++p) {
    const auto begin = mesh.triangles.begin();
    const auto end = p + 1 < mesh.parts.size() ? begin + mesh.parts[p + 1] : mesh.triangles.end();
    parts.emplace_back(cut_out(mesh, {begin + mesh.parts[p], end}));
  }
  return parts;
}

}  // namespace

/// The nearest part found last, by the place of the segment's centre: an initial guess for the next search.
/// No result depends on it, so that all callers may share it.
///
/// The place's cell in a grid of 32 across the mesh is hashed to one of a prime number of entries: two cells
/// that share one only make worse guesses. Relaxed order is enough, as a guess stands for itself.
class GuessMemory {
 public:
  explicit GuessMemory(const MeshSurface& surface)
      : corner_(surface.bounds().min()),
        per_metre_(kCells / std::max(1e-9, surface.bounds().sizes().maxCoeff())) {
    for (std::atomic<int>& part : parts_) part.store(-1, std::memory_order_relaxed);
  }
  std::atomic<int>& at(const Segment& segment) {
    const Vector3 place = per_metre_ * (segment.middle() - corner_);
    std::uint32_t cell = 0;
    for (int i = 0; i < 3; ++i) {
      const double held = std::max(-1000.0, std::min(place[i], 1000.0));
      cell = cell * 73u + static_cast<std::uint32_t>(static_cast<int>(held + 1000.0));
    }
    return parts_[cell % parts_.size()];
  }

 private:
  static constexpr double kCells = 32.0;  // across the mesh
  const Vector3 corner_;
  const double per_metre_;
  std::array<std::atomic<int>, 1021> parts_;
};

/// Parts near recent segments, so that a query from almost the same place needs no search. No result depends
/// on it either; a caller that finds an entry in use by another does without.
///
/// Entries lie in sets by the 2 mm cells of both ends, four to a set. The set is locked by a flag while it is
/// read or written, and no caller waits. A segment that has moved by kMaxMotion or more gets an entry for its
/// place alone, without parts: gathering them pays only if it stays.
class NearMemory {
 public:
  /// Returns the nearest feature, from memory if possible, else by `search()`, whose result is stored if the
  /// segment hardly moves.
  template <typename Search>
  MeshNearest nearest(const MeshShape& shape, const Segment& segment, double range, const Search& search) {
    Set& set = sets_[name_of(segment) % sets_.size()];
    if (set.in_use.test_and_set(std::memory_order_acquire)) return search();
    const Use use(set.in_use);
    NearParts* entry = nullptr;
    double min_motion = 1e300;
    for (NearParts& one : set.entries) {
      const double moved = one.moved(segment);
      if (moved < min_motion) min_motion = moved, entry = &one;
    }
    if (min_motion < entry->margin) return MeshNearest(shape.surface, segment, range, *entry);
    MeshNearest found = search();
    const bool stays = min_motion < kMaxMotion;
    if (!stays) entry = &set.entries[set.next = (set.next + 1) % set.entries.size()];
    *entry = stays && found.found() ? found.near_parts(shape.tree) : NearParts{};
    entry->start = segment.start, entry->end = segment.end();
    return found;
  }

 private:
  static constexpr double kCell = 0.002, kMaxMotion = 2e-5;  // [m]

  struct Use {
    explicit Use(std::atomic_flag& taken) : flag(taken) {}
    ~Use() { flag.clear(std::memory_order_release); }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;
    std::atomic_flag& flag;
  };
  struct Set {
    std::atomic_flag in_use = ATOMIC_FLAG_INIT;
    std::array<NearParts, 4> entries;
    std::size_t next = 0;
  };

  static std::uint32_t name_of(const Segment& segment) {
    std::uint32_t name = 0;
    for (const Vector3& end : {segment.start, segment.end()})
      for (int i = 0; i < 3; ++i) {
        const double held = std::max(-1e6, std::min(std::floor(end[i] / kCell), 1e6));
        name = name * 73u + static_cast<std::uint32_t>(static_cast<int>(held));
      }
    return name;
  }

  std::array<Set, 127> sets_;
};

/// A mesh of parts is their union. Outside all of them one search through the tree of all faces finds the
/// nearest feature. Inside, the depth is that in the part where it is deepest.
struct MeshCollider::Impl {
  explicit Impl(const TriangleMesh& mesh) : shape(mesh), parts(parts_of(mesh)), guesses(shape.surface) {
    for (const MeshShape& part : parts)
      deepest = std::max(deepest, 0.5 * part.surface.bounds().sizes().minCoeff());
    search_cost = mean_search_cost();
  }

  MeshNearest nearest(const MeshShape& of, const Segment& segment, double range) const {
    if (&of != &shape) return MeshNearest(of.surface, of.tree, segment, range, -1);
    return memory.nearest(shape, segment, range, [&] { return searched(segment, range); });
  }
  MeshNearest searched(const Segment& segment, double range) const {
    std::atomic<int>& guess = guesses.at(segment);
    MeshNearest search(shape.surface, shape.tree, segment, range, guess.load(std::memory_order_relaxed));
    if (search.part() >= 0) guess.store(search.part(), std::memory_order_relaxed);
    return search;
  }
  /// N.gap < 0 with the gap from the surface to the segment: the segment's nearest place is below the surface
  /// there (Baerentzen & Aanaes 2005).
  static bool is_inside(const MeshShape& of, const MeshNearest& search) {
    return of.surface.closed() && search.gap().dot(of.surface.outward(search.nearest())) < 0.0;
  }
  /// Inside, or through the surface.
  static bool has_to_leave(const MeshShape& of, const MeshNearest& search) {
    return search.nearest().distance < kOnSurface || is_inside(of, search);
  }
  static int face_at(const MeshShape& of, const SurfaceNearest& nearest);
  ClosestFeatures leave(const MeshShape& of, const Segment& segment, const SurfaceNearest& nearest) const;
  void leave_by_end(const MeshShape& of, const Segment& segment, double s,
                    std::optional<ClosestFeatures>& best) const;
  std::optional<ClosestFeatures> leave_parts(const Segment& segment) const;
  double mean_search_cost() const;

  MeshShape shape;
  std::vector<MeshShape> parts;
  double deepest = 0.0;  // nothing within a part is farther from its surface [m]
  double search_cost = 1.0;
  mutable GuessMemory guesses;
  mutable NearMemory memory;
};

/// A face that has the nearest place, or one beside it.
int MeshCollider::Impl::face_at(const MeshShape& of, const SurfaceNearest& nearest) {
  if (nearest.part == SurfacePart::face) return nearest.index;
  if (nearest.part == SurfacePart::edge) return of.surface.edges()[nearest.index].faces[0];
  return of.surface.face_at_corner(nearest.index);
}

ClosestFeatures MeshCollider::Impl::leave(const MeshShape& of, const Segment& segment,
                                          const SurfaceNearest& nearest) const {
  std::optional<ClosestFeatures> known;
  if (!of.surface.convex() && of.surface.closed()) {
    for (const double end : {0.0, 1.0}) leave_by_end(of, segment, end, known);
  }
  return leave_mesh(segment, of.surface, of.tree, face_at(of, nearest), known ? &*known : nullptr);
}

/// Names no part of the surface, because a part of the mesh has numbers of its own.
std::optional<ClosestFeatures> MeshCollider::Impl::leave_parts(const Segment& segment) const {
  std::optional<ClosestFeatures> best;
  for (const MeshShape& part : parts) {
    if (part.surface.is_beyond(segment, kOnSurface)) continue;
    const MeshNearest search = nearest(part, segment, kUnlimited);
    if (!has_to_leave(part, search)) continue;
    const ClosestFeatures exit = leave(part, segment, search.nearest());
    if (!best || exit.distance < best->distance) best = exit;
  }
  if (best) best->part = -1;
  return best;
}

/// Searches for displaced copies of some of its edges, without memory. Long thin faces make searches slow.
double MeshCollider::Impl::mean_search_cost() const {
  constexpr int kSamples = 32;
  constexpr double kMove = 0.01, kOrdinaryVisits = 50.0;  // fraction of the mesh's size, and per search
  const auto& edges = shape.surface.edges();
  if (edges.empty()) return 1.0;
  const Vector3 move = kMove * shape.surface.bounds().sizes().maxCoeff() * Vector3(0.7, 0.5, 0.4);
  double visits = 0.0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const MeshSurface::Edge& edge = edges[i * edges.size() / kSamples];
    const Segment segment(Capsule{edge.start + move, edge.start + edge.along + move, 0.0});
    visits += MeshNearest(shape.surface, shape.tree, segment, kUnlimited, -1).visits();
  }
  return std::max(1.0, visits / (kSamples * kOrdinaryVisits));
}

/// In a hollow solid the nearest surface of an end may be an edge or a corner that points inwards. The end's
/// nearest point is at depth d along the normal -gap / d, out of the solid. The segment is outside with it
/// only if the other end is not behind: normal.(other - end) >= 0.
void MeshCollider::Impl::leave_by_end(const MeshShape& of, const Segment& segment, double s,
                                      std::optional<ClosestFeatures>& best) const {
  const Vector3 end = segment.at(s);
  const Segment only_end(Capsule{end, end, 0.0});
  const MeshNearest search = nearest(of, only_end, kUnlimited);
  const double depth = search.nearest().distance;
  if (depth < kOnSurface || !is_inside(of, search)) return;
  const Vector3 normal = -search.gap() / depth;
  const bool is_last_out = normal.dot(segment.at(1.0 - s) - end) >= 0.0;
  if (is_last_out && (!best || -depth > best->distance + kParallel))
    best = {-depth, normal, search.nearest().point, s};
}

MeshCollider::MeshCollider(const TriangleMesh& mesh) : impl_(std::make_unique<const Impl>(mesh)) {}
MeshCollider::~MeshCollider() = default;

std::shared_ptr<const MeshCollider> shared_collider(const std::shared_ptr<const TriangleMesh>& mesh) {
  // Compared by ownership, because another mesh may get the same address later.
  using Known = std::map<std::weak_ptr<const TriangleMesh>, std::weak_ptr<const MeshCollider>,
                         std::owner_less<std::weak_ptr<const TriangleMesh>>>;
  static std::mutex mutex;
  static Known known;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    for (auto one = known.begin(); one != known.end();)
      one = one->second.expired() ? known.erase(one) : std::next(one);
    const auto found = known.find(mesh);
    if (found != known.end())
      if (auto collider = found->second.lock()) return collider;
  }
  // Without the lock: two threads that make the same collider at once each keep their own.
  auto collider = std::make_shared<const MeshCollider>(*mesh);
  const std::lock_guard<std::mutex> lock(mutex);
  known[mesh] = collider;
  return collider;
}

const MeshShape& MeshCollider::shape() const {
  return impl_->shape;
}

double MeshCollider::search_cost() const {
  return impl_->search_cost;
}

double MeshCollider::deep_search_cost(double depth) const {
  constexpr double kDeepFactor = 10.0, kPartsPerSearch = 600.0;
  const MeshSurface& surface = impl_->shape.surface;
  const double parts = static_cast<double>(surface.faces().size() + surface.edges().size());
  const double centred = std::min(1.0, 2.0 * depth / std::max(1e-9, surface.bounds().sizes().minCoeff()));
  return kDeepFactor * impl_->search_cost + parts / kPartsPerSearch * centred * centred;
}

/// Deep inside, the surface may be at any distance. A segment whose middle is out of the bounds is searched
/// no farther than the margin: with an end inside it cuts the surface, at the distance 0.
std::optional<ClosestFeatures> MeshCollider::closest(const Capsule& capsule, double margin) const {
  const MeshSurface& surface = impl_->shape.surface;
  const Segment segment(capsule);
  if (surface.is_beyond(segment, capsule.radius + margin)) return std::nullopt;
  const bool has_parts = !impl_->parts.empty();
  const bool may_be_deep = surface.closed() && surface.bounds().contains(segment.middle());
  const double deep = has_parts ? std::max(capsule.radius + margin, impl_->deepest) : kUnlimited;
  const MeshNearest search =
      impl_->nearest(impl_->shape, segment, may_be_deep ? deep : capsule.radius + margin);
  if (!search.found()) return std::nullopt;
  if (has_parts && search.nearest().distance <= impl_->deepest) {
    if (std::optional<ClosestFeatures> leaves = impl_->leave_parts(segment)) {
      leaves->distance -= capsule.radius;
      return leaves;
    }
  }

  // Outside the normal is along the gap; on the surface, where the gap has no direction, and inside, where it
  // points inwards, the shortest exit gives it.
  const SurfaceNearest& nearest = search.nearest();
  ClosestFeatures features{nearest.distance, search.gap() / nearest.distance, nearest.point,
                           nearest.stretch.middle(), surface.number(nearest)};
  if (nearest.part == SurfacePart::face) {
    // The face's own normal has no rounding of a short gap.
    const Vector3 normal = surface.outward(nearest);
    features.normal = normal.dot(features.normal) < 0.0 ? Vector3(-normal) : normal;
  }
  if (!has_parts && Impl::has_to_leave(impl_->shape, search)) {
    features = impl_->leave(impl_->shape, segment, nearest);
  } else if (nearest.distance < kOnSurface) {
    features.normal = surface.outward(nearest).normalized();
  }
  features.distance -= capsule.radius;
  if (features.distance > margin) return std::nullopt;
  return features;
}

AxisSpan MeshCollider::span(const Capsule& capsule, const ClosestFeatures& features) const {
  const Segment axis(capsule);
  const double s = features.axis_parameter;
  const MeshSurface& surface = impl_->shape.surface;
  const bool is_face = features.part >= 0 && features.part < static_cast<int>(surface.faces().size());
  if (!is_face || axis.along.isZero(0.0)) return {s, s};
  const Interval over = surface.over(surface.faces()[features.part], axis, s);
  if ((over.s1 - over.s0) * axis.along.norm() < kMinFlatLength) return {s, s};
  return {std::min(std::max(over.s0, 0.0), s), std::max(std::min(over.s1, 1.0), s)};
}

AxisSpan MeshCollider::pad(const Capsule& capsule, const ClosestFeatures& features) const {
  const Segment axis(capsule);
  const double s = features.axis_parameter;
  if (features.part < 0) return {s, s};
  const Pad pad = impl_->shape.surface.pad(axis, features);
  const double middle = 0.5 * (pad.s0 + pad.s1);
  if (pad.longest * axis.along.norm() < kMinFlatLength) return {middle, middle};
  return {pad.s0, pad.s1};
}

}  // namespace mrhi
