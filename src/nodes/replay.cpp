#include <iostream>

#include "exit_status.h"
#include "mr_hand_interaction/replay/compare.h"
#include "mr_hand_interaction/replay/replay.h"

int main(int argc, char** argv) {
  return mrhi::exit_status("replay", [&] {
    const mrhi::ReplayArguments arguments = mrhi::parse_replay_arguments({argv + 1, argv + argc});
    if (arguments.help) {
      std::cout << mrhi::replay_help();
    } else if (arguments.compare) {
      const mrhi::Comparison comparison =
          mrhi::compare_runs(arguments.compare->first, arguments.compare->second, arguments.tolerance);
      std::cout << mrhi::to_text(comparison) << std::flush;
      return comparison.partings.empty() ? 0 : 1;
    } else {
      mrhi::replay(arguments);
    }
    return 0;
  });
}
