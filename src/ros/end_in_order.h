#pragma once

namespace mrhi {

/// SIGTERM, SIGHUP and SIGQUIT end ros::spin() as SIGINT does, so that what a node has begun is brought to
/// its end. Call after ros::init().
void end_in_order();

}  // namespace mrhi
