"""Writes a demonstration as a bag with only standard messages. Needs ROS's Python modules."""

import genpy
import rosbag
from geometry_msgs.msg import Point, Pose, PoseArray, PoseStamped, Quaternion, TransformStamped, Vector3, WrenchStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import Header, String
from tf2_msgs.msg import TFMessage

from .demonstration import joint_angles, keypoints


def write_bag(demonstration, path):
    with rosbag.Bag(path, 'w') as bag:
        for i, stamp in enumerate(demonstration.stamps):
            _write_frame(demonstration, i, int(stamp), bag)


def _write_frame(demonstration, i, stamp, bag):
    time = genpy.Time(*divmod(stamp, 1000000000))
    recorded = genpy.Time(*divmod(max(stamp, 1), 1000000000))  # a recording may begin at 0, which is not a valid time in a bag
    header, transforms = Header(stamp=time, frame_id='world'), []

    def write_pose(topic, name, pose):
        place, orientation = pose[:3], Quaternion(*pose[3:])
        message = PoseStamped(header=header)
        message.pose.position, message.pose.orientation = Point(*place), orientation
        bag.write(topic, message, recorded)
        transform = TransformStamped(header=header, child_frame_id=name)
        transform.transform.translation, transform.transform.rotation = Vector3(*place), orientation
        transforms.append(transform)

    for name, body in demonstration.objects.items():
        if not body.is_there()[i]:
            continue
        write_pose('/demonstration/%s/pose' % name, name, body.pose[i].tolist())
        wrench = WrenchStamped(header=header)
        wrench.wrench.force, wrench.wrench.torque = Vector3(*body.wrench[i, :3]), Vector3(*body.wrench[i, 3:])
        bag.write('/demonstration/%s/wrench' % name, wrench, recorded)
    for side, body in demonstration.hands.items():
        if not body.is_there()[i]:
            continue
        write_pose('/demonstration/%s_palm/pose' % side, side + '_palm', body.pose[i].tolist())
        points = keypoints(body.bones[i:i + 1])[0].tolist()
        bag.write('/demonstration/%s_hand/keypoints' % side, PoseArray(
            header=header, poses=[Pose(Point(*point), Quaternion(0.0, 0.0, 0.0, 1.0)) for point in points]), recorded)
        angles = joint_angles(body.bones[i])
        bag.write('/demonstration/%s_hand/joint_states' % side, JointState(
            header=header, name=['%s_%s' % (side, name) for name in angles], position=list(angles.values())), recorded)
    for event in demonstration.events[i]:
        bag.write('/events', String(data=event), recorded)
    bag.write('/tf', TFMessage(transforms=transforms), recorded)
