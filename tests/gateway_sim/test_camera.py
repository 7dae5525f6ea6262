# SPDX-License-Identifier: Apache-2.0
"""The camera shows the painted room where a pinhole camera of its calibration would."""

import math

import numpy as np
import pytest

from gateway_sim.camera import ABOVE, AHEAD, CENTRE_X, CENTRE_Y, FOCAL_LENGTH, HEIGHT, WIDTH, Camera
from gateway_sim.world import START, Pose, furnished_room

WORLD = furnished_room()


@pytest.fixture(scope="module")
def camera():
    return Camera(WORLD)


def pixel(pose, x, y, z):
    """Project a point of the world with the calibration that camera_info tells."""
    cosine, sine = math.cos(pose.heading), math.sin(pose.heading)
    dx, dy = x - pose.x - AHEAD * cosine, y - pose.y - AHEAD * sine
    ahead, left = cosine * dx + sine * dy, -sine * dx + cosine * dy
    u = CENTRE_X - FOCAL_LENGTH * left / ahead
    v = CENTRE_Y + FOCAL_LENGTH * (ABOVE - z) / ahead
    assert 0 <= u < WIDTH
    assert 0 <= v < HEIGHT
    return round(v), round(u)


def is_reddish(colour):
    red, green, blue = colour.astype(int)
    return red > green + 60 and red > blue + 60


def is_white(colour):
    return colour.min() > 200


def test_a_picture_is_640_by_480_rgb(camera):
    picture = camera.draw(START)
    assert picture.shape == (480, 640, 3)
    assert picture.dtype == np.uint8


@pytest.mark.parametrize("pose", [Pose(2.2, -0.7, 0.0), Pose(2.4, -0.3, -0.25), Pose(1.5, -0.6, 0)])
def test_the_docks_rings_are_where_the_calibration_puts_them(camera, pose):
    picture = camera.draw(pose)
    bay = WORLD.bay
    board_centre = 0.1 + 0.62 / 2 - 0.08
    across = 0.03  # next to the dark stripe in the middle
    assert is_reddish(picture[pixel(pose, WORLD.x_max, bay.y + across, board_centre)])
    assert is_white(picture[pixel(pose, WORLD.x_max, bay.y + 0.08, board_centre)])
    assert is_reddish(picture[pixel(pose, WORLD.x_max, bay.y + 0.14, board_centre)])


@pytest.mark.parametrize("pose", [Pose(2.7, -0.7, 0.0), Pose(2.7, -0.5, -0.2)])
def test_the_bays_lines_are_where_the_calibration_puts_them(camera, pose):
    picture = camera.draw(pose)
    bay = WORLD.bay
    for side in (-1, 1):
        line = bay.y + side * (bay.width / 2 - 0.018)
        v, u = pixel(pose, bay.x - bay.depth / 2 + 0.05, line, 0.0)
        assert picture[v, u].min() > 190
    v, u = pixel(pose, bay.x - bay.depth / 2 + 0.05, bay.y, 0.0)
    red, _, blue = picture[v, u].astype(int)
    assert red > blue + 80, "the middle line is yellow"


def test_an_obstacle_hides_what_is_behind_and_ends_at_its_height(camera):
    pose = Pose(0.2, -1.5, 0.0)  # before the red crate
    crate = WORLD.obstacles[1]
    picture = camera.draw(pose)
    x = min(px for px, _ in crate.outline)
    below, above = (pixel(pose, x + 0.1, -1.5, crate.height + dz) for dz in (-0.12, 0.12))
    assert is_reddish(picture[below])
    assert not is_reddish(picture[above])


def test_the_nearer_of_two_obstacles_hides_the_farther(camera):
    pose = Pose(-0.5, 1.3, 0.0)  # the yellow pillar stands before the partition
    red, green, blue = camera.draw(pose)[pixel(pose, 0.25, 1.3, 0.3)].astype(int)
    assert min(red, green) > blue + 60


def test_the_bay_is_open_towards_the_room(camera):
    pose = Pose(2.75, -0.7, 0.0)
    picture = camera.draw(pose)
    bay = WORLD.bay
    for x, is_line in ((bay.x + bay.depth / 2 - 0.02, True), (bay.x - bay.depth / 2 + 0.02, False)):
        v, u = pixel(pose, x, bay.y + 0.04, 0.0)
        assert (picture[v, u].min() > 160) == is_line


def test_left_in_the_world_is_left_in_the_picture(camera):
    pillar = WORLD.obstacles[4]
    x = sum(px for px, _ in pillar.outline) / len(pillar.outline)
    y = sum(py for _, py in pillar.outline) / len(pillar.outline)
    pose = Pose(x - 1.0, y - 0.4, 0.0)
    picture = camera.draw(pose).astype(int)
    yellow = (picture[:, :, :2].min(axis=2) - picture[:, :, 2] > 60).sum(axis=0)
    columns = np.flatnonzero(yellow > 20)
    assert columns.max() < WIDTH / 2
    assert columns.mean() == pytest.approx(pixel(pose, x, y, 0.2)[1], abs=15)


def test_turning_left_moves_the_picture_to_the_right(camera):
    def ring(pose):
        picture = camera.draw(pose).astype(int)
        red = (picture[:, :, 0] - picture[:, :, 1] > 100).sum(axis=0)
        return np.flatnonzero(red).mean()

    assert ring(Pose(2.2, -0.7, 0.1)) > ring(Pose(2.2, -0.7, 0.0)) + 20


@pytest.mark.parametrize("heading", np.linspace(-3, 3, 9))
@pytest.mark.parametrize("place", [(-1.85, -2.35), (3.85, 2.35), (3.85, -0.7), (1.65, 1.75)])
def test_a_view_close_to_a_surface_is_drawn_too(camera, place, heading):
    picture = camera.draw(Pose(*place, heading))
    assert picture.std() > 0
    assert (picture.max(axis=2) > 0).mean() > 0.999, "no pixel is left unpainted"
