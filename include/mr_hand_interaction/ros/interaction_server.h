#pragma once

#include <mr_hand_interaction/DeleteObject.h>
#include <mr_hand_interaction/HandFrame.h>
#include <mr_hand_interaction/SaveWorld.h>
#include <mr_hand_interaction/SetParameter.h>
#include <mr_hand_interaction/SpawnObject.h>
#include <mr_hand_interaction/SpawnUrdf.h>
#include <ros/ros.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <functional>
#include <string>
#include <vector>

#include "mr_hand_interaction/live_simulation.h"
#include "mr_hand_interaction/ros/input_log.h"
#include "mr_hand_interaction/ros/interaction_diagnostics.h"
#include "mr_hand_interaction/ros/placing.h"
#include "mr_hand_interaction/ros/result_publisher.h"
#include "mr_hand_interaction/ros/sequence_watch.h"
#include "mr_hand_interaction/ros/server_parameters.h"
#include "mr_hand_interaction/ros/stamp_clock.h"
#include "mr_hand_interaction/ros/tuning.h"

namespace mrhi {

/// Feeds hand_frame to a simulation and publishes what comes of it; takes changes of its scene and parameters
/// between frames. Callbacks of its node handles must not run at the same time.
class InteractionServer {
 public:
  /// Throws SceneError for a scene that cannot be loaded.
  InteractionServer(ros::NodeHandle node, ros::NodeHandle private_node, const ServerParameters& parameters);

  /// Frames come from the topic hand_frame,
  void subscribe(ros::NodeHandle& node);
  /// or from the same process. `arrival`: of the message that they were in.
  void take(const mr_hand_interaction::HandFrame& message, const ros::Time& arrival);
  /// Frames that have not arrived, where who hands them on knows.
  void note_lost(std::uint64_t frames);

 private:
  void advertise_services(ros::NodeHandle& private_node);
  bool begin(const mr_hand_interaction::HandFrame& message);
  bool timed_step();
  void tell_state(diagnostic_updater::DiagnosticStatusWrapper& status) const;
  void idle();

  bool reset(std_srvs::Trigger::Response& response);
  bool pause(bool paused, std_srvs::SetBool::Response& response);
  bool spawn(const mr_hand_interaction::SpawnObject::Request& request,
             mr_hand_interaction::SpawnObject::Response& response);
  bool spawn_urdf(const mr_hand_interaction::SpawnUrdf::Request& request,
                  mr_hand_interaction::SpawnUrdf::Response& response);
  bool save(const std::string& file, mr_hand_interaction::SaveWorld::Response& response);
  bool remove(const std::string& name, mr_hand_interaction::DeleteObject::Response& response);
  bool set(const mr_hand_interaction::SetParameter::Request& request,
           mr_hand_interaction::SetParameter::Response& response);

  /// Every change of the simulation goes this way, and into the log.
  void make(const Change& change);
  void change_parameters(const Tuning::Values& values);
  /// There is another simulation, perhaps with other bodies.
  void show_change();
  void place_dragged();

  std::string fixed_frame_;
  LiveSimulation live_;
  StampClock clock_;
  InputLog log_;
  Nanoseconds frame_stamp_ = 0, frame_expected_ = 0;  ///< of the frame that has begun
  StampJudge arrivals_;                               ///< of all frames, those too that come while paused
  ResultPublisher results_;
  InteractionDiagnostics diagnostics_;
  Placing placing_;
  Tuning tuning_;

  SequenceWatch sequences_;
  ros::Subscriber hands_;
  std::vector<ros::ServiceServer> services_;
  ros::WallTimer idle_timer_;
};

}  // namespace mrhi
