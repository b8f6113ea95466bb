#include <iostream>

#include "../replay/run_script.h"
#include "../text/text.h"
#include "exit_status.h"
#include "mr_hand_interaction/replay/replay.h"

namespace {

/// What is made of the tables. The first exit status that is not 0.
int report(const mrhi::ReplayArguments& arguments) {
  int status = 0;
  if (arguments.export_rate) {
    const std::string rate = mrhi::text::number(*arguments.export_rate);
    status = mrhi::run_script("export", {arguments.output, "--rate", rate});
  }
  if (status == 0 && arguments.explain)
    status = mrhi::run_script("explain", {arguments.output, "--no-pictures"});
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  return mrhi::exit_status("replay", [&] {
    const mrhi::ReplayArguments arguments = mrhi::parse_replay_arguments({argv + 1, argv + argc});
    if (arguments.help) {
      std::cout << mrhi::replay_help();
      return 0;
    }
    if (!arguments.compare.empty()) return mrhi::run_script("compare", arguments.compare);
    mrhi::replay(arguments);
    return report(arguments);
  });
}
