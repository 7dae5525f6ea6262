# SPDX-License-Identifier: Apache-2.0
"""Transforms that nodes publish, of any numbers, between any frames, and lookups between these."""

import math

from gateway.tf.buffer import MAX_FRAMES, Buffer
from gateway.tf.errors import InvalidTransformError, TransformError
from gateway.tf.history import HISTORY_NS
from gateway.tf.rigid import Rigid
from tests.fuzz.choices import Choices
from tests.fuzz.target import Target, check

FRAMES = ("map", "odom", "base", "/base", "arm", "lens", "", "x" * 257, "é")
STAMPS_NS = (0, 1, 10**9, 2 * 10**9, 2**63 - 1, -(2**63), 3 * 10**9, HISTORY_NS, -1)
WILD = (math.nan, math.inf, -math.inf, 1e308, 1e-320, -0.0)
MODEST = 1e6  # below, what rounding loses is less than the tolerance


def run(data: bytes) -> None:
    choices = Choices(data)
    buffer = Buffer()
    now_ns, largest = 0, 0.0
    above: dict[str, set[str]] = {}  # all parents that a frame has had
    while not choices.is_over:
        now_ns += choices.pick((0, 1, 10**9, HISTORY_NS + 1))
        match choices.byte() % 8:
            case 0:
                buffer.clear()
            case 1 | 2 | 3:
                is_modest = largest < MODEST and not has_loop(above)
                look(buffer, choices, is_modest=is_modest)
            case _:
                transform = a_transform(choices)
                child, parent = choices.pick(FRAMES), choices.pick(FRAMES)
                above.setdefault(child.strip("/"), set()).add(parent.strip("/"))
                try:
                    buffer.insert(
                        child,
                        parent,
                        choices.pick(STAMPS_NS),
                        transform,
                        heard_ns=now_ns,
                        is_static=choices.happens(64),
                    )
                    largest = max(largest, *map(abs, transform[:3]))
                except InvalidTransformError as error:
                    check(str(error) and error.fault)
        check(len(buffer._known) <= MAX_FRAMES)


def has_loop(above: dict[str, set[str]]) -> bool:
    """Return whether a frame is above itself: then there are two ways to another."""

    def rises_to(frame: str, wanted: str, seen: set[str]) -> bool:
        new = above.get(frame, set()) - seen
        return wanted in new or any(rises_to(each, wanted, seen | new) for each in new)

    return any(rises_to(frame, frame, set()) for frame in above)


def look(buffer: Buffer, choices: Choices, *, is_modest: bool) -> None:
    """Look a transform up, and its inverse if there is one way between the frames."""
    target, source = choices.pick(FRAMES), choices.pick(FRAMES)
    stamp_ns = choices.pick((None, *STAMPS_NS))
    try:
        found = buffer.lookup(target, source, stamp_ns)
    except TransformError as error:
        check(str(error), "no words")
        return
    check(stamp_ns is None or found.stamp_ns == stamp_ns, "not the time that was asked for")
    rotation = math.hypot(*found.transform[3:])
    check(math.isclose(rotation, 1, rel_tol=1e-6), "no rotation", found)
    if is_modest:
        back = buffer.lookup(source, target, stamp_ns)
        check(back.stamp_ns == found.stamp_ns, "another time")
        there_and_back = back.transform.after(found.transform)
        check(math.hypot(*there_and_back[:3]) < 1e-3, "not the inverse", there_and_back)


def a_transform(choices: Choices) -> Rigid:
    return Rigid(*(a_number(choices) for _ in range(7)))


def a_number(choices: Choices) -> float:
    if choices.happens(8):
        return choices.pick(WILD)
    if choices.happens(4):
        return choices.number()
    return (choices.byte() - 128) / 16


def corpus() -> list[bytes]:
    def inserted(child: int, parent: int, stamp: int, rotation: int, *, static: bool) -> bytes:
        numbers = bytes(6) + b"\x10\0\0" + bytes((0, 0, rotation)) * 4
        return b"\0\4" + numbers[:21] + bytes((child, parent, stamp, 255 * static))

    tree = inserted(1, 0, 2, 40, static=False) + inserted(2, 1, 2, 60, static=False)
    arm = inserted(4, 2, 0, 9, static=True) + inserted(5, 4, 0, 3, static=True)
    loop = inserted(0, 2, 2, 0, static=False)
    lookups = b"\0\1\0\5\0" + b"\1\1\5\0\3" + b"\2\1\1\2\4"
    return [tree + arm + lookups, tree + loop + lookups, tree + b"\3\0" + lookups, arm + lookups]


TARGET = Target("transforms are rotations and inverses of each other, or refused", run, corpus)
