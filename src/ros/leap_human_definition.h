#pragma once

namespace mrhi {

/// Fields of leap_motion/Human at the head of the ros-drivers package (2020).
constexpr const char* kLeapHumanDefinition = R"(std_msgs/Header header
int32 lmc_frame_id
int32 nr_of_hands
int32 nr_of_fingers
int32 nr_of_gestures
float32 current_frames_per_second
string to_string
Hand right_hand
Hand left_hand

================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id

================================================================================
MSG: leap_motion/Hand
std_msgs/Header header
int32 lmc_hand_id
bool is_present
bool valid_gestures
float32 time_visible
float32 confidence
float32 roll
float32 pitch
float32 yaw
geometry_msgs/Vector3 direction
geometry_msgs/Vector3 normal
float32 grab_strength
float32 pinch_strength
float32[] palm_velocity
geometry_msgs/Point palm_center
float32 palm_width
float32 sphere_radius
float32[] sphere_center
string to_string
Finger[] finger_list
Gesture[] gesture_list
Arm arm

================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z

================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z

================================================================================
MSG: leap_motion/Finger
std_msgs/Header header
int32 lmc_finger_id
uint8 type
float32 length
float32 width
string to_string
Bone[] bone_list

================================================================================
MSG: leap_motion/Bone
std_msgs/Header header
uint8 type
float32 length
float32 width
string to_string
geometry_msgs/Pose bone_start
geometry_msgs/Pose bone_end
float32[] center

================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation

================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w

================================================================================
MSG: leap_motion/Gesture
int32 lmc_gesture_id
bool is_valid
int64 duration_us
float32 duration_s
int32 gesture_state
int32 gesture_type
string to_string
int32[] pointable_ids

================================================================================
MSG: leap_motion/Arm
std_msgs/Header header
geometry_msgs/Pose elbow
geometry_msgs/Pose wrist
float32[] center
geometry_msgs/Vector3 direction
)";

}  // namespace mrhi
