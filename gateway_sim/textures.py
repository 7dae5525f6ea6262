# SPDX-License-Identifier: Apache-2.0
"""The textures of the simulated room: the images of its floor and surfaces, in one atlas.

OpenCV paints them once, in RGB. The camera only looks pixels up.
"""

from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from gateway_sim.world import Bay, Colour, World

Picture = NDArray[np.uint8]

WALL_SCALE: Final = 100  # pixels per metre: one per pixel of the camera 4 m away
# The floor in three resolutions: seen from above the ground, a far pixel covers much floor.
FLOOR_SCALES: Final = (200.0, 50.0, 12.5)

SKY_ROWS: Final = 256

_WIDTH: Final = 2048  # of the atlas, and the most for one image
_MARGIN: Final = 4  # pixels repeated around each picture, so that interpolation bleeds nothing in
_WALL_COLOURS: Final[tuple[Colour, ...]] = (
    (150, 176, 196),  # north
    (204, 184, 152),  # east
    (160, 190, 160),  # south
    (196, 164, 170),  # west
)
_WALL_NAMES: Final = ("NORTH", "EAST", "SOUTH", "WEST")
_WHITE: Final = (240, 240, 236)
_DARK: Final = (46, 48, 54)
_YELLOW: Final = (246, 196, 40)
_RED: Final = (206, 52, 44)


@dataclass(frozen=True, slots=True)
class Place:
    """The position of a picture in the atlas."""

    x: int
    y: int


@dataclass(frozen=True, slots=True)
class Atlas:
    """All pictures in one: the floors with row 0 at the lowest y, the surfaces upright."""

    picture: Picture
    sky: Place  # SKY_ROWS rows, from the zenith to the horizon
    floors: tuple[Place, ...]  # one for each of FLOOR_SCALES
    surfaces: tuple[Place, ...]  # in the world's order


def paint(world: World) -> Atlas:
    """Paint the whole world."""
    floor = _floor(world)
    floors = [_shrunk(floor, scale / FLOOR_SCALES[0]) for scale in FLOOR_SCALES]
    pictures = [_sky(), *floors, *_walls(world), *_faces(world)]
    places, height = _pack(pictures)
    atlas = np.zeros((height, _WIDTH, 3), np.uint8)
    for picture, place in zip(pictures, places, strict=True):
        m = _MARGIN
        framed = cv2.copyMakeBorder(picture, m, m, m, m, cv2.BORDER_REPLICATE)
        rows, columns = framed.shape[:2]
        atlas[place.y - m : place.y - m + rows, place.x - m : place.x - m + columns] = framed
    count = len(FLOOR_SCALES)
    return Atlas(atlas, places[0], tuple(places[1 : 1 + count]), tuple(places[1 + count :]))


def _pack(pictures: list[Picture]) -> tuple[list[Place], int]:
    """Put pictures side by side on shelves, and return their places and the height of all."""
    places: list[Place] = []
    x = y = shelf = 0
    for picture in pictures:
        rows, columns = (size + 2 * _MARGIN for size in picture.shape[:2])
        if x + columns > _WIDTH:
            x, y, shelf = 0, y + shelf, 0
        places.append(Place(x + _MARGIN, y + _MARGIN))
        x += columns
        shelf = max(shelf, rows)
    return places, y + shelf


def _shrunk(picture: Picture, factor: float) -> Picture:
    small = cv2.resize(picture, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.uint8)


def _sky() -> Picture:
    shades = np.linspace((112, 132, 158), (226, 232, 238), SKY_ROWS)
    return np.repeat(shades[:, None, :], 4, axis=1).astype(np.uint8)


def _floor(world: World) -> Picture:
    scale = FLOOR_SCALES[0]
    columns = round((world.x_max - world.x_min) * scale)
    rows = round((world.y_max - world.y_min) * scale)
    tile = round(0.5 * scale)
    v, u = np.mgrid[0:rows, 0:columns]
    light = ((u // tile + v // tile) % 2).astype(bool)
    floor = np.where(light[:, :, None], (198, 192, 182), (172, 166, 158)).astype(np.uint8)
    grain = np.random.default_rng(1).normal(0, 5, (rows, columns, 1))
    floor = np.clip(floor + grain, 0, 255).astype(np.uint8)
    joint = round(0.006 * scale)
    floor[(u % tile < joint) | (v % tile < joint)] = (128, 124, 118)
    bay = _bay(world.bay, scale)
    # Painted as seen by a driver who faces east: up is east, left is north.
    seen = np.ascontiguousarray(bay[::-1, ::-1].transpose(1, 0, 2))
    y = round((world.bay.y - world.y_min) * scale) - seen.shape[0] // 2
    x = round((world.bay.x - world.x_min) * scale) - seen.shape[1] // 2
    floor[y : y + seen.shape[0], x : x + seen.shape[1]] = seen
    return floor


def _bay(bay: Bay, scale: float) -> Picture:
    """Paint a parking bay: a white frame open at the bottom, a yellow middle line, a P."""
    rows, columns = round(bay.depth * scale), round(bay.width * scale)
    line = round(0.035 * scale)
    picture = np.full((rows, columns, 3), (74, 84, 104), np.uint8)
    middle = columns // 2
    cv2.line(picture, (middle, 0), (middle, rows), _YELLOW, max(1, line // 2))
    picture[:, :line] = picture[:, -line:] = picture[:line] = _WHITE
    for x in (columns // 4, 3 * columns // 4):
        _write(picture, "P", x, rows // 2, columns // 4, _WHITE)
    return picture


def _walls(world: World) -> list[Picture]:
    pictures = []
    for index, (colour, name) in enumerate(zip(_WALL_COLOURS, _WALL_NAMES, strict=True)):
        length = float(np.hypot(*(world.ends[index] - world.starts[index])))
        picture = _plain(length, world.height, colour)
        rows, columns = picture.shape[:2]
        for x in range(0, columns, WALL_SCALE // 2):
            # a post each half metre, a broad one each metre: people judge distances by them
            width = 5 if x % WALL_SCALE == 0 else 2
            picture[:, x : x + width] = _shaded(colour, 0.78)
        for x in range(WALL_SCALE, columns - WALL_SCALE // 2, 2 * WALL_SCALE):
            _write(picture, name, x, rows // 5, 16, _shaded(colour, 0.5))
        picture[-round(0.08 * WALL_SCALE) :] = _DARK
        pictures.append(picture)
    # The east wall runs southwards, from its left end to its right.
    _mark_bay(pictures[1], round((world.y_max - world.bay.y) * WALL_SCALE))
    return pictures


def _mark_bay(wall: Picture, x: int) -> None:
    """Paint a board behind the bay whose middle stripe and rings distinguish left from right."""
    bottom = wall.shape[0] - round(0.1 * WALL_SCALE)
    half, height = round(0.25 * WALL_SCALE), round(0.62 * WALL_SCALE)
    board = wall[bottom - height : bottom, x - half : x + half]
    board[:] = _WHITE
    board[:, :3] = board[:, -3:] = board[:3] = _RED
    _write(board, "DOCK", half, 14, 14, _DARK)
    centre = (half, height // 2 + 8)
    for radius, colour in ((17, _RED), (11, _WHITE), (5, _RED)):
        cv2.circle(board, centre, radius, colour, -1, cv2.LINE_AA)
    board[height // 2 + 8 :, half - 1 : half + 1] = _DARK


def _faces(world: World) -> list[Picture]:
    pictures = []
    for obstacle in world.obstacles:
        outline = np.array(obstacle.outline)
        for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
            edge = end - start
            length = float(np.hypot(*edge))
            # lit from the south-west: each face has its own brightness
            light = 0.82 + 0.18 * float(edge[0] * 0.8 + edge[1] * -0.6) / length
            picture = _plain(length, obstacle.height, _shaded(obstacle.colour, light))
            _brace(picture, _shaded(obstacle.colour, light * 0.72), crossed=length > 0.3)
            pictures.append(picture)
    return pictures


def _brace(picture: Picture, colour: Colour, *, crossed: bool) -> None:
    rows, columns = picture.shape[:2]
    picture[:3] = picture[-4:] = colour
    if crossed:
        picture[:, :3] = picture[:, -3:] = colour
        cv2.line(picture, (0, 0), (columns, rows), colour, 3, cv2.LINE_AA)
        cv2.line(picture, (columns, 0), (0, rows), colour, 3, cv2.LINE_AA)
    else:
        for row in range(0, rows, 20):
            picture[row : row + 6] = colour


def _plain(length: float, height: float, colour: Colour) -> Picture:
    shape = (max(1, round(height * WALL_SCALE)), max(1, round(length * WALL_SCALE)), 3)
    return np.full(shape, colour, np.uint8)


def _shaded(colour: Colour, light: float) -> Colour:
    red, green, blue = (min(255, round(part * light)) for part in colour)
    return red, green, blue


def _write(picture: Picture, text: str, x: int, y: int, height: int, colour: Colour) -> None:
    """Write with the middle of the text at a pixel."""
    font, thickness = cv2.FONT_HERSHEY_SIMPLEX, max(1, height // 8)
    size = cv2.getFontScaleFromHeight(font, height, thickness)
    (width, tall), _ = cv2.getTextSize(text, font, size, thickness)
    origin = (x - width // 2, y + tall // 2)
    cv2.putText(picture, text, origin, font, size, colour, thickness, cv2.LINE_AA)
