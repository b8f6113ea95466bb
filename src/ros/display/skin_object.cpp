#include "skin_object.h"

#include <OgreManualObject.h>
#include <OgreSceneManager.h>
#include <OgreSceneNode.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "../../rendering/skin.h"
#include "../hand_markers.h"
#include "marker_scene.h"

namespace mrhi {
namespace {

constexpr float kSheen = 0.10f, kSharpness = 14.0f;  // of the highlight (Blinn-Phong)
constexpr float kEdge = 0.06f;                       // of the fine hairs at the outline

/// What a skin reflects to the eye besides its colour.
float sheen(const Eigen::Vector3f& normal, const Eigen::Vector3f& to_eye) {
  const Eigen::Vector3f half = (main_light() + to_eye).normalized();
  const float facing = std::clamp(normal.dot(to_eye), 0.0f, 1.0f);
  return kSheen * std::pow(std::max(0.0f, normal.dot(half)), kSharpness) +
         kEdge * (1.0f - facing) * (1.0f - facing) * (1.0f - facing);
}

void add_vertex(const Vector3& place, const Vector3& normal, const Rgb& c, float alpha,
                Ogre::ManualObject& object) {
  object.position(static_cast<float>(place.x()), static_cast<float>(place.y()),
                  static_cast<float>(place.z()));
  object.normal(static_cast<float>(normal.x()), static_cast<float>(normal.y()),
                static_cast<float>(normal.z()));
  object.colour(c[0], c[1], c[2], alpha);
}

}  // namespace

SkinObject::SkinObject(Ogre::SceneManager* manager, Ogre::SceneNode* parent)
    : skin_(Skin::detailed()),
      paint_(skin_),
      wrist_(skin_),
      manager_(manager),
      node_(parent->createChildSceneNode()) {
  static int count = 0;
  object_ = manager_->createManualObject("mr_hand_interaction/skin" + std::to_string(count++));
  object_->setDynamic(true);
  node_->attachObject(object_);
}

SkinObject::~SkinObject() {
  manager_->destroyManualObject(object_);
  manager_->destroySceneNode(node_);
}

void SkinObject::hide() {
  object_->setVisible(false);
}

void SkinObject::begin(unsigned section, bool blended) {
  object_->estimateVertexCount(skin_.size() + 1);
  object_->estimateIndexCount(3 * skin_.triangles().size());
  if (section < sections_) {
    object_->beginUpdate(section);
  } else {
    object_->begin(vertex_colour_material(blended, false)->getName(), Ogre::RenderOperation::OT_TRIANGLE_LIST,
                   kGroup);
    ++sections_;
  }
}

void SkinObject::add_section(unsigned section, const Triangles& triangles, Side side) {
  begin(section, section > 0);
  for (std::size_t v = 0; v < colours_.size(); ++v)
    add_vertex(surface_.vertices[v], surface_.normals[v], colours_[v], wrist_.opacity(v), *object_);
  const std::size_t second = side == Side::left ? 2 : 1;
  for (const auto& triangle : triangles)
    object_->triangle(triangle[0], triangle[second], triangle[3 - second]);
  object_->end();
}

bool SkinObject::draw(const RenderedHand& rendered, const FrameResult& result, const SimulationState& state,
                      const SkinTone& tone, const Vector3& eye) {
  object_->setVisible(skin_.pose(rendered.hand, surface_));
  if (!object_->isVisible()) return false;
  press_flat(result.contacts, state, rendered.hand.id, skin_, surface_);
  paint_.paint(rendered, surface_, colours_, tone);
  for (std::size_t v = 0; v < colours_.size(); ++v) {
    const Eigen::Vector3f to_eye = (eye - surface_.vertices[v]).cast<float>().normalized();
    colours_[v] = (colours_[v] + sheen(surface_.normals[v].cast<float>(), to_eye)).min(1.0f);
  }
  wrist_.add_lid(surface_, colours_);
  // The wrist's far side is seen through its near side, and is drawn before it.
  const Side side = rendered.hand.side, averted = side == Side::left ? Side::right : Side::left;
  add_section(0, wrist_.opaque(), side);
  add_section(1, wrist_.fading(), averted);
  add_section(2, wrist_.fading(), side);
  return true;
}

void SkinObject::draw_ghost(const Hand& rendered, const Hand& tracked, const PictureStyle& style,
                            const Vector3& eye) {
  const bool apart = farthest_apart(rendered, tracked) > style.ghost_from;
  object_->setVisible(apart && skin_.pose(tracked, surface_) && skin_.pose(rendered, beneath_));
  if (!object_->isVisible()) return;
  begin(0, true);
  for (std::size_t v = 0; v < skin_.size(); ++v) {
    const Vector3 to_eye = (eye - surface_.vertices[v]).normalized();
    const auto outline = static_cast<float>(1.0 - std::abs(surface_.normals[v].dot(to_eye)));
    const float seen = ghost_opacity((surface_.vertices[v] - beneath_.vertices[v]).norm(), style);
    add_vertex(surface_.vertices[v], surface_.normals[v], ghost_colour(surface_.normals[v], style),
               seen * wrist_.opacity(v) * (0.35f + 0.65f * outline), *object_);
  }
  const std::size_t second = tracked.side == Side::left ? 2 : 1;
  for (const auto& t : skin_.triangles())
    object_->triangle(static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[second]),
                      static_cast<std::uint32_t>(t[3 - second]));
  object_->end();
}

}  // namespace mrhi
