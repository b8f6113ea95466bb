#pragma once

#include <gtest/gtest.h>
#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <map>
#include <string>

#include "mr_hand_interaction/ros/markers.h"
#include "support/fixtures.h"
#include "tracking/adult_hand.h"

namespace mrhi {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

/// The markers of a cube and a fixed ball, with hands as they are asked for.
struct Shown {
  Shown()
      : scene(testing::scene_of(testing::box_body({0.05, 0.05, 0.05}, 0.1))), markers(scene, configuration) {
    scene.bodies.push_back(testing::ball_body(0.03, 0.1));
    scene.bodies.back().fixed = true;
    Visual visual;
    visual.shape = Mesh{nullptr, "package://some/mesh.stl", Vector3::Ones()};
    scene.bodies.back().visuals.push_back(visual);
    for (const Body& body : scene.bodies) state.bodies.push_back(start_state(body));
    state.hands.resize(kMaxHands);
  }

  void see_hands(int count, Side side = Side::right) {
    result.tracked.assign(static_cast<std::size_t>(count), complete_hand(adult_hand(side), Pose{}));
    result.rendered.clear();
    for (const Hand& hand : result.tracked) result.rendered.push_back({hand, {}});
  }

  std::map<std::string, int> update() {
    std_msgs::Header header;
    header.frame_id = "world";
    header.stamp = ros::Time(now += 0.04);
    markers.note(result, header.stamp);
    markers.update(result, state, header, array);
    std::map<std::string, int> added;
    for (const Marker& marker : array.markers) added[marker.ns] += marker.action == Marker::ADD;
    return added;
  }

  /// The first marker of a layer.
  const Marker& first(const std::string& layer) const {
    static const Marker none;
    for (const Marker& marker : array.markers) {
      if (marker.ns == layer && marker.action == Marker::ADD) return marker;
    }
    ADD_FAILURE() << "nothing in " << layer;
    return none;
  }

  long deleted(const std::string& layer) const {
    return std::count_if(array.markers.begin(), array.markers.end(), [&](const Marker& marker) {
      return marker.ns == layer && marker.action == Marker::DELETE;
    });
  }

  double now = 100.0;  // [s]
  Configuration configuration;
  Scene scene;
  SimulationState state;
  FrameResult result;
  Markers markers;
  MarkerArray array;
};

}  // namespace mrhi
