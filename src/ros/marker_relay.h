#pragma once

#include <ros/ros.h>
#include <visualization_msgs/MarkerArray.h>

#include <map>
#include <set>
#include <string>
#include <utility>

namespace mrhi {

/// Thins a stream of marker arrays out: what is left is the newest of each marker, and no deletion is lost.
class MarkerThinner {
 public:
  /// `left_out`: namespaces that are not passed on.
  explicit MarkerThinner(std::set<std::string> left_out) : left_out_(std::move(left_out)) {}

  void take(const visualization_msgs::MarkerArray::ConstPtr& array);
  /// The next array has everything and deletes the rest, whatever was lost on the way.
  void start_afresh() { afresh_ = true; }
  /// What has come since the last call, as one array; without markers if nothing has.
  visualization_msgs::MarkerArray next();

 private:
  using Key = std::pair<std::string, int>;
  void add_change(const Key& key, visualization_msgs::MarkerArray& array) const;

  std::set<std::string> left_out_;
  std::map<Key, visualization_msgs::Marker> shown_;  // all that has not been deleted
  std::set<Key> changed_;                            // since the last call of next()
  std_msgs::Header header_;
  bool came_ = false, afresh_ = true;
};

/// `markers` for a viewer on another machine, on `view/markers`: ~rate (30) [Hz] of them, without the
/// namespaces ~leave_out (none, separated by commas). Listens only while somebody views.
class MarkerRelay {
 public:
  /// Throws std::invalid_argument that names the parameter and what is allowed.
  MarkerRelay(ros::NodeHandle node, const ros::NodeHandle& parameters);

 private:
  void viewers_changed();
  void send();

  ros::NodeHandle node_;
  MarkerThinner thinner_;
  int sent_ = 0, afresh_after_;  ///< arrays
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
  ros::WallTimer timer_;
};

}  // namespace mrhi
