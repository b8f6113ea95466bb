#pragma once

#include <ros/subscriber.h>
#include <rviz/display.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "../scene_view.h"
#include "marker_scene.h"
#include "mr_hand_interaction/ros/markers.h"
#include "skin_object.h"

namespace rviz {
class BoolProperty;
class ColorProperty;
class FloatProperty;
class StringProperty;
}  // namespace rviz

namespace mrhi {

/// Hands, objects and what acts between them, drawn in rviz from poses: `scene` once, then `rendered_hands`,
/// `tracked_hands`, `objects` and `contacts`. What is drawn is what Markers says; skins are bent and lit
/// here.
class InteractionDisplay : public rviz::Display {
 public:
  InteractionDisplay();
  ~InteractionDisplay() override;

  void update(float wall_dt, float ros_dt) override;
  void reset() override;

 protected:
  void onInitialize() override;
  void onEnable() override;
  void onDisable() override;

 private:
  class ObjectSelection;
  /// A layer's switch, and where it has them its colour and a threshold.
  struct Layer {
    rviz::BoolProperty* shown = nullptr;
    rviz::ColorProperty* colour = nullptr;
    rviz::FloatProperty* threshold = nullptr;
  };
  rviz::BoolProperty* add_layer(const char* name, const char* title, bool shown, const char* description);
  void add_properties();
  void subscribe();
  void unsubscribe();
  template <typename Message, typename Take>
  void listen(const std::string& topic, Take take);
  void read_properties();
  bool place_in_fixed_frame();
  Vector3 eye() const;
  void draw();
  void draw_hands(const FrameResult& result);
  /// Fingers that touch an object, and with what force.
  std::string touching(const std::string& object);

  std::map<std::string, Layer> layers_;
  rviz::StringProperty* namespace_;
  rviz::BoolProperty* unreliable_;
  rviz::ColorProperty* touching_;
  rviz::ColorProperty* slips_;
  rviz::FloatProperty* ghost_alpha_;

  std::string subscribed_namespace_;
  bool subscribed_unreliable_ = false;
  std::vector<ros::Subscriber> subscribers_;
  std::string frame_;
  ros::Time stamp_;           ///< of the last frame
  ros::WallTime hands_came_;  ///< when hands last came
  std::map<std::string, mr_hand_interaction::ObjectState> objects_;
  SceneView view_;
  std::unique_ptr<Markers> markers_;
  std::unique_ptr<MarkerScene> scene_;
  std::vector<std::unique_ptr<SkinObject>> skins_, ghosts_;
  SkinTone tone_;
  visualization_msgs::MarkerArray array_;
  Vector3 drawn_from_ = Vector3::Zero();  ///< the eye
  bool changed_ = false;
};

}  // namespace mrhi
