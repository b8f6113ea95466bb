#include <exception>
#include <iostream>

#include "mr_hand_interaction/replay/compare.h"
#include "mr_hand_interaction/replay/replay.h"

int main(int argc, char** argv) {
  try {
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
  } catch (const mrhi::UsageError& error) {
    std::cerr << "replay: " << error.what() << std::endl;
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "replay: " << error.what() << std::endl;
    return 1;
  }
  return 0;
}
