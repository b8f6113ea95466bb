#include "node.h"

#include <ros/init.h>

#include <csignal>

namespace mrhi {

void end_in_order() {
  struct sigaction action {};
  action.sa_handler = [](int) { ros::requestShutdown(); };  // sets a flag
  for (const int signal : {SIGTERM, SIGHUP, SIGQUIT}) sigaction(signal, &action, nullptr);
}

}  // namespace mrhi
