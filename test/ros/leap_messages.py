#!/usr/bin/env python3
"""leap_motion/Human in its four published versions, built from text so that the package is not needed.

leap_messages.py VERSION STAMP: a driver of that version that publishes one frame of two hands, then waits for
the end of its standard input. VERSION "text" publishes a std_msgs/String in its place.
"""
import sys

import genpy
import genpy.dynamic

MD5 = {
    "head": "2817a017ab58b244566892058c4f6e6d",
    "2020-02": "3bd6af829f83963a7331d3ab3569550a",
    "2019-08": "ca08153c68f1f03536845a545510cf3e",
    "0.0.14": "3e3d8dfe1324daa216cc0e23d891da6e",
}

TYPES = {
    "std_msgs/Header": "uint32 seq\ntime stamp\nstring frame_id",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
    "geometry_msgs/Pose": "Point position\nQuaternion orientation",
    "leap_motion/Finger": "Header header\nint32 lmc_finger_id\nuint8 type\nfloat32 length\nfloat32 width\n"
                          "string to_string\nBone[] bone_list",
    "leap_motion/Bone": "Header header\nuint8 type\nfloat32 length\nfloat32 width\nstring to_string\n"
                        "geometry_msgs/Pose bone_start\ngeometry_msgs/Pose bone_end\nfloat32[] center",
    "leap_motion/Gesture": "int32 lmc_gesture_id\nbool is_valid\nint64 duration_us\nfloat32 duration_s\n"
                           "int32 gesture_state\nint32 gesture_type\nstring to_string\nint32[] pointable_ids",
}
HUMAN = ("Header header\nint32 lmc_frame_id\nint32 nr_of_hands\nint32 nr_of_fingers\nint32 nr_of_gestures\n"
         "float32 current_frames_per_second\nstring to_string\nHand right_hand\nHand left_hand")
ARM = ("Header header\ngeometry_msgs/Pose elbow\ngeometry_msgs/Pose wrist\nfloat32[] center\n"
       "geometry_msgs/Vector3 direction")


def hand_text(version):
    text = ("Header header\nint32 lmc_hand_id\nbool is_present\nbool valid_gestures\nfloat32 time_visible\n"
            "float32 confidence\nfloat32 roll\nfloat32 pitch\nfloat32 yaw\n")
    if version != "0.0.14":
        text += "geometry_msgs/Vector3 direction\ngeometry_msgs/Vector3 normal\n"
    text += ("float32 grab_strength\nfloat32 pinch_strength\nfloat32[] palm_velocity\n"
             "geometry_msgs/Point palm_center\nfloat32 palm_width\nfloat32 sphere_radius\n"
             "float32[] sphere_center\n")
    if version != "head":
        text += "float32[] wrist_position\n"
    if version == "2020-02":
        text += "float32[] elbow_position\n"
    text += "string to_string\nFinger[] finger_list\nGesture[] gesture_list\n"
    return text + ("Arm arm" if version == "head" else "")


def definition(version):
    types = dict(TYPES, **{"leap_motion/Hand": hand_text(version)})
    if version == "head":
        types["leap_motion/Arm"] = ARM
    blocks = [HUMAN] + ["MSG: %s\n%s" % item for item in types.items()]
    return ("\n" + "=" * 80 + "\n").join(blocks) + "\n"


def classes(version):
    """The version's message classes by full type name."""
    return genpy.dynamic.generate_dynamic("leap_motion/Human", definition(version))


def open_hand(side, offset=(0.0, 0.0, 0.0)):
    """Palm centre, wrist and five joint chains of a flat hand, palm down, in the device's frame (y up, z to the
    user)."""
    thumb_side = -1.0 if side == "right" else 1.0
    palm = (0.01 + offset[0], 0.2 + offset[1], 0.02 + offset[2])

    def place(forward, to_thumb, up):
        return (palm[0] + thumb_side * to_thumb, palm[1] + up, palm[2] - forward)

    chains = [[place(f, 0.02 + 0.5 * (f + 0.05), -0.006) for f in (-0.05, -0.05, -0.02, 0.005, 0.022)]]
    fingers = ((0.023, 0.023, (0.04, 0.022, 0.016)), (0.003, 0.0235, (0.045, 0.026, 0.017)),
               (-0.0175, 0.0175, (0.041, 0.026, 0.017)), (-0.0355, 0.0095, (0.033, 0.018, 0.016)))
    for across, knuckle, bones in fingers:
        forward, chain = knuckle, [place(-0.042, 0.5 * across, 0.01), place(knuckle, across, 0.003)]
        for bone in bones:
            forward += bone
            chain.append(place(forward, across, 0.003))
        chains.append(chain)
    return palm, place(-0.065, -0.006, 0.003), chains


def set_point(target, values):
    target.x, target.y, target.z = values


def fill_hand(types, hand, side, offset):
    palm, wrist, chains = open_hand(side, offset)
    hand.lmc_hand_id = 21 if side == "right" else 22
    hand.is_present = True
    hand.confidence, hand.palm_width = 0.75, 0.084
    set_point(hand.palm_center, palm)
    if hasattr(hand, "arm"):
        set_point(hand.arm.wrist.position, wrist)
    else:
        hand.wrist_position = wrist
    for finger_type, chain in enumerate(chains):
        finger = types["leap_motion/Finger"](type=finger_type, width=0.018)
        for bone_type in range(4):
            bone = types["leap_motion/Bone"](type=bone_type)
            set_point(bone.bone_start.position, chain[bone_type])
            set_point(bone.bone_end.position, chain[bone_type + 1])
            finger.bone_list.append(bone)
        hand.finger_list.append(finger)


def human(types, stamp, sides=("right",), frame_id="leap_hands", offset=(0.0, 0.0, 0.0)):
    message = types["leap_motion/Human"]()
    message.header.stamp = genpy.Time.from_sec(stamp)
    message.header.frame_id = frame_id
    for side in sides:
        fill_hand(types, message.right_hand if side == "right" else message.left_hand, side, offset)
    return message


def publish_once(version, stamp):
    import rospy
    from std_msgs.msg import String
    rospy.init_node("leap_driver", anonymous=True)
    message = String("not a hand") if version == "text" else human(classes(version), stamp, ("right", "left"))
    publisher = rospy.Publisher("/leap_motion/leap_device", type(message), queue_size=1, latch=True)
    publisher.publish(message)
    sys.stdin.read()


if __name__ == "__main__":
    publish_once(sys.argv[1], float(sys.argv[2]))
