// Bodies put where recorded hands close: how many are held until the hand opens? See docs/real_grasps.md.

#include <iostream>

#include "run.h"

int main(int argc, char** argv) {
  using namespace mrhi::real_grasps;
  try {
    const Arguments arguments = parse_arguments({argv + 1, argv + argc});
    if (arguments.help) {
      std::cout << help_text();
    } else {
      run(arguments);
    }
  } catch (const UsageError& error) {
    std::cerr << "real_grasps: " << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "real_grasps: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
