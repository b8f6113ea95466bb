#pragma once

#include <OgreMaterial.h>
#include <rviz/selection/selection_handler.h>
#include <visualization_msgs/MarkerArray.h>

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace Ogre {
class Entity;
class ManualObject;
class SceneManager;
class SceneNode;
}  // namespace Ogre
namespace rviz {
class MovableText;
class Shape;
}  // namespace rviz

namespace mrhi {

constexpr const char* kGroup = "General";  ///< of OGRE's resources

/// Materials of vertices that bring their own light: opaque, and blended by their alpha. `both_sides`: of
/// surfaces that have no inside.
Ogre::MaterialPtr vertex_colour_material(bool blended, bool both_sides);

/// Draws the markers that Markers makes, a node for each namespace.
class MarkerScene {
 public:
  /// `selection` gives the handler of a body's shapes.
  using SelectionFactory = std::function<rviz::SelectionHandlerPtr(const std::string& body)>;
  MarkerScene(Ogre::SceneManager* manager, Ogre::SceneNode* parent, SelectionFactory selection);
  ~MarkerScene();

  void take(const visualization_msgs::MarkerArray& array);
  void clear();
  void show_layer(const std::string& name, bool shown);
  /// Meshes that could not be loaded.
  const std::set<std::string>& missing() const { return missing_; }

 private:
  struct Item;
  using Key = std::pair<std::string, int>;
  Ogre::SceneNode* layer(const std::string& name);
  void add(const visualization_msgs::Marker& marker);
  void draw_triangles(const visualization_msgs::Marker& marker, Item& item);
  void draw_spheres(const visualization_msgs::Marker& marker, Item& item);
  void draw_shape(const visualization_msgs::Marker& marker, Item& item);
  void draw_text(const visualization_msgs::Marker& marker, Item& item);
  void draw_mesh(const visualization_msgs::Marker& marker, Item& item);

  Ogre::SceneManager* manager_;
  Ogre::SceneNode* parent_;
  SelectionFactory selection_;
  std::map<std::string, Ogre::SceneNode*> layers_;
  std::map<Key, std::unique_ptr<Item>> items_;
  std::set<std::string> missing_;
};

}  // namespace mrhi
