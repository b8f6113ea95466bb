#pragma once

#include <OgreCamera.h>
#include <OgreManualObject.h>
#include <OgreMaterial.h>
#include <OgreMaterialManager.h>
#include <OgrePass.h>
#include <OgreSceneManager.h>
#include <OgreSceneNode.h>
#include <OgreTechnique.h>
#include <rviz/default_plugin/marker_utils.h>
#include <rviz/default_plugin/markers/marker_base.h>
#include <rviz/display_context.h>
#include <rviz/mesh_loader.h>
#include <rviz/ogre_helpers/movable_text.h>
#include <rviz/selection/selection_handler.h>
#include <rviz/selection/selection_manager.h>
#include <visualization_msgs/Marker.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "../../rendering/skin.h"
#include "../marker_layers.h"
#include "mr_hand_interaction/ros/markers.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

template <typename Vector>
Ogre::Vector3 to_ogre(const Vector& v) {
  return Ogre::Vector3(v.x, v.y, v.z);
}
inline Ogre::Vector3 to_ogre(const Vector3& v) {
  return Ogre::Vector3(v.x(), v.y(), v.z());
}
inline Ogre::Quaternion to_ogre(const geometry_msgs::Quaternion& q) {
  return Ogre::Quaternion(q.w, q.x, q.y, q.z);
}

constexpr const char* kStatus = "text";  ///< the layer of held objects
constexpr float kStatusHeight = 0.05f;   ///< height of its letters, over half the window's

constexpr const char* kGroup = "General";  ///< of OGRE's resources

/// Material of vertices with their own lighting: opaque, or blended by their alpha where nothing of the same
/// object is nearer, in whatever order its triangles are.
inline Ogre::MaterialPtr vertex_colour_material(bool blended) {
  const std::string name = std::string("mr_hand_interaction/vertex_colours") + (blended ? "_blended" : "");
  Ogre::MaterialManager& manager = Ogre::MaterialManager::getSingleton();
  if (manager.resourceExists(name)) return manager.getByName(name, kGroup);
  Ogre::MaterialPtr material = manager.create(name, kGroup);
  Ogre::Technique& technique = *material->getTechnique(0);
  if (blended) technique.createPass();  // the first finds what is nearest
  material->setReceiveShadows(false);
  material->setLightingEnabled(false);
  material->setCullingMode(Ogre::CULL_CLOCKWISE);
  if (blended) {
    material->setSceneBlending(Ogre::SBT_TRANSPARENT_ALPHA);
    technique.getPass(0)->setColourWriteEnabled(false);
    technique.getPass(1)->setDepthFunction(Ogre::CMPF_EQUAL);
    // Ogre sorts materials that write depth among the opaque, where they would hide bodies behind them.
    technique.getPass(0)->setTransparentSortingForced(true);
  }
  return material;
}

/// Draws the markers of Markers, with a node for each namespace, and the status text in a corner.
class MarkerScene {
 public:
  /// `selection` makes the handler of a body's shapes, which are below the node.
  using SelectionFactory =
      std::function<rviz::SelectionHandlerPtr(const std::string& body, const Ogre::SceneNode* node)>;
  /// `meshes` returns the scene's mesh of a file, or null.
  using MeshOfFile = std::function<const Mesh*(const std::string& uri)>;
  MarkerScene(rviz::DisplayContext* context, Ogre::SceneNode* parent, SelectionFactory selection,
              MeshOfFile meshes)
      : context_(context), parent_(parent), selection_(std::move(selection)), meshes_(std::move(meshes)) {}

  ~MarkerScene() {
    clear();
    for (auto& [name, node] : layers_) context_->getSceneManager()->destroySceneNode(node);
  }

  void take(const MarkerArray& array) {
    for (const Marker& marker : array.markers) {
      if (marker.action == Marker::DELETEALL) items_.clear(), status_.reset();
      if (marker.action == Marker::DELETE) items_.erase({marker.ns, marker.id});
      if (marker.action == Marker::ADD) add(marker);
    }
  }

  void clear() {
    items_.clear();
    status_.reset();
    missing_.clear();
  }

  void show_layer(const std::string& name, bool shown) { layer(name)->setVisible(shown); }

  /// Keeps the status text in its corner.
  void pin_status(const Ogre::Camera& camera) {
    const Ogre::Matrix4 to_world = (camera.getProjectionMatrix() * camera.getViewMatrix()).inverse();
    const float near_plane = -0.9f;
    const Ogre::Vector3 corner = to_world * Ogre::Vector3(-0.98f, -0.96f, near_plane);
    const Ogre::Vector3 above = to_world * Ogre::Vector3(-0.98f, -0.96f + kStatusHeight, near_plane);
    if (corner.isNaN()) return;  // the window has no size yet
    layer(kStatus)->_setDerivedPosition(corner);
    if (status_) status_->setCharacterHeight((above - corner).length());
  }

  /// Meshes that could not be loaded.
  const std::set<std::string>& missing() const { return missing_; }

 private:
  /// A marker with its scene node.
  struct Item {
    Item(int marker_type, rviz::DisplayContext* context, Ogre::SceneNode* layer)
        : type(marker_type),
          node(layer->createChildSceneNode()),
          drawn(rviz::createMarker(marker_type, nullptr, context, node)) {}
    ~Item() {
      drawn.reset();
      node->getCreator()->destroySceneNode(node);
    }

    int type;
    Ogre::SceneNode* node;
    std::unique_ptr<rviz::MarkerBase> drawn;
    rviz::SelectionHandlerPtr selection;
  };

  Ogre::SceneNode* layer(const std::string& name) {
    Ogre::SceneNode*& node = layers_[name];
    if (!node) node = parent_->createChildSceneNode();
    return node;
  }

  void draw_status(const Marker& marker) {
    if (!status_) {
      status_ = std::make_unique<rviz::MovableText>(marker.text);
      status_->setTextAlignment(rviz::MovableText::H_LEFT, rviz::MovableText::V_ABOVE);
      status_->showOnTop(true);
      layer(kStatus)->attachObject(status_.get());
    }
    const auto& c = marker.color;
    status_->setCaption(marker.text);
    status_->setColor(Ogre::ColourValue(c.r, c.g, c.b, c.a));
  }

  /// Makes what rviz cannot load, such as a text STL or a file of another machine, from the scene's
  /// triangles. rviz finds it by the file's name. Returns false if the scene has no such triangles.
  bool make_mesh(const std::string& uri) const {
    const Mesh* const mesh = meshes_(uri);
    if (mesh == nullptr || mesh->triangles->triangles.empty()) return false;
    Ogre::ManualObject object(uri);
    object.begin("BaseWhiteNoLighting", Ogre::RenderOperation::OT_TRIANGLE_LIST);
    for (const auto& triangle : mesh->triangles->triangles) {
      std::array<Vector3, 3> corners;
      for (std::size_t i = 0; i < 3; ++i)
        corners[i] = mesh->triangles->vertices[triangle[i]].cwiseQuotient(mesh->scale);
      const Vector3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
      for (const Vector3& corner : corners) {
        object.position(to_ogre(corner));
        object.normal(to_ogre(normal));
      }
    }
    object.end();
    object.convertToMesh(uri, Ogre::ResourceGroupManager::DEFAULT_RESOURCE_GROUP_NAME);
    return true;
  }

  /// rviz lights shapes and meshes from the camera alone, and leaves their averted sides almost black.
  static void brighten(const std_msgs::ColorRGBA& c, rviz::MarkerBase& drawn) {
    constexpr float kEverywhere = 0.5f, kFacing = 0.5f;  // rviz: none, and 1
    for (const Ogre::MaterialPtr& material : drawn.getMaterials()) {
      if (!material->getTechnique(0)->getPass(0)->getLightingEnabled()) continue;  // lit by Markers
      material->setSelfIllumination(kEverywhere * c.r, kEverywhere * c.g, kEverywhere * c.b);
      material->setDiffuse(kFacing * c.r, kFacing * c.g, kFacing * c.b, c.a);
    }
  }

  void add(const Marker& marker) {
    if (marker.ns == kStatus) return draw_status(marker);
    if (marker.type == Marker::MESH_RESOURCE && !rviz::loadMeshFromResource(marker.mesh_resource) &&
        !make_mesh(marker.mesh_resource))
      missing_.insert(marker.mesh_resource);
    std::unique_ptr<Item>& item = items_[{marker.ns, marker.id}];
    if (!item || item->type != marker.type)
      item = std::make_unique<Item>(marker.type, context_, layer(marker.ns));
    item->drawn->setMessage(marker);
    const bool is_body = marker.ns == "objects" || marker.ns == "fixtures";
    if ((is_body && marker.color.a > 0.0f) || marker.ns == "capsules") brighten(marker.color, *item->drawn);
    if (!is_body || marker.text.empty()) return;
    if (!item->selection) item->selection = selection_(marker.text, item->node);
    item->selection->updateTrackedBoxes();  // the frame of what is selected follows the body
    // Set each time: the marker resets the handle.
    rviz::SelectionManager::setPickHandle(item->selection->getHandle(), item->node);
  }

  rviz::DisplayContext* context_;
  Ogre::SceneNode* parent_;
  SelectionFactory selection_;
  MeshOfFile meshes_;
  std::map<std::string, Ogre::SceneNode*> layers_;
  std::map<std::pair<std::string, int>, std::unique_ptr<Item>> items_;
  std::unique_ptr<rviz::MovableText> status_;
  std::set<std::string> missing_;
};

constexpr float kSpecular = 0.10f, kShininess = 14.0f;  // of the highlight (Blinn-Phong)
constexpr float kRimLight = 0.06f;                      // of the fine hairs at the outline

/// Reflection of a skin towards the camera besides its colour.
inline float sheen(const Eigen::Vector3f& normal, const Eigen::Vector3f& to_eye) {
  const Eigen::Vector3f half = (main_light() + to_eye).normalized();
  const float facing = std::clamp(normal.dot(to_eye), 0.0f, 1.0f);
  return kSpecular * std::pow(std::max(0.0f, normal.dot(half)), kShininess) +
         kRimLight * (1.0f - facing) * (1.0f - facing) * (1.0f - facing);
}

using SkinTriangles = std::vector<std::array<int, 3>>;

/// Each triangle of a skin in four: the middle of edge i is vertex i after the skin's own.
class FineSkin {
 public:
  explicit FineSkin(const Skin& skin) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [found, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<int>(skin.size() + edges_.size()));
      if (is_new) edges_.push_back({a, b});
      return found->second;
    };
    for (const auto& [a, b, c] : skin.triangles()) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& triangle : SkinTriangles{{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        triangles_.push_back(triangle);
    }
  }

  const SkinTriangles& triangles() const { return triangles_; }

  /// Adds the middles, on the curve that the normals at the ends give, so that outlines are round: Phong
  /// tessellation (Boubekeur & Alexa 2008), half as strong as a plane's, which is right for an arc.
  ///
  ///     m = (a + b) / 2 + (s.n_b n_b - s.n_a n_a) / 8,   s = b - a
  void add_middles(SkinSurface& surface, std::vector<Rgb>& colours) const {
    std::size_t next = surface.vertices.size();
    surface.vertices.resize(next + edges_.size());
    colours.resize(next + edges_.size());
    for (const auto& [a, b] : edges_) {
      const Vector3 side = surface.vertices[b] - surface.vertices[a];
      const Vector3 &n_a = surface.normals[a], &n_b = surface.normals[b];
      surface.vertices[next] =
          surface.vertices[a] + 0.5 * side + 0.125 * (side.dot(n_b) * n_b - side.dot(n_a) * n_a);
      colours[next++] = 0.5f * (colours[a] + colours[b]);
    }
  }

 private:
  std::vector<std::array<int, 2>> edges_;
  SkinTriangles triangles_;
};

constexpr double kFineDistance = 0.6;  ///< distance from the camera at which facets would be seen [m]

inline void add_vertex(const Vector3& place, const Rgb& c, float alpha, Ogre::ManualObject& object) {
  object.position(to_ogre(place));
  object.colour(c[0], c[1], c[2], alpha);
}

/// A hand's skin as one mesh with a colour for each vertex, lighting included: that of light.h, and the sheen
/// of skin, which depends on the camera. Finer near the camera.
class SkinObject {
 public:
  SkinObject(Ogre::SceneManager* manager, Ogre::SceneNode* parent)
      : skin_(Skin::detailed()), manager_(manager), node_(parent->createChildSceneNode()) {
    static int count = 0;
    object_ = manager_->createManualObject("mr_hand_interaction/skin" + std::to_string(count++));
    object_->setDynamic(true);
    node_->attachObject(object_);
  }

  ~SkinObject() {
    manager_->destroyManualObject(object_);
    manager_->destroySceneNode(node_);
  }

  SkinObject(const SkinObject&) = delete;
  SkinObject& operator=(const SkinObject&) = delete;

  /// `eye` in world [m]. Draws nothing if the hand has no complete skin. `glassy`: shows the capsules within.
  void draw(const RenderedHand& rendered, const FrameResult& result, const SimulationState& state,
            const SkinTone& tone, bool glassy, const Vector3& eye) {
    object_->setVisible(skin_.pose(rendered.hand, surface_));
    if (!object_->isVisible()) return;
    press_flat(result.contacts, state, rendered.hand.id, skin_, surface_);
    paint_skin(skin_, rendered, surface_, colours_, tone);
    for (std::size_t v = 0; v < colours_.size(); ++v) {
      const Eigen::Vector3f to_eye = (eye - surface_.vertices[v]).cast<float>().normalized();
      colours_[v] = (colours_[v] + sheen(surface_.normals[v].cast<float>(), to_eye)).min(1.0f);
    }
    static const FineSkin fine(skin_);
    const bool near = (eye - rendered.hand.palm.position).norm() < kFineDistance;
    if (glassy)  // clear of the capsules' surface
      for (std::size_t v = 0; v < skin_.size(); ++v)
        surface_.vertices[v] += kCapsuleClearance * surface_.normals[v];
    if (near) fine.add_middles(surface_, colours_);
    const SkinTriangles& triangles = near ? fine.triangles() : skin_.triangles();
    begin(glassy, triangles.size());
    for (std::size_t v = 0; v < colours_.size(); ++v)
      add_vertex(surface_.vertices[v], colours_[v], glassy ? kGlassyAlpha : 1.0f, *object_);
    end(rendered.hand.side, triangles);
  }

  /// The tracked hand where it differs from the rendered one, most opaque at its outline.
  void draw_ghost(const Hand& rendered, const Hand& tracked, const PictureStyle& style, const Vector3& eye) {
    const bool apart = farthest_joint(rendered, tracked) > style.ghost_from;
    object_->setVisible(apart && skin_.pose(tracked, surface_) && skin_.pose(rendered, beneath_));
    if (!object_->isVisible()) return;
    begin(true, skin_.triangles().size());
    for (std::size_t v = 0; v < skin_.size(); ++v) {
      const Vector3 to_eye = (eye - surface_.vertices[v]).normalized();
      const auto outline = static_cast<float>(1.0 - std::abs(surface_.normals[v].dot(to_eye)));
      const float seen = ghost_opacity((surface_.vertices[v] - beneath_.vertices[v]).norm(), style);
      add_vertex(surface_.vertices[v], ghost_colour(surface_.normals[v], style),
                 seen * (0.35f + 0.65f * outline), *object_);
    }
    end(tracked.side, skin_.triangles());
  }

  void hide() { object_->setVisible(false); }

 private:
  static constexpr float kGlassyAlpha = 0.4f;          // opacity over capsules
  static constexpr double kCapsuleClearance = 0.0012;  // [m]

  void begin(bool blended, std::size_t triangles) {
    object_->estimateVertexCount(triangles / 2 + 2);  // Euler's formula for a sphere
    object_->estimateIndexCount(3 * triangles);
    const std::string& material = vertex_colour_material(blended)->getName();
    if (std::exchange(begun_, true)) {
      object_->setMaterialName(0, material, kGroup);
      object_->beginUpdate(0);
    } else {
      object_->begin(material, Ogre::RenderOperation::OT_TRIANGLE_LIST, kGroup);
    }
  }

  void end(Side side, const SkinTriangles& triangles) {
    const std::size_t second = side == Side::left ? 2 : 1;
    for (const auto& t : triangles) object_->triangle(t[0], t[second], t[3 - second]);
    object_->end();
  }

  const Skin& skin_;
  Ogre::SceneManager* manager_;
  Ogre::SceneNode* node_;
  Ogre::ManualObject* object_;
  bool begun_ = false;
  SkinSurface surface_, beneath_;
  std::vector<Rgb> colours_;
};

}  // namespace mrhi
