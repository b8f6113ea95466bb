// A recording in CSV.
#include "fuzz/target.h"
#include "mr_hand_interaction/replay/recording_csv.h"

FUZZ_TARGET(csv) {
  using namespace mrhi;
  const std::string file =
      fuzzing::folder().write("recording.csv", std::string(reinterpret_cast<const char*>(data), size));
  try {
    for (const JointsFrame& frame : read_recording_csv(file)) {
      std::vector<std::string> defects;
      complete_frame(frame, Pose(), defects);
      for (const std::string& defect : defects) fuzzing::require_one_line(defect);
    }
  } catch (const RecordingError& error) {
    fuzzing::require_one_line(error.what());
  }
}
