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

/// Options for reading hands from a recording.
struct HandOptions {
  std::map<std::string, std::string> topics;  ///< topics of a bag, and the standard topic that each replaces
  std::string order;                          ///< of joints; empty: detected
  double scale = 1.0;                         ///< metres per unit of length of the recording
};

/// Command line of `replay`.
struct ReplayArguments {
  bool help = false;
  std::vector<std::string> compare;     ///< arguments of scripts/compare, which is run instead of a replay
  std::optional<double> export_rate;    ///< rate for scripts/export, which is run afterwards [Hz]
  bool explain = false;                 ///< run scripts/explain afterwards
  std::optional<double> marker_rate;    ///< of the markers in markers.bag [Hz]; it then has poses too
  std::set<std::size_t> marker_frames;  ///< indices of the frames in markers.bag, instead of a rate
  std::string film;                     ///< video file that scripts/film.py makes from markers.bag afterwards
  bool serve = false;                   ///< web.launch shows markers.bag in browsers afterwards
  std::vector<std::string> repeatable;  ///< arguments that repeat this run in any folder
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

/// Parses the arguments after the program's name. Throws UsageError. Names need not exist.
ReplayArguments parse_replay_arguments(const std::vector<std::string>& arguments);

/// Text of --help.
const char* replay_help();

/// Loads scene and parameters, and places the objects. Throws UsageError for an invalid name or value on the
/// command line, SceneError and ParameterError for files.
Simulation prepare_simulation(const ReplayArguments& arguments);

/// Runs the program. Throws UsageError, or std::exception with one line for bad data. Written files stay.
void replay(const ReplayArguments& arguments);

}  // namespace mrhi
