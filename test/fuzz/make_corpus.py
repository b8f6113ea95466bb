#!/usr/bin/env python3
"""Writes the corpora that scripts/fuzz begins with; findings are added to them by hand, under names of their own."""
import io
import os
import random
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "ros"))
import leap_messages  # noqa: E402

PART = "\n%%\n"
INERTIAL = ('<inertial><mass value="0.1"/><inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/>'
            '</inertial>')
TETRAHEDRON = [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


def write(target, name, content):
    folder = os.path.join(HERE, "corpus", target)
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, name), "wb") as file:
        file.write(content.encode() if isinstance(content, str) else content)


def leap():
    for number, version in enumerate(leap_messages.MD5):
        message = io.BytesIO()
        leap_messages.human(leap_messages.classes(version), 1.5, ("right", "left")).serialize(message)
        write("leap", version, bytes([number]) + message.getvalue())


def csv():
    fingers = ["thumb", "index", "middle", "ring", "pinky"]
    names = ["time_s", "frame_id", "hand_id", "is_left", "confidence"]
    names += ["palm_" + axis for axis in "xyz"] + ["wrist_" + axis for axis in "xyz"] + ["palm_width"]
    _, _, chains = leap_messages.open_hand("right")
    palm, wrist, _ = leap_messages.open_hand("right")
    row = list(palm) + list(wrist) + [0.084]
    for finger, chain in zip(fingers, chains):
        names += ["%s_j%d_%s" % (finger, joint, axis) for joint in range(5) for axis in "xyz"] + [finger + "_width"]
        row += [x for joint in chain for x in joint] + [0.018]
    cells = ",".join("%.4f" % x for x in row)
    lines = [",".join(names)] + ["%.3f,%d,7,0,1,%s" % (0.01 * i, i, cells) for i in range(2)]
    write("csv", "two_frames", "\n".join(lines + ["0.02,2,-1,0,1" + "," * len(row)]) + "\n")
    write("csv", "few_columns", "time_s,hand_id,is_left,palm_x,palm_y,palm_z\n0,1,1,,,\n1e9,2,0,0,nan,-inf\n")


def link(name, geometry, joint="floating", origin="0 0 0.2", parent="world", more=""):
    shape = "<geometry>%s</geometry>" % geometry
    return ('<link name="{0}">{1}<visual>{2}</visual><collision>{2}</collision></link><joint name="j_{0}" '
            'type="{3}"><parent link="{5}"/><child link="{0}"/><origin xyz="{4}" rpy="0 0.1 0"/>{6}</joint>'
            ).format(name, INERTIAL, shape, joint, origin, parent, more)


def scenes():
    bodies = (link("cube", '<box size="0.05 0.05 0.05"/>') + link("can", '<cylinder radius="0.02" length="0.1"/>',
              origin="0.1 0 0.2") + link("ball", '<sphere radius="0.03"/>', "fixed", "0.3 0 0.2"))
    settings = ("gravity: [0.0, 0.0, -9.81]\nbounds: {min: [-1.5, -1.5, -1.0], max: [1.5, 1.5, 2.0]}\n"
                "materials:\n  ball: {restitution: 0.6, static_friction: 0.6, dynamic_friction: 0.5, stiffness: 900}\n")
    parameters = "step: 0.002\nfilter: {type: one_euro, min_cutoff: 2}\ncontact_model: implicit\ngravity: [0, 0, 1]\n"
    write("scene", "three_bodies", PART.join(['<robot name="r"><link name="world"/>%s</robot>' % bodies, settings,
                                              parameters]))
    limits = '<axis xyz="0 1 0"/><limit lower="-1" upper="0.5" effort="1" velocity="1"/>'
    joints = (link("door", '<box size="0.2 0.01 0.3"/>', "revolute", more=limits + '<dynamics damping="0.1"/>') +
              link("knob", '<sphere radius="0.02"/>', "continuous", "0.09 -0.04 0", "door", '<axis xyz="0 1 0"/>') +
              link("drawer", '<box size="0.1 0.1 0.05"/>', "prismatic", "0.5 0 0.2", more=limits))
    of_joints = ("joints:\n  j_door: {start: 0.1, friction: 0.02, restitution: 0.3, latch: {at: 0.0, force: 2, reach: "
                 "0.02}}\n  j_knob: {detents: {at: [-1, 0, 0.5], force: 0.1}}\n"
                 "  j_drawer: {damping: 2, spring: {stiffness: 100, rest: -0.1}}\n")
    write("scene", "joints", PART.join(['<robot name="r"><link name="world"/>%s</robot>' % joints, of_joints]))
    write("scene", "mesh", '<robot name="r"><link name="world"/>%s</robot>' % link(
        "m", '<mesh filename="package://a/b.stl" scale="1 1 -1"/>'))
    write("scene", "parameters", PART.join(["<robot/>", "[]", "hand/strength: unlimited\nfilter/window: 3\n"
                                            "material/stiffness: model\ncontact/sleep: false\n"]))


def tasks():
    task = ("name: t\ngravity: [0, 0, 0]\nrepetitions: 2\norder: as_listed\nobjects:\n"
            "  - {name: a, file: a.urdf, position: [0, 0, 0], orientation: [0, 0, 90], twist: [0, 1, 0, 0, 0, 0]}\n"
            "  - {name: b, position: [0, 0, 1]}\nfixtures:\n  - {name: f, file: f.urdf, position: [1, 0, 0]}\ngoals:\n"
            "  - pick: {distance: 0.05}\n  - place: {position: [0, 0, 1], tolerance: 0.01, hold: 1, leaving: stop}\n"
            "  - release: {drift_time: 2.0}\n")
    header = ('version: 1\nparticipant: "P01"\ngroup: beginner\nhandedness: right\ncondition: "hands"\n'
              'gravity: [0, 0, 0]\nseed: 1\ntask: "t"\nsimulated: false\nstarted: ""\norder: [a, b]\nsoftware: ""\n')
    columns = ("trial,object,condition,repetition,result,start,completion_time,manipulation_time,maintenance_time,"
               "release_time,attempts,drops,path_length,grip_force_mean,grip_force_max,release_drift,release_speed,"
               "tracking_losses\n")
    trials = columns + "1,a,hands,1,completed,0.5,1,1,1,1,1,0,0.1,1,2,0,0,0\n2,b,hands,1,aborted,3,,,,,1,0,,,,,,0\n"
    events = "time,trial,stage,event,object,detail\n0.0,,manipulation,session_begun,,\n3.5,2,release,dropped,b,\n"
    write("task", "session", PART.join([task, header, trials, events]))
    write("task", "cut_off", PART.join([task, header, trials[:-30], events[:-12]]))
    setup = "contact_model: implicit\nstep: 0.001\n"
    write("task", "setup", PART.join([task, header, trials, events, setup]))
    write("task", "other_setup", PART.join([task, header, trials, events, setup.replace("0.001", "0.002")]))
    write("task", "strike", "name: s\nobjects: [{name: a, position: [0, 0, 0]}]\ngoals:\n  - tap: {speed: [0.1, 1]}\n"
          "  - nudge_into: {position: [0, 0, 1], size: [1, 1, 1], max_speed: 0.1}\n")


def meshes():
    vertices, triangles = TETRAHEDRON
    text = "".join("v %g %g %g\n" % v for v in vertices)
    text += "".join("f %d %d %d\n" % tuple(i + 1 for i in t) for t in triangles)
    write("mesh", "tetrahedron.obj", b"\1" + text.encode())
    stl = "solid t\n" + "".join(
        "facet normal 0 0 0\nouter loop\n%sendloop\nendfacet\n" %
        "".join("vertex %g %g %g\n" % vertices[i] for i in t) for t in triangles) + "endsolid\n"
    write("mesh", "tetrahedron.stl", b"\0" + stl.encode())
    places = bytes([0] * 3 + [255, 0, 0] + [0, 255, 0] + [0, 0, 255])
    write("mesh", "tetrahedron", b"\3\0" + places + bytes(i for t in triangles for i in t))
    cube = bytes(200 * (i >> axis & 1) + 20 for i in range(8) for axis in range(3))
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    halves = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    write("mesh", "cube", b"\3\4" + cube + bytes(i for t in halves for i in t))


def logs():
    bodies = link("cube", '<box size="0.05 0.05 0.05"/>') + link("can", '<cylinder radius="0.02" length="0.1"/>',
                                                                 origin="0.1 0 0.2")
    urdf = '<robot name="r"><link name="world"/>%s</robot>' % bodies
    world = ("version: 1.0.0\nscene: two\nobject_twist: {cube: [0.1, 0, 0, 0, 0, 1]}\n"
             "parameters: {step: 0.002, contact_model: implicit}\nremoved: [can]\nadded:\n"
             "  - {name: ball, shape: sphere, size: [0.03], mass: 0.1, pose: [0.3, 0, 0.2, 0, 0, 0, 1], "
             "twist: [0, 0, 0, 0, 0, 0], material: '{stiffness: 500}', rgba: [1, 0, 0, 1]}\n")
    box = '<robot name="b"><link name="world"/>%s</robot>' % link("box", '<box size="0.1 0.1 0.1"/>')
    changes = {"spawn": "spawn: {name: box, urdf: spawn/box.urdf, pose: [0, 0.5, 0.5, 0, 0, 0, 1], "
                        "twist: [0, 0, 0, 0, 0, 0]}\n",
               "delete": "delete: cube\n", "reset": "reset: all\n", "pause": "pause: on\n",
               "set": "set: [[filter/type, window], [hand/strength, unlimited]]\n",
               "place": "place: ball\npose: [0.1, 0.2, 0.3, 0, 0, 0, 1]\n"}
    for name, change in changes.items():
        write("log", name, PART.join([world, urdf, "gravity: [0, 0, -9.81]\n", change, box]))


def states():
    for seed in range(4):
        write("state", "whole_%d" % seed, bytes([seed]))
        stream = random.Random(seed)
        write("state", "random_%d" % seed, bytes([seed]) + bytes(stream.randrange(256) for _ in range(40)))


def steps():
    for seed in range(10):
        stream = random.Random(seed)
        write("step", "random_%d" % seed, bytes(stream.randrange(256) for _ in range(400)))
        # by the last byte (StepKind): meshes, some inside each other
        if seed < 4:
            write("step", "overlapping_%d" % seed, bytes(stream.randrange(256) for _ in range(400)) + bytes([31]))
            for kind, last in ("rods", 64), ("flush", 96), ("flush_meshes", 120):
                write("step", "%s_%d" % (kind, seed), bytes(stream.randrange(256) for _ in range(400)) + bytes([last]))


if __name__ == "__main__":
    for make in (leap, csv, scenes, tasks, logs, states, meshes, steps):
        make()
