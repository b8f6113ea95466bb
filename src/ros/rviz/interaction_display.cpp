#include <OgreCamera.h>
#include <OgreSceneManager.h>
#include <OgreSceneNode.h>
#include <ros/ros.h>
#include <rviz/display.h>
#include <rviz/display_context.h>
#include <rviz/frame_manager.h>
#include <rviz/properties/bool_property.h>
#include <rviz/properties/color_property.h>
#include <rviz/properties/float_property.h>
#include <rviz/properties/quaternion_property.h>
#include <rviz/properties/string_property.h>
#include <rviz/properties/vector_property.h>
#include <rviz/selection/selection_handler.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>
#include <pluginlib/class_list_macros.hpp>

#include <QColor>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../../simulation/contact_phase.h"
#include "../../text/text.h"
#include "../scene_view.h"
#include "mr_hand_interaction/ros/markers.h"
#include "scene_objects.h"

namespace mrhi {
namespace {

using mr_hand_interaction::ObjectState;
using mr_hand_interaction::RenderedView;
using mr_hand_interaction::SceneDescription;

constexpr std::uint32_t kQueue = 10;
constexpr double kMinEyeMotion = 1e-4;  // [m]
const Rgb kSkin(0.91f, 0.73f, 0.62f);   // base of the skin's tone

QColor to_qt(const std_msgs::ColorRGBA& c) {
  return QColor::fromRgbF(c.r, c.g, c.b);
}
QColor to_qt(const Rgb& c) {
  return to_qt(color(c[0], c[1], c[2]));
}

Rgb to_rgb(const rviz::ColorProperty& property) {
  const QColor colour = property.getColor();
  return Eigen::Array3d(colour.redF(), colour.greenF(), colour.blueF()).cast<float>();
}

}  // namespace

/// Draws `scene` and `rendered_view` in rviz: what Markers makes, and skins, which are lit here.
class InteractionDisplay : public rviz::Display {
 public:
  InteractionDisplay() { add_properties(); }

  ~InteractionDisplay() override { unsubscribe(); }

  void update(float, float) override {
    read_properties();
    if (frame_.empty() || !place_in_fixed_frame()) return;
    if (hands_time_ != ros::SteadyTime() &&
        (ros::SteadyTime::now() - hands_time_).toSec() > kTransientLifetime) {
      view_.remove_hands();
      hands_time_ = ros::SteadyTime();
      changed_ = true;
    }
    if ((eye() - drawn_eye_).norm() > kMinEyeMotion) changed_ = true;
    if (std::exchange(changed_, false)) draw();
    scene_->pin_status(camera());
  }

  void reset() override {
    rviz::Display::reset();
    if (scene_) scene_->clear();
    markers_.reset();
    view_ = SceneView();
    objects_.clear();
    skins_.clear();
    ghosts_.clear();
    if (!subscribers_.empty()) subscribe();  // a new subscriber gets the scene
  }

 protected:
  void onInitialize() override {
    scene_ = std::make_unique<MarkerScene>(
        context_, scene_node_,
        [this](const std::string& body, const Ogre::SceneNode* node) {
          return rviz::SelectionHandlerPtr(new ObjectSelection(context_, body, node, *this));
        },
        [this](const std::string& uri) { return mesh_of_file(uri); });
  }

  void onEnable() override { subscribe(); }

  void onDisable() override {
    unsubscribe();
    reset();
  }

 private:
  const Mesh* mesh_of_file(const std::string& uri) const {
    const Mesh* found = nullptr;
    const auto look_in = [&](const auto& parts) {
      for (const auto& part : parts) {
        const Mesh* const mesh = std::get_if<Mesh>(&part.shape);
        if (found == nullptr && mesh != nullptr && mesh->uri == uri && mesh->triangles) found = mesh;
      }
    };
    for (const Body& body : view_.scene().bodies) look_in(body.visuals), look_in(body.shapes);
    return found;
  }

  /// Properties of an object in rviz's Selection panel.
  class ObjectSelection : public rviz::SelectionHandler {
   public:
    ObjectSelection(rviz::DisplayContext* context, std::string name, const Ogre::SceneNode* node,
                    InteractionDisplay& display)
        : rviz::SelectionHandler(context), name_(std::move(name)), node_(node), display_(display) {}

    void getAABBs(const rviz::Picked&, rviz::V_AABB& boxes) override {
      boxes.push_back(node_->_getWorldAABB());
    }

    void createProperties(const rviz::Picked&, rviz::Property* parent) override {
      auto* group = new rviz::Property("Object " + QString::fromStdString(name_), QVariant(), "", parent);
      properties_.push_back(group);
      held_ = new rviz::BoolProperty("Held", false, "A hand grasps it", group);
      touched_ =
          new rviz::StringProperty("Touched by", "", "Fingers that touch it, and with what force", group);
      mass_ = new rviz::FloatProperty("Mass [kg]", 0.0f, "", group);
      position_ =
          new rviz::VectorProperty("Position [m]", Ogre::Vector3::ZERO, "Of the centre of mass", group);
      orientation_ = new rviz::QuaternionProperty("Orientation", Ogre::Quaternion::IDENTITY, "", group);
      velocity_ = new rviz::VectorProperty("Velocity [m/s]", Ogre::Vector3::ZERO, "", group);
      spin_ = new rviz::VectorProperty("Angular velocity [rad/s]", Ogre::Vector3::ZERO, "", group);
      for (int i = 0; i < group->numChildren(); ++i) group->childAt(i)->setReadOnly(true);
      group->expand();
      updateProperties();
    }

    void destroyProperties(const rviz::Picked& picked, rviz::Property* parent) override {
      rviz::SelectionHandler::destroyProperties(picked, parent);
      held_ = nullptr;
    }

    void updateProperties() override {
      const auto found = display_.objects_.find(name_);
      if (!held_ || found == display_.objects_.end()) return;
      const ObjectState& object = found->second;
      held_->setBool(object.held != 0);
      touched_->setStdString(display_.touching(name_));
      mass_->setFloat(static_cast<float>(object.mass));
      position_->setVector(to_ogre(object.pose.position));
      orientation_->setQuaternion(to_ogre(object.pose.orientation));
      velocity_->setVector(to_ogre(object.twist.linear));
      spin_->setVector(to_ogre(object.twist.angular));
    }

   private:
    const std::string name_;
    const Ogre::SceneNode* const node_;
    InteractionDisplay& display_;
    rviz::BoolProperty* held_ = nullptr;
    rviz::StringProperty* touched_ = nullptr;
    rviz::FloatProperty* mass_ = nullptr;
    rviz::VectorProperty *position_ = nullptr, *velocity_ = nullptr, *spin_ = nullptr;
    rviz::QuaternionProperty* orientation_ = nullptr;
  };
  rviz::BoolProperty* add_layer(const char* name, const char* title, bool shown, const char* description) {
    return layers_[name] = new rviz::BoolProperty(title, shown, description, this);
  }

  void add_colour(rviz::Property* layer, const char* title, std_msgs::ColorRGBA PictureStyle::*colour) {
    const auto* property = new rviz::ColorProperty(title, to_qt(PictureStyle().*colour), "", layer);
    readers_.push_back([property, colour](PictureStyle& style) {
      const Rgb rgb = to_rgb(*property);
      (style.*colour).r = rgb[0], (style.*colour).g = rgb[1], (style.*colour).b = rgb[2];
    });
  }

  void add_number(rviz::Property* layer, const char* title, double PictureStyle::*number,
                  const char* description) {
    auto* property = new rviz::FloatProperty(title, PictureStyle().*number, description, layer);
    property->setMin(0.0f);
    readers_.push_back([property, number](PictureStyle& style) { style.*number = property->getFloat(); });
  }

  void add_properties() {
    namespace_ = new rviz::StringProperty("Namespace", "", "In which scene and rendered_view are", this);
    unreliable_ = new rviz::BoolProperty("Unreliable", false,
                                         "Ask for UDP: on a slow network, late poses are dropped", this);
    auto* hand = add_layer("hand", "Hand", true, "The rendered hand: never inside an object");
    skin_ = new rviz::ColorProperty("Skin", to_qt(kSkin), "", hand);
    touching_ = new rviz::ColorProperty("Touching", to_qt(tone_.touching), "Where it is in contact", hand);
    auto* ghost =
        add_layer("ghost", "Ghost", true, "The tracked hand, where it differs from the rendered one");
    add_colour(ghost, "Color", &PictureStyle::ghost);
    add_number(ghost, "From [m]", &PictureStyle::ghost_from,
               "Invisible where it is nearer to the rendered hand");
    auto* alpha = new rviz::FloatProperty("Alpha", PictureStyle().ghost.a, "Maximum opacity", ghost);
    alpha->setMin(0.0f);
    alpha->setMax(1.0f);
    readers_.push_back([alpha](PictureStyle& style) {
      style.ghost.a = alpha->getFloat();
      style.ghost_full = style.ghost_from + PictureStyle().ghost_full - PictureStyle().ghost_from;
    });
    add_layer("objects", "Objects", true, "Free and jointed bodies");
    add_layer("fixtures", "Fixtures", true, "Immovable bodies");
    auto* contacts = add_layer("contacts", "Contacts", true, "A dot at each contact");
    add_colour(contacts, "Color", &PictureStyle::contacts);
    auto* friction = add_layer("friction", "Friction", true, "A ring around each contact");
    add_colour(friction, "Sticks", &PictureStyle::sticks);
    add_colour(friction, "Slips", &PictureStyle::slips);
    auto* forces = add_layer("forces", "Forces", true, "An arrow behind each loaded finger");
    add_colour(forces, "Color", &PictureStyle::forces);
    add_colour(forces, "Assist", &PictureStyle::assist);
    add_number(forces, "Least [N]", &PictureStyle::least_force, "Smaller forces have no arrow and no number");
    add_layer("newtons", "Newtons", false, "The forces as numbers");
    add_layer("share", "Share", false, "Friction utilisation: blue none, orange full");
    auto* impacts =
        add_layer("impacts", "Impacts", true, "A ring at each impact of a hand, which fades within 0.15 s");
    add_colour(impacts, "Color", &PictureStyle::impacts);
    add_number(impacts, "Least [N s]", &PictureStyle::least_impulse, "Smaller impacts have no ring");
    add_layer("shadows", "Shadows", true, "Vertically below hands and objects");
    add_layer("text", "Text", true, "Held objects, contact model and gravity");
    add_layer("capsules", "Capsules", false, "The rendered hand as simulated");
  }

  void subscribe() {
    unsubscribe();
    subscribed_namespace_ = namespace_->getStdString();
    subscribed_unreliable_ = unreliable_->getBool();
    listen<SceneDescription>("scene", [this](const SceneDescription& message) {
      view_.take(message);
      scene_->clear();
      objects_.clear();
      markers_ = std::make_unique<Markers>(view_.scene(), caption(view_.model(), view_.scene().gravity));
      setStatusStd(rviz::StatusProperty::Ok, "Scene", message.name);
    });
    listen<RenderedView>("rendered_view", [this](const RenderedView& message) {
      view_.take(message);
      stamp_ = message.header.stamp;
      hands_time_ = ros::SteadyTime::now();
      for (const ObjectState& object : message.objects) objects_[object.name] = object;
      if (markers_) markers_->note(view_.result(), stamp_);
    });
  }

  void unsubscribe() { subscribers_.clear(); }

  template <typename Message, typename Take>
  void listen(const std::string& topic, Take take) {
    const std::string name = ros::names::append(subscribed_namespace_, topic);
    const auto handler = [this, topic, take](const boost::shared_ptr<const Message>& message) {
      try {
        take(*message);
        frame_ = message->header.frame_id;
        changed_ = true;
      } catch (const std::exception& error) {
        setStatus(rviz::StatusProperty::Error, QString::fromStdString(topic), error.what());
      }
    };
    ros::TransportHints hints;
    if (subscribed_unreliable_) hints.unreliable();
    hints.reliable().tcpNoDelay();
    subscribers_.push_back(update_nh_.subscribe<Message>(
        name, kQueue, boost::function<void(const boost::shared_ptr<const Message>&)>(handler), nullptr,
        hints));
  }

  void read_properties() {
    if (subscribed_namespace_ != namespace_->getStdString() ||
        subscribed_unreliable_ != unreliable_->getBool())
      reset();
    show_layers();
    tone_ = {to_rgb(*skin_) / kSkin, to_rgb(*touching_)};
    if (!markers_) return;
    markers_->style().skins = false;
    for (const auto& read : readers_) read(markers_->style());
  }

  void show_layers() {
    for (const auto& [name, shown] : layers_) scene_->show_layer(name, shown->getBool());
  }

  bool place_in_fixed_frame() {
    Ogre::Vector3 position;
    Ogre::Quaternion orientation;
    if (!context_->getFrameManager()->getTransform(frame_, ros::Time(), position, orientation)) {
      setStatusStd(
          rviz::StatusProperty::Error, "Transform",
          "no transform from '" + frame_ + "' to the fixed frame '" + fixed_frame_.toStdString() + "'");
      return false;
    }
    setStatus(rviz::StatusProperty::Ok, "Transform", "OK");
    scene_node_->setPosition(position);
    scene_node_->setOrientation(orientation);
    return true;
  }

  const Ogre::Camera& camera() const { return *context_->getViewManager()->getCurrent()->getCamera(); }

  Vector3 eye() const {
    const Ogre::Vector3 place = scene_node_->convertWorldToLocalPosition(camera().getDerivedPosition());
    return Vector3(place.x, place.y, place.z);
  }

  void draw() {
    drawn_eye_ = eye();
    const FrameResult& result = view_.result();
    if (markers_) {
      std_msgs::Header header;
      header.frame_id = fixed_frame_.toStdString();  // scene_node_ is at the pose of frame_ in it
      header.stamp = stamp_;
      markers_->update(result, view_.state(), header, array_);
      scene_->take(array_);
      show_layers();
      for (const std::string& mesh : scene_->missing())
        setStatusStd(rviz::StatusProperty::Warn, "Mesh", "'" + mesh + "' cannot be loaded on this machine");
    }
    draw_hands(result);
  }

  void draw_hands(const FrameResult& result) {
    const std::size_t hands = result.rendered.size();
    const PictureStyle style = markers_ ? markers_->style() : PictureStyle();
    for (std::size_t i = 0; i < std::max(hands, skins_.size()); ++i) {
      if (i == skins_.size()) {
        skins_.push_back(std::make_unique<SkinObject>(scene_manager_, scene_node_));
        ghosts_.push_back(std::make_unique<SkinObject>(scene_manager_, scene_node_));
      }
      skins_[i]->hide();
      ghosts_[i]->hide();
      if (i >= hands) continue;
      const RenderedHand& rendered = result.rendered[i];
      if (layers_["hand"]->getBool())
        skins_[i]->draw(rendered, result, view_.state(), tone_, layers_["capsules"]->getBool(), drawn_eye_);
      if (layers_["ghost"]->getBool())
        ghosts_[i]->draw_ghost(rendered.hand, result.tracked[i], style, drawn_eye_);
    }
  }

  /// Fingers that touch an object, with their forces.
  std::string touching(const std::string& object) {
    std::vector<std::string> fingers;
    for (const Contact& contact : view_.result().contacts) {
      if (contact.touching() && view_.scene().bodies[contact.key.body].name == object)
        fingers.push_back(finger_name(contact.key.capsule) + text::format(" %.1f N", contact.force.norm()));
    }
    return text::joined(fingers);
  }

  std::map<std::string, rviz::BoolProperty*> layers_;              ///< the switch of each
  std::vector<std::function<void(PictureStyle& style)>> readers_;  ///< of properties of the style
  rviz::StringProperty* namespace_;
  rviz::BoolProperty* unreliable_;
  rviz::ColorProperty *skin_, *touching_;

  std::string subscribed_namespace_;
  bool subscribed_unreliable_ = false;
  std::vector<ros::Subscriber> subscribers_;
  std::string frame_;
  ros::Time stamp_;             ///< of the last frame
  ros::SteadyTime hands_time_;  ///< time of the last hands
  std::map<std::string, mr_hand_interaction::ObjectState> objects_;
  SceneView view_;
  std::unique_ptr<Markers> markers_;
  std::unique_ptr<MarkerScene> scene_;
  std::vector<std::unique_ptr<SkinObject>> skins_, ghosts_;
  SkinTone tone_;
  visualization_msgs::MarkerArray array_;
  Vector3 drawn_eye_ = Vector3::Zero();  ///< position of the camera
  bool changed_ = false;
};

}  // namespace mrhi

PLUGINLIB_EXPORT_CLASS(mrhi::InteractionDisplay, rviz::Display)
