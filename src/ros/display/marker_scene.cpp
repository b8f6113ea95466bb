#include "marker_scene.h"

#include <OgreEntity.h>
#include <OgreManualObject.h>
#include <OgreMaterialManager.h>
#include <OgreSceneManager.h>
#include <OgreSceneNode.h>
#include <OgreTechnique.h>
#include <rviz/mesh_loader.h>
#include <rviz/ogre_helpers/movable_text.h>
#include <rviz/ogre_helpers/shape.h>
#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <utility>

namespace mrhi {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr float kOpaque = 0.998f;

std::string new_name(const char* kind) {
  static int count = 0;
  return "mr_hand_interaction/" + std::string(kind) + std::to_string(count++);
}

template <typename Vector>
Ogre::Vector3 to_ogre(const Vector& v) {
  return Ogre::Vector3(static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z));
}

Ogre::Quaternion to_ogre(const geometry_msgs::Quaternion& q) {
  return Ogre::Quaternion(static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
                          static_cast<float>(q.z));
}

Ogre::ColourValue to_ogre(const std_msgs::ColorRGBA& c) {
  return Ogre::ColourValue(c.r, c.g, c.b, c.a);
}

}  // namespace

Ogre::MaterialPtr vertex_colour_material(bool blended, bool both_sides) {
  const std::string name = std::string("mr_hand_interaction/vertex_colours") + (blended ? "_blended" : "") +
                           (both_sides ? "_both_sides" : "");
  Ogre::MaterialManager& manager = Ogre::MaterialManager::getSingleton();
  if (manager.resourceExists(name)) return manager.getByName(name, kGroup);
  Ogre::MaterialPtr material = manager.create(name, kGroup);
  material->setReceiveShadows(false);
  material->setLightingEnabled(false);
  material->setCullingMode(both_sides ? Ogre::CULL_NONE : Ogre::CULL_CLOCKWISE);
  if (blended) {
    material->setSceneBlending(Ogre::SBT_TRANSPARENT_ALPHA);
    material->setDepthWriteEnabled(!both_sides);
    // Ogre draws what writes depth among the solid, where it would hide what lies behind it.
    material->getTechnique(0)->getPass(0)->setTransparentSortingForced(true);
  }
  return material;
}

/// A marker as it is drawn.
struct MarkerScene::Item {
  Item(int marker_type, Ogre::SceneManager* scene_manager, Ogre::SceneNode* layer)
      : type(marker_type), manager(scene_manager), node(layer->createChildSceneNode()) {}
  ~Item() {
    if (triangles) manager->destroyManualObject(triangles);
    if (mesh) manager->destroyEntity(mesh);
    if (own_material) Ogre::MaterialManager::getSingleton().remove(material_name);
    shapes.clear();
    text.reset();
    manager->destroySceneNode(node);
  }

  int type;
  Ogre::SceneManager* manager;
  Ogre::SceneNode* node;
  Ogre::ManualObject* triangles = nullptr;
  bool has_triangles = false;
  std::vector<std::unique_ptr<rviz::Shape>> shapes;
  std::unique_ptr<rviz::MovableText> text;
  Ogre::Entity* mesh = nullptr;
  std::string mesh_uri;
  bool own_material = false;
  std::string material_name;
  rviz::SelectionHandlerPtr selection;
};

MarkerScene::MarkerScene(Ogre::SceneManager* manager, Ogre::SceneNode* parent, SelectionFactory selection)
    : manager_(manager), parent_(parent), selection_(std::move(selection)) {}

MarkerScene::~MarkerScene() {
  clear();
  for (auto& [name, node] : layers_) manager_->destroySceneNode(node);
}

void MarkerScene::clear() {
  items_.clear();
  missing_.clear();
}

Ogre::SceneNode* MarkerScene::layer(const std::string& name) {
  Ogre::SceneNode*& node = layers_[name];
  if (!node) node = parent_->createChildSceneNode();
  return node;
}

void MarkerScene::show_layer(const std::string& name, bool shown) {
  layer(name)->setVisible(shown);
}

void MarkerScene::take(const MarkerArray& array) {
  for (const Marker& marker : array.markers) {
    if (marker.action == Marker::DELETEALL) items_.clear();
    if (marker.action == Marker::DELETE) items_.erase({marker.ns, marker.id});
    if (marker.action == Marker::ADD) add(marker);
  }
}

void MarkerScene::add(const Marker& marker) {
  std::unique_ptr<Item>& item = items_[{marker.ns, marker.id}];
  const bool fresh = !item || item->type != marker.type || item->mesh_uri != marker.mesh_resource;
  if (fresh) item = std::make_unique<Item>(marker.type, manager_, layer(marker.ns));
  item->mesh_uri = marker.mesh_resource;
  item->node->setPosition(to_ogre(marker.pose.position));
  item->node->setOrientation(to_ogre(marker.pose.orientation));
  switch (marker.type) {
    case Marker::TRIANGLE_LIST:
      draw_triangles(marker, *item);
      break;
    case Marker::SPHERE_LIST:
      draw_spheres(marker, *item);
      break;
    case Marker::TEXT_VIEW_FACING:
      draw_text(marker, *item);
      break;
    case Marker::MESH_RESOURCE:
      draw_mesh(marker, *item);
      break;
    default:
      draw_shape(marker, *item);
      break;
  }
  const bool is_body = marker.ns == "objects" || marker.ns == "fixtures";
  if (!fresh || !is_body || marker.text.empty()) return;
  item->selection = selection_(marker.text);
  item->selection->addTrackedObjects(item->node);
}

void MarkerScene::draw_triangles(const Marker& marker, Item& item) {
  const bool coloured = marker.colors.size() == marker.points.size();
  const auto is_clear = [](const std_msgs::ColorRGBA& c) { return c.a < kOpaque; };
  const bool blended = is_clear(marker.color) ||
                       (coloured && std::any_of(marker.colors.begin(), marker.colors.end(), is_clear));
  const std::string material = vertex_colour_material(blended, true)->getName();
  if (!item.triangles) {
    item.triangles = manager_->createManualObject(new_name("triangles"));
    item.triangles->setDynamic(true);
    item.node->attachObject(item.triangles);
  }
  if (marker.points.empty()) {
    item.triangles->clear();
    item.has_triangles = false;
    return;
  }
  item.node->setScale(to_ogre(marker.scale));
  item.triangles->estimateVertexCount(marker.points.size());
  const bool drawn = std::exchange(item.has_triangles, true);
  if (drawn) item.triangles->setMaterialName(0, material, kGroup);
  drawn ? item.triangles->beginUpdate(0)
        : item.triangles->begin(material, Ogre::RenderOperation::OT_TRIANGLE_LIST, kGroup);
  for (std::size_t i = 0; i < marker.points.size(); ++i) {
    item.triangles->position(to_ogre(marker.points[i]));
    item.triangles->colour(to_ogre(coloured ? marker.colors[i] : marker.color));
  }
  item.triangles->end();
}

void MarkerScene::draw_shape(const Marker& marker, Item& item) {
  const auto type = marker.type == Marker::SPHERE     ? rviz::Shape::Sphere
                    : marker.type == Marker::CYLINDER ? rviz::Shape::Cylinder
                                                      : rviz::Shape::Cube;
  if (item.shapes.empty()) {
    item.shapes.push_back(std::make_unique<rviz::Shape>(type, manager_, item.node));
    // rviz's cylinder is about y.
    if (type == rviz::Shape::Cylinder)
      item.shapes[0]->setOrientation(Ogre::Quaternion(Ogre::Degree(90), Ogre::Vector3::UNIT_X));
  }
  Ogre::Vector3 scale = to_ogre(marker.scale);
  if (type == rviz::Shape::Cylinder) std::swap(scale.y, scale.z);
  item.shapes[0]->setScale(scale);
  item.shapes[0]->setColor(to_ogre(marker.color));
}

void MarkerScene::draw_spheres(const Marker& marker, Item& item) {
  item.shapes.resize(std::min(item.shapes.size(), marker.points.size()));
  for (std::size_t i = 0; i < marker.points.size(); ++i) {
    if (i == item.shapes.size())
      item.shapes.push_back(std::make_unique<rviz::Shape>(rviz::Shape::Sphere, manager_, item.node));
    item.shapes[i]->setPosition(to_ogre(marker.points[i]));
    item.shapes[i]->setScale(to_ogre(marker.scale));
    item.shapes[i]->setColor(to_ogre(i < marker.colors.size() ? marker.colors[i] : marker.color));
  }
}

void MarkerScene::draw_text(const Marker& marker, Item& item) {
  if (!item.text) {
    item.text = std::make_unique<rviz::MovableText>(marker.text.empty() ? " " : marker.text);
    item.text->setTextAlignment(rviz::MovableText::H_CENTER, rviz::MovableText::V_CENTER);
    item.node->attachObject(item.text.get());
  }
  item.text->setCaption(marker.text.empty() ? " " : marker.text);
  item.text->setColor(to_ogre(marker.color));
  item.text->setCharacterHeight(static_cast<float>(marker.scale.z));
}

void MarkerScene::draw_mesh(const Marker& marker, Item& item) {
  if (!item.mesh) {
    const Ogre::MeshPtr mesh = rviz::loadMeshFromResource(marker.mesh_resource);
    if (!mesh) {
      missing_.insert(marker.mesh_resource);
      return;
    }
    item.mesh = manager_->createEntity(new_name("mesh"), mesh->getName());
    item.node->attachObject(item.mesh);
    if (!marker.mesh_use_embedded_materials) {
      item.material_name = new_name("mesh_material");
      Ogre::MaterialManager::getSingleton().create(item.material_name, kGroup);
      item.own_material = true;
      item.mesh->setMaterialName(item.material_name, kGroup);
    }
  }
  item.node->setScale(to_ogre(marker.scale));
  if (!item.own_material) return;
  const Ogre::MaterialPtr material =
      Ogre::MaterialManager::getSingleton().getByName(item.material_name, kGroup);
  const Ogre::ColourValue colour = to_ogre(marker.color);
  material->setAmbient(0.5f * colour.r, 0.5f * colour.g, 0.5f * colour.b);
  material->setDiffuse(colour);
  const bool blended = colour.a < kOpaque;
  material->setSceneBlending(blended ? Ogre::SBT_TRANSPARENT_ALPHA : Ogre::SBT_REPLACE);
  material->setDepthWriteEnabled(!blended);
}

}  // namespace mrhi
