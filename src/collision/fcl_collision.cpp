// All that uses FCL. Its collision results are not used (its capsules' depths and normals are approximate):
// its trees find candidates, closed forms measure them.
#if __has_include(<fcl/geometry/bvh/BVH_model.h>)
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision_object.h>
#else
#include <fcl/BV/OBBRSS.h>
#include <fcl/BVH/BVH_model.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/collision_object.h>
#include <fcl/shape/geometric_shapes.h>
#endif

#include <algorithm>
#include <stdexcept>

#include "mesh_surface.h"
#include "mr_hand_interaction/collision/broad_phase.h"
#include "mr_hand_interaction/collision/mesh_collision.h"

namespace mrhi {
namespace {

#if __has_include(<fcl/geometry/bvh/BVH_model.h>)
using FclVector = fcl::Vector3<double>;
using FclObb = fcl::OBB<double>;
using FclTree = fcl::BVHModel<fcl::OBBRSS<double>>;
using FclSphere = fcl::Sphere<double>;
using FclBox = fcl::Box<double>;
using FclObject = fcl::CollisionObject<double>;
using FclManager = fcl::DynamicAABBTreeCollisionManager<double>;

void set_axes(FclObb& box, const Matrix3& axes) {
  box.axis = axes;
}
#else
using FclVector = fcl::Vec3f;
using FclObb = fcl::OBB;
using FclTree = fcl::BVHModel<fcl::OBBRSS>;
using FclSphere = fcl::Sphere;
using FclBox = fcl::Box;
using FclObject = fcl::CollisionObject;
using FclManager = fcl::DynamicAABBTreeCollisionManager;

void set_axes(FclObb& box, const Matrix3& axes) {
  for (int i = 0; i < 3; ++i) box.axis[i].setValue(axes(0, i), axes(1, i), axes(2, i));
}
#endif

FclVector to_fcl(const Vector3& v) {
  return FclVector(v.x(), v.y(), v.z());
}

template <typename Geometry>
void place(FclObject& object, Geometry& geometry, const Vector3& centre) {
  geometry.computeLocalAABB();
  object.setTranslation(to_fcl(centre));
  object.computeAABB();
}

/// The triangle nearest to a segment, nearer than `range`.
class NearestTriangle {
 public:
  NearestTriangle(const FclTree& tree, const MeshSurface& surface, const Segment& segment, double range)
      : tree_(tree), surface_(surface), segment_(segment), range_(range) {
    const Vector3 x = segment.along.isZero(0.0) ? Vector3::UnitX() : Vector3(segment.along.normalized());
    const Vector3 y = any_normal(x);
    Matrix3 axes;
    axes << x, y, x.cross(y);
    set_axes(around_, axes);
    around_.To = to_fcl(segment.middle());
    half_length_ = 0.5 * segment.along.norm();
    resize();
    descend(0);
  }

  bool found() const { return triangle_ >= 0; }
  int triangle() const { return triangle_; }
  const TriangleNearest& nearest() const { return nearest_; }

 private:
  void resize() {
    const double reach = std::min(range_, nearest_.distance) + 1e-9;
    around_.extent = to_fcl({half_length_ + reach, reach, reach});
  }

  double squared_distance(int node) const {
    const auto& place = tree_.getBV(node).bv.obb.To;
    return (Vector3(place[0], place[1], place[2]) - segment_.middle()).squaredNorm();
  }

  void descend(int node) {
    const auto& bounds = tree_.getBV(node);
    if (!bounds.bv.obb.overlap(around_)) return;
    if (bounds.isLeaf()) return measure(bounds.primitiveId());
    int first = bounds.leftChild(), second = bounds.rightChild();
    if (squared_distance(second) < squared_distance(first)) std::swap(first, second);
    descend(first);
    descend(second);
  }

  void measure(int triangle) {
    const Triangle& candidate = surface_.triangles()[static_cast<std::size_t>(triangle)];
    const TriangleNearest nearest = candidate.nearest(segment_);
    if (nearest.distance > range_) return;
    if (nearest.distance < nearest_.distance - kParallel) {
      nearest_ = nearest;
      triangle_ = triangle;
      resize();
    } else if (nearest.distance < nearest_.distance + kParallel && continues_face(candidate, nearest)) {
      nearest_.stretch.join(nearest.stretch);
      const double s = nearest_.stretch.middle();
      const double level = candidate.normal.dot(segment_.at(s) - candidate.corners[0]);
      nearest_.point = segment_.at(s) - level * candidate.normal;
    }
  }

  bool continues_face(const Triangle& candidate, const TriangleNearest& nearest) const {
    const bool faces = nearest.part == TrianglePart::face && nearest_.part == TrianglePart::face;
    return faces && std::abs(candidate.normal.dot(segment_.along)) < kParallel &&
           surface_.triangles()[static_cast<std::size_t>(triangle_)].normal.dot(candidate.normal) >
               1.0 - 1e-12;
  }

  const FclTree& tree_;
  const MeshSurface& surface_;
  const Segment& segment_;
  double range_, half_length_ = 0.0;
  FclObb around_;
  TriangleNearest nearest_;
  int triangle_ = -1;
};

}  // namespace

constexpr double kUnlimited = 1e300;

struct MeshCollider::Impl {
  explicit Impl(const TriangleMesh& mesh) : surface(mesh) {
    if (surface.triangles().empty()) throw std::invalid_argument("mesh has no triangle with an area");
    const int count = static_cast<int>(surface.triangles().size());
    tree.beginModel(count, 3 * count);
    for (const Triangle& t : surface.triangles()) {
      tree.addTriangle(to_fcl(t.corners[0]), to_fcl(t.corners[1]), to_fcl(t.corners[2]));
    }
    tree.endModel();
  }

  bool inside(const NearestTriangle& search, const Vector3& gap) const {
    return surface.closed() && gap.dot(surface.normal(search.triangle(), search.nearest())) < 0.0;
  }
  void leave_by_end(const Segment& segment, double s, ClosestFeatures& best) const;

  MeshSurface surface;
  FclTree tree;
};

/// Where the solid is hollow, an end may have its shortest way out to an edge or a vertex that points
/// inwards.
void MeshCollider::Impl::leave_by_end(const Segment& segment, double s, ClosestFeatures& best) const {
  const Vector3 end = segment.at(s);
  const Segment only_end(Capsule{end, end, 0.0});
  const NearestTriangle search(tree, surface, only_end, kUnlimited);
  const Vector3 gap = end - search.nearest().point;
  const double depth = search.nearest().distance;
  if (depth < kOnSurface || !inside(search, gap)) return;
  const Vector3 normal = -gap / depth;
  const bool is_last_out = normal.dot(segment.at(1.0 - s) - end) >= 0.0;
  if (is_last_out && -depth > best.distance + kParallel) best = {-depth, normal, search.nearest().point, s};
}

MeshCollider::MeshCollider(const TriangleMesh& mesh) : impl_(std::make_unique<const Impl>(mesh)) {}
MeshCollider::~MeshCollider() = default;

std::optional<ClosestFeatures> MeshCollider::closest(const Capsule& capsule, double margin) const {
  const MeshSurface& surface = impl_->surface;
  const Segment segment(capsule);
  const bool may_be_deep = surface.closed() && surface.in_bounds(segment.middle());
  const double reach = may_be_deep ? kUnlimited : capsule.radius + margin;
  const NearestTriangle search(impl_->tree, surface, segment, reach);
  if (!search.found()) return std::nullopt;

  const TriangleNearest& nearest = search.nearest();
  const double s = nearest.stretch.middle();
  const Vector3 gap = segment.at(s) - nearest.point;
  ClosestFeatures features{nearest.distance, gap / nearest.distance, nearest.point, s};
  if (nearest.distance < kOnSurface || impl_->inside(search, gap)) {
    features = leave_mesh(segment, surface, search.triangle());
    if (!surface.convex() && surface.closed()) {
      for (const double end : {0.0, 1.0}) impl_->leave_by_end(segment, end, features);
    }
  }
  features.distance -= capsule.radius;
  if (features.distance > margin) return std::nullopt;
  return features;
}

struct BroadPhase::Impl {
  struct Body {
    std::shared_ptr<FclSphere> sphere = std::make_shared<FclSphere>(0.0);
    FclObject object{sphere};
    bool registered = false, moved = false;
  };

  explicit Impl(std::size_t count) : bodies(count) {
    found.reserve(count);
    moved.reserve(count);
  }

  /// FCL balances its tree at every update: once for all that moved, then.
  void place_moved() {
    for (FclObject* object : moved) body_of(object).moved = false;
    if (!moved.empty()) manager.update(moved);
    moved.clear();
  }
  Body& body_of(const FclObject* object) { return *static_cast<Body*>(object->getUserData()); }

  static bool add(FclObject* a, FclObject* b, void* data) {
    Impl& self = *static_cast<Impl*>(data);
    self.found.push_back(self.index_of(a == &self.asked ? b : a));
    return false;
  }
  static bool add_pair(FclObject* a, FclObject* b, void* data) {
    Impl& self = *static_cast<Impl*>(data);
    const int i = self.index_of(a), j = self.index_of(b);
    self.found_pairs.emplace_back(std::min(i, j), std::max(i, j));
    return false;
  }
  int index_of(const FclObject* object) { return static_cast<int>(&body_of(object) - bodies.data()); }

  std::vector<Body> bodies;
  FclManager manager;
  std::vector<FclObject*> moved;
  std::vector<int> found;
  std::vector<std::pair<int, int>> found_pairs;
  std::shared_ptr<FclBox> box = std::make_shared<FclBox>(0.0, 0.0, 0.0);
  FclObject asked{box};
};

BroadPhase::BroadPhase(std::size_t bodies) : impl_(std::make_unique<Impl>(bodies)) {}
BroadPhase::~BroadPhase() = default;
BroadPhase::BroadPhase(BroadPhase&&) noexcept = default;

void BroadPhase::update(int index, const Vector3& centre, double radius) {
  Impl::Body& body = impl_->bodies.at(static_cast<std::size_t>(index));
  body.sphere->radius = radius;
  place(body.object, *body.sphere, centre);
  if (!body.registered) {
    body.object.setUserData(&body);
    impl_->manager.registerObject(&body.object);
    body.registered = true;
  } else if (!body.moved) {
    impl_->moved.push_back(&body.object);
    body.moved = true;
  }
}

const std::vector<int>& BroadPhase::query(const Vector3& min, const Vector3& max) {
  impl_->place_moved();
  impl_->box->side = to_fcl(max - min);
  place(impl_->asked, *impl_->box, 0.5 * (min + max));
  impl_->found.clear();
  impl_->manager.collide(&impl_->asked, impl_.get(), &Impl::add);
  std::sort(impl_->found.begin(), impl_->found.end());
  return impl_->found;
}

const std::vector<std::pair<int, int>>& BroadPhase::pairs() {
  impl_->place_moved();
  impl_->found_pairs.clear();
  if (impl_->bodies.size() > 1) impl_->manager.collide(impl_.get(), &Impl::add_pair);
  return impl_->found_pairs;
}

}  // namespace mrhi
