#include "solid_mesh.h"

#include <cstdio>
#include <cstdlib>
#include <stdexcept>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace mrhi {
namespace {

/// qhull's memory, and a place for what it would print.
class Qhull {
 public:
  Qhull() : complaints_(open_memstream(&text_, &length_)) { qh_zero(&qh_, complaints_); }
  ~Qhull() {
    int kept = 0, total = 0;
    qh_freeqhull(&qh_, !qh_ALL);
    qh_memfreeshort(&qh_, &kept, &total);
    std::fclose(complaints_);
    std::free(text_);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  bool run(std::vector<Vector3>& points) {
    static_assert(sizeof(Vector3) == 3 * sizeof(coordT), "points are read in place");
    char command[] = "qhull";
    return qh_new_qhull(&qh_, 3, static_cast<int>(points.size()), points[0].data(), False, command, nullptr,
                        complaints_) == 0;
  }
  /// Calls `see(points)` for each facet, its points in their order round it, from outside always the same
  /// way.
  template <typename See>
  void each_facet(const See& see) {
    for (facetT* facet = qh_.facet_list; facet != nullptr && facet->next != nullptr; facet = facet->next) {
      setT* around = qh_facet3vertex(&qh_, facet);
      const int count = qh_setsize(&qh_, around);
      std::vector<int> points;
      points.reserve(static_cast<std::size_t>(count));
      for (int i = 0; i < count; ++i)
        points.push_back(qh_pointid(&qh_, static_cast<vertexT*>(SETelem_(around, i))->point));
      qh_settempfree(&qh_, &around);
      see(points);
    }
  }

 private:
  char* text_ = nullptr;
  std::size_t length_ = 0;
  std::FILE* complaints_;
  qhT qh_{};
};

}  // namespace

TriangleMesh convex_hull(const TriangleMesh& mesh) {
  std::vector<Vector3> points = mesh.vertices;
  Qhull hull;
  if (points.size() < 4 || !hull.run(points))
    throw NoVolume("has no volume, nor has its convex hull; allowed: corners that are not in one plane");
  TriangleMesh result;
  std::vector<int> name(points.size(), -1);
  hull.each_facet([&](std::vector<int>& around) {
    for (int& point : around) {
      int& known = name[static_cast<std::size_t>(point)];
      if (known < 0) {
        known = static_cast<int>(result.vertices.size());
        result.vertices.push_back(mesh.vertices[static_cast<std::size_t>(point)]);
      }
      point = known;
    }
    for (std::size_t i = 2; i < around.size(); ++i)
      result.triangles.push_back({{around[0], around[i - 1], around[i]}});
  });
  return result;
}

}  // namespace mrhi
