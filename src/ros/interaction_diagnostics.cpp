#include "interaction_diagnostics.h"

#include "update_diagnostics.h"

namespace mrhi {

InteractionDiagnostics::InteractionDiagnostics(ros::NodeHandle node, ros::NodeHandle parameters,
                                               const std::string& scene)
    : input_({}), updater_(node, parameters) {
  updater_.setHardwareID("scene " + scene);
  updater_.add("interaction", this, &InteractionDiagnostics::report);
  updater_.add("state", this, &InteractionDiagnostics::report_state);
  timer_ =
      node.createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { update(updater_); });
}

void InteractionDiagnostics::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  input_.report(status);
  status.add("frames dropped while paused", dropped_);
  status.add("steps in this period", step_times_.count());
  status.add("step time p50 [us]", step_times_.quantile_us(0.5));
  status.add("step time p99 [us]", step_times_.quantile_us(0.99));
  status.add("step time max [us]", step_times_.max_us());
  step_times_.clear();
  status.add("hand to markers p50 [ms]", 1e-3 * picture_latency_.quantile_us(0.5));
  status.add("hand to markers p99 [ms]", 1e-3 * picture_latency_.quantile_us(0.99));
  picture_latency_.clear();
}

/// Apart: all values of the other status are numbers, and a hash is none.
void InteractionDiagnostics::report_state(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, "as of the last input");
  if (teller_) teller_(status);
}

}  // namespace mrhi
