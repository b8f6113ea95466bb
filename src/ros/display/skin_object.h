#pragma once

#include <vector>

#include "../../rendering/skin.h"
#include "mr_hand_interaction/ros/markers.h"

namespace Ogre {
class ManualObject;
class SceneManager;
class SceneNode;
}  // namespace Ogre

namespace mrhi {

/// A hand's skin as one mesh with a normal and a colour for each vertex, light included: that of light.h, and
/// the sheen of skin, which depends on where the eye is.
class SkinObject {
 public:
  SkinObject(Ogre::SceneManager* manager, Ogre::SceneNode* parent);
  ~SkinObject();
  SkinObject(const SkinObject&) = delete;
  SkinObject& operator=(const SkinObject&) = delete;

  /// `eye` in world [m]. False, and nothing is drawn, if the hand has no whole skin.
  bool draw(const RenderedHand& rendered, const FrameResult& result, const SimulationState& state,
            const SkinTone& tone, const Vector3& eye);
  /// The tracked hand where it is elsewhere than the rendered one, strongest at its outline.
  void draw_ghost(const Hand& rendered, const Hand& tracked, const PictureStyle& style, const Vector3& eye);
  void hide();

 private:
  using Triangles = std::vector<SkinWrist::Triangle>;
  void begin(unsigned section, bool blended);
  void add_section(unsigned section, const Triangles& triangles, Side side);

  const Skin& skin_;
  const SkinPaint paint_;
  const SkinWrist wrist_;
  Ogre::SceneManager* manager_;
  Ogre::SceneNode* node_;
  Ogre::ManualObject* object_;
  unsigned sections_ = 0;  // of the object
  SkinSurface surface_, beneath_;
  std::vector<Rgb> colours_;
};

}  // namespace mrhi
