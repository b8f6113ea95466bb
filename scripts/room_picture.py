#!/usr/bin/env python3
"""Draws a room as a camera would see it: a table with a grid of 5 cm on which the hand tracker stands, a floor and a wall.
world is in the middle of the table's top. mr_view.launch uses it without a camera. For tests, --mark paints the silhouette of
a box, and a square in each corner of the picture."""
import argparse
import os
import re
import sys

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from study import program  # noqa: E402

import matplotlib.image
import numpy

TABLE = (0.45, 0.30)  # half of its length and width [m]
FLOOR, WALL = -0.72, 0.90  # z and y [m]
DEVICE = ((-0.04, -0.015, 0.0), (0.04, 0.015, 0.011))  # the tracker's box [m]
SKY, MARK, SQUARE = (40, 42, 46), (0, 255, 255), (255, 0, 255)
SQUARE_SIZE = 16  # pixels


class Camera:
    """A pinhole without distortion: intrinsics from a camera_info YAML, the pose of its optical frame in world."""

    def __init__(self, info_file, pose):
        text = program.read_text(info_file)
        self.width, self.height = (int(re.search(key + r": *(\d+)", text).group(1))
                                   for key in ("image_width", "image_height"))
        matrix = re.search(r"camera_matrix:.*?data: *\[(.*?)\]", text, re.DOTALL).group(1)
        self.matrix = numpy.array([float(value) for value in matrix.split(",")]).reshape(3, 3)
        self.place = numpy.array(pose[:3])
        x, y, z, w = numpy.array(pose[3:]) / numpy.linalg.norm(pose[3:])
        self.turn = numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                                 [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                                 [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])

    def rays(self, columns, rows):
        """Directions in world of the rays through pixels whose centres have whole coordinates."""
        local = numpy.stack([columns, rows, numpy.ones_like(columns)], axis=-1) @ numpy.linalg.inv(self.matrix).T
        return local @ self.turn.T

    def pixels(self, points):
        """Pixels of points in world."""
        seen = (numpy.asarray(points) - self.place) @ self.turn @ self.matrix.T
        return seen[:, :2] / seen[:, 2:]


def checks(u, v, size, light, dark):
    """Two shades in squares of a size."""
    odd = (numpy.floor(u / size) + numpy.floor(v / size)) % 2 == 1
    return numpy.where(odd[..., None], numpy.array(dark, float), numpy.array(light, float))


def table_top(u, v):
    line = numpy.minimum(numpy.abs(u - 0.05 * numpy.round(u / 0.05)), numpy.abs(v - 0.05 * numpy.round(v / 0.05)))
    wood = numpy.array((156.0, 128, 98)) * numpy.ones_like(u)[..., None]
    return numpy.where((line < 0.0012)[..., None], (112.0, 90, 66), wood)


def paint(picture, nearest, distance, inside, colours):
    """Mask of pixels where a surface is nearer than those painted before."""
    seen = inside & (distance > 0) & (distance < nearest)
    picture[seen] = numpy.broadcast_to(colours, picture.shape)[seen]
    nearest[seen] = distance[seen]


def shaded_box(picture, nearest, place, rays, low, high):
    """By slabs (Kay and Kajiya 1986), each pair of faces in a shade of its own."""
    with numpy.errstate(divide="ignore"):
        a, b = (numpy.array(low) - place) / rays, (numpy.array(high) - place) / rays
    enter, leave = numpy.minimum(a, b), numpy.maximum(a, b).min(axis=-1)
    shades = numpy.array([(52.0, 54, 58), (38, 40, 44), (74, 76, 80)])
    first = enter.max(axis=-1)
    paint(picture, nearest, first, first < leave, shades[enter.argmax(axis=-1)])


def room(camera, columns, rows):
    """Colours of the pixels, by the nearest surface that each ray meets."""
    rays = camera.rays(columns, rows)
    picture = numpy.ones(rays.shape) * SKY
    nearest = numpy.full(rays.shape[:2], numpy.inf)
    with numpy.errstate(divide="ignore", invalid="ignore"):
        for axis, level, extent, look in (
                (1, WALL, (9.0, 9.0), lambda x, y, z: checks(x, z, 0.30, (196, 199, 196), (186, 190, 188))),
                (2, FLOOR, (9.0, 9.0), lambda x, y, z: checks(x, y, 0.30, (120, 118, 114), (104, 102, 99))),
                (2, 0.0, TABLE, lambda x, y, z: table_top(x, y))):
            distance = (level - camera.place[axis]) / rays[..., axis]
            x, y, z = numpy.moveaxis(camera.place + distance[..., None] * rays, -1, 0)
            across = z if axis == 1 else y
            inside = (numpy.abs(x) < extent[0]) & (numpy.abs(across) < extent[1])
            paint(picture, nearest, distance, inside, look(x, y, z))
    shaded_box(picture, nearest, camera.place, rays, *DEVICE)
    return picture


def smooth_room(camera, samples=3):
    """The mean of several rays through each pixel."""
    offsets = (numpy.arange(samples) + 0.5) / samples - 0.5
    columns, rows = numpy.meshgrid(numpy.arange(camera.width, dtype=float), numpy.arange(camera.height, dtype=float))
    pictures = [room(camera, columns + dx, rows + dy) for dx in offsets for dy in offsets]
    return numpy.round(sum(pictures) / len(pictures)).astype(numpy.uint8)


def box_corners(centre, sides):
    half = numpy.array(sides) / 2
    signs = numpy.array([(a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)])
    return numpy.array(centre) + signs * half


def silhouette(camera, centre, sides):
    """The pixels whose rays meet the box: those inside the convex hull of its corners' images."""
    points = camera.pixels(box_corners(centre, sides))
    columns, rows = numpy.meshgrid(numpy.arange(camera.width), numpy.arange(camera.height))
    inside = numpy.ones(columns.shape, bool)
    for i, a in enumerate(points):
        for j, b in enumerate(points):
            across = (b[0] - a[0]) * (points[:, 1] - a[1]) - (b[1] - a[1]) * (points[:, 0] - a[0])
            if i != j and (across >= -1e-9).all():  # an edge of the hull: all corners are on one side
                inside &= (b[0] - a[0]) * (rows - a[1]) - (b[1] - a[1]) * (columns - a[0]) >= 0
    return inside


def corner_squares(picture):
    for rows in (slice(0, SQUARE_SIZE), slice(-SQUARE_SIZE, None)):
        for columns in (slice(0, SQUARE_SIZE), slice(-SQUARE_SIZE, None)):
            picture[rows, columns] = SQUARE


def numbers(count):
    def parse(text):
        values = [float(value) for value in text.replace(",", " ").split()]
        if len(values) != count:
            raise argparse.ArgumentTypeError(f"'{text}' is not {count} numbers")
        return values
    return parse


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--camera", required=True, help="camera_info YAML")
    parser.add_argument("--pose", required=True, type=numbers(7),
                        help="pose of the camera's optical frame in world: x y z qx qy qz qw")
    parser.add_argument("--mark", type=numbers(6), help="centre and sides of a box: x y z a b c")
    parser.add_argument("--output", required=True, help="a PNG file")
    options = parser.parse_args()
    try:
        camera = Camera(options.camera, options.pose)
    except (AttributeError, ValueError):
        sys.exit("room_picture: %s: is no camera_info; allowed: camera_calibration's YAML" % options.camera)
    picture = smooth_room(camera)
    if options.mark:
        picture[silhouette(camera, options.mark[:3], options.mark[3:])] = MARK
        corner_squares(picture)
    matplotlib.image.imsave(options.output, picture, format="png")


if __name__ == "__main__":
    program.run(main)
