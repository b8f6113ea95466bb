"""A hand whose only phalanx is the index finger's distal one, and how it pushes the cube of scene `cube`."""
from mr_hand_interaction.msg import Hand, HandFrame, Phalanx

SPEED = 0.2  # m/s of the finger that pushes
PERIOD = 0.01  # s between frames
FACE = -0.025  # x of the face that is pushed [m]
RADIUS = 0.009  # of the fingertip [m]
HEIGHT = 0.22  # of the cube's centre [m]


def hand(tip, hand_id=7, way=1.0):
    """Pointing along +x, or with way = -1 along -x, with its end at x = tip."""
    message = Hand(id=hand_id, side=Hand.RIGHT, confidence=1.0, palm_width=0.06)
    message.palm.position.x, message.palm.position.z = tip - way * 0.15, HEIGHT
    message.palm.orientation.w, message.palm.orientation.z = (1.0, 0.0) if way > 0.0 else (0.0, 1.0)
    message.wrist.x, message.wrist.z = tip - way * 0.2, HEIGHT
    phalanx = Phalanx(finger=Phalanx.INDEX, bone=Phalanx.DISTAL, radius=RADIUS)
    phalanx.start.x, phalanx.end.x = tip - way * (RADIUS + 0.03), tip - way * RADIUS
    phalanx.start.z = phalanx.end.z = HEIGHT
    message.phalanges = [phalanx]
    return message


def frame(stamp, *hands, frame_id="world"):
    message = HandFrame(hands=list(hands))
    message.header.stamp, message.header.frame_id = stamp, frame_id
    return message


def push_tips(begin=-0.10, end=0.02):
    """Where the tip is, frame by frame."""
    frames = int(round((end - begin) / (SPEED * PERIOD)))
    return [begin + i * SPEED * PERIOD for i in range(frames + 1)]
