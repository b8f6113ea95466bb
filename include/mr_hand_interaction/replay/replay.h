#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "mr_hand_interaction/input_error.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// How the hands of a tracker are read from a recording.
struct HandOptions {
  std::map<std::string, std::string> topics;  ///< of a bag, and the usual topic for which each stands
  std::string order;                          ///< of joints; empty: recognised
  double scale = 1.0;                         ///< metres per unit of the recording's lengths
};

/// The command line of `replay`.
struct ReplayArguments {
  bool help = false;
  std::vector<std::string> compare;     ///< what scripts/compare is called with; nothing is played then
  std::optional<double> export_rate;    ///< scripts/export is called with it afterwards [Hz]
  bool explain = false;                 ///< scripts/explain is called afterwards
  std::optional<double> marker_rate;    ///< of the markers in markers.bag [Hz], which has poses too
  std::set<std::size_t> marker_frames;  ///< numbers of the frames in markers.bag, instead
  std::string film;                     ///< scripts/film.py draws markers.bag into this file afterwards
  bool serve = false;                   ///< web.launch shows markers.bag in browsers afterwards
  std::vector<std::string> repeatable;  ///< the words that make the same run again, in whatever folder
  std::string scene;                    ///< name or URDF file
  std::string input;                    ///< .bag or .csv
  std::string output;                   ///< folder
  std::optional<std::string> topic;
  std::optional<std::string> parameter_file;
  std::vector<std::pair<std::string, std::string>> settings;  ///< name, YAML value
  std::vector<std::pair<std::string, Pose>> object_poses;     ///< of the centre of mass, in world
  std::vector<std::pair<std::string, Twist>> object_twists;   ///< world axes
  std::optional<Pose> hand_transform;                         ///< of the device frame in world
  HandOptions hands;
};

/// Arguments without the program's name. Throws UsageError. Whether scene, objects and parameters exist is
/// not checked here.
ReplayArguments parse_replay_arguments(const std::vector<std::string>& arguments);

/// What --help says.
const char* replay_help();

/// Scene and parameters as the arguments say, objects placed. Throws UsageError for a name or value on the
/// command line that is not allowed, SceneError and ParameterError for files.
Simulation prepare_simulation(const ReplayArguments& arguments);

/// The whole program after its arguments are known. Throws UsageError, else std::exception with one line for
/// bad data; what had been written stays.
void replay(const ReplayArguments& arguments);

}  // namespace mrhi
