// All that uses FCL. Its collision results are not used (its capsules' depths and normals are approximate):
// its tree finds candidates, closed forms measure them.
#if __has_include(<fcl/geometry/shape/box.h>)
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision_object.h>
#else
#include <fcl/collision_object.h>
#include <fcl/shape/geometric_shapes.h>
#endif

#include <algorithm>

#include "neighbours.h"

namespace mrhi {
namespace {

#if __has_include(<fcl/geometry/shape/box.h>)
using FclVector = fcl::Vector3<double>;
using FclSphere = fcl::Sphere<double>;
using FclBox = fcl::Box<double>;
using FclObject = fcl::CollisionObject<double>;
using FclManager = fcl::DynamicAABBTreeCollisionManager<double>;
#else
using FclVector = fcl::Vec3f;
using FclSphere = fcl::Sphere;
using FclBox = fcl::Box;
using FclObject = fcl::CollisionObject;
using FclManager = fcl::DynamicAABBTreeCollisionManager;
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

}  // namespace

struct BroadPhase::Impl {
  struct Body {
    std::shared_ptr<FclSphere> sphere = std::make_shared<FclSphere>(0.0);
    FclObject object{sphere};
    Vector3 centre = Vector3::Zero();
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

  /// FCL hands over the two in either order, and goes on as long as false is returned.
  static bool add(FclObject* a, FclObject* b, void* data) {
    Impl& self = *static_cast<Impl*>(data);
    self.found.push_back(self.index_of(a == &self.query ? b : a));
    return false;
  }
  static bool add_pair(FclObject* a, FclObject* b, void* data) {
    Impl& self = *static_cast<Impl*>(data);
    const Body &x = self.body_of(a), &y = self.body_of(b);
    const double reach = x.sphere->radius + y.sphere->radius;
    if ((x.centre - y.centre).squaredNorm() > reach * reach) return false;
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
  FclObject query{box};
};

BroadPhase::BroadPhase(std::size_t bodies) : impl_(std::make_unique<Impl>(bodies)) {}
BroadPhase::~BroadPhase() = default;
BroadPhase::BroadPhase(BroadPhase&&) noexcept = default;

/// The sphere is a box to FCL's tree; the object must be registered but once.
void BroadPhase::update(int index, const Vector3& centre, double radius) {
  Impl::Body& body = impl_->bodies.at(index);
  body.sphere->radius = radius;
  body.centre = centre;
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
  place(impl_->query, *impl_->box, 0.5 * (min + max));
  impl_->found.clear();
  impl_->manager.collide(&impl_->query, impl_.get(), &Impl::add);
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
