# SPDX-License-Identifier: Apache-2.0
"""Frames that are legal and cost as much as they can.

A client may send anything within the limits. `benchmarks.bombs` searches for more.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from gateway.codec import cbor
from gateway.codec.cbor_reader import MAX_SINGLE_ITEMS
from gateway.codec.json import LARGE_TEXT_BYTES, MAX_TOKENS
from gateway.codec.json_bounds import (
    BACKSLASH_COST,
    MAX_CONTAINERS,
    MAX_COST,
    MAX_ITEMS,
    MAX_STRINGS,
    OUTSIDE_COST,
    STRING_COST,
    WIDE_COST,
)
from gateway.config.limits import Limits
from schemas.json_forms import MAX_BROKEN_TEXT

MAX_MESSAGE_BYTES: Final = Limits().max_message_bytes

SPARE: Final = 20  # containers and items of the frame around the array
_HARD_NUMBER: Final = (  # between two that a double can hold: no parser may take a short way
    "2.2250738585072011360574097967091319759348195463516456480234261097248222220210769455165295239081"
    "3508e-308"
)
_IMAGE: Final = "sensor_msgs/msg/Image"
_SCAN: Final = "sensor_msgs/msg/LaserScan"
_JOY: Final = "sensor_msgs/msg/Joy"
_GRID: Final = "nav_msgs/msg/OccupancyGrid"
_DOUBLES: Final = "std_msgs/msg/Float64MultiArray"
_MARKERS: Final = "visualization_msgs/msg/MarkerArray"
_JOINTS: Final = "sensor_msgs/msg/JointState"
_TRANSFORMS: Final = "tf2_msgs/msg/TFMessage"
_STRING: Final = "std_msgs/msg/String"


@dataclass(frozen=True)
class HostileFrame:
    """A frame, and its name in the table."""

    name: str
    data: bytes


def publish(type_name: str, message: str) -> bytes:
    """Return a frame that publishes a message, given as JSON, on a topic for its type."""
    topic = f"/hostile/{type_name.replace('/', '_')}"
    return f'{{"op":"publish","topic":"{topic}","type":"{type_name}","msg":{message}}}'.encode()


def large_frames() -> Iterator[HostileFrame]:
    """Return frames that hold much of what an honest client sends, and as much as they can."""
    room = MAX_MESSAGE_BYTES - 1000
    for width, height in ((604, 307), (400, 400), (1006, 1674)):
        cells = ",".join((["-1", "0", "100"] * (width * height // 3 + 1))[: width * height])
        info = f'{{"width":{width},"height":{height},"resolution":0.05}}'
        map_ = publish(_GRID, f'{{"info":{info},"data":[{cells}]}}')
        yield HostileFrame(f"a map of {width} x {height}", map_)
        typed = b"\xd8\x48" + cbor.head(cbor.OCTETS, width * height) + bytes(width * height)
        yield HostileFrame(f"CBOR: a map of {width} x {height}", _cbor(_GRID, "data", typed))
    floats = ",".join(f"{number / 7:.15f}" for number in range(room // 22))
    mixed = ",".join(["0.1,2,-3e5"] * (room // 11))
    names = ",".join(f'"joint_{number}"' for number in range(MAX_STRINGS - 1000))
    transform = (
        '{"header":{"frame_id":"map"},"child_frame_id":"base","transform":'
        '{"translation":{"x":1.5,"y":2,"z":0},"rotation":{"x":0,"y":0,"z":0,"w":1}}}'
    )
    for name, data in {
        "10 MB of numbers": publish(_DOUBLES, f'{{"data":[{floats}]}}'),
        "10 MB of integers for floats": publish(_SCAN, f'{{"ranges":[{"17," * (room // 3)}0]}}'),
        "10 MB of mixed numbers": publish(_SCAN, f'{{"ranges":[{mixed}]}}'),
        "10 MB of mixed numbers, then a text": publish(_SCAN, f'{{"ranges":[{mixed},"x"]}}'),
        "10 MB of zeros": publish(_SCAN, f'{{"ranges":[{"0," * (room // 2)}0]}}'),
        "5,000 empty markers": publish(_MARKERS, f'{{"markers":[{"{}," * 4999}{{}}]}}'),
        "59,000 joint names": publish(_JOINTS, f'{{"name":[{names}]}}'),
        "4,900 transforms": publish(_TRANSFORMS, f'{{"transforms":[{_times(transform, 4900)}]}}'),
        "a base64 image of 7 MB": publish(_IMAGE, f'{{"data":"{"A" * 9_333_332}"}}'),
        "a type of 9 MB": publish(_STRING, "{}").replace(b"std_msgs/", b"s" * 9_000_000, 1),
        "a type of 9 MB, new": b'{"op":"advertise","topic":"/x","type":"%b"}' % (b"t" * 9_000_000),
        "10 MB of [": b"[" * room,
        "10 MB of {": b'{"a":' * (room // 5),
        "10 MB of spaces": b" " * room,
        "10 MB of commas": b"," * room,
        "10 MB of bad JSON": b"x" * room,
    }.items():
        yield HostileFrame(name, data)


def _times(element: str, count: int) -> str:
    return ",".join([element] * count)


def plain_frames() -> Iterator[HostileFrame]:
    """Return frames that need no search: long ones, deep ones, wrong ones, and other operations."""
    most, containers = MAX_ITEMS - SPARE, MAX_CONTAINERS - SPARE
    room = MAX_MESSAGE_BYTES - 1000
    floats, nulls = ",".join(["0.1"] * most), ",".join(["null"] * most)
    few = (LARGE_TEXT_BYTES - 1000) // 4 * 4  # of the characters of these numbers
    strings = MAX_STRINGS - SPARE
    names, ones = ",".join(['"Infinity"'] * strings), ",".join(["1.0"] * most)
    members = ",".join(f'"k{number}":"v"' for number in range(strings // 2))
    hard = _hard_numbers((MAX_COST - 1000) // (1 + OUTSIDE_COST))
    for name, data in {
        "ranges: numbers": publish(_SCAN, f'{{"ranges":[{floats}]}}'),
        "ranges: nulls": publish(_SCAN, f'{{"ranges":[{nulls}]}}'),
        "ranges: numbers, then null": publish(_SCAN, f'{{"ranges":[{floats[:-3]}null]}}'),
        "ranges: numbers, then text": publish(_SCAN, f'{{"ranges":[{floats[:-3]}""]}}'),
        "ranges: names": publish(_SCAN, f'{{"ranges":[{names}]}}'),
        "ranges: names, then text": publish(_SCAN, f'{{"ranges":[{names},""]}}'),
        "tokens: numbers, then NaN": publish(_SCAN, f'{{"ranges":[{floats[:few]}NaN]}}'),
        **{
            f"tokens: {text}": publish(_SCAN, f'{{"ranges":[{_filled(text)}NaN]}}')
            for text in ("NaN", "-Infinity", '"NaN"', '"",NaN')
        },
        "tokens: NaN for integers": publish(_JOY, f'{{"buttons":[{_filled("NaN")}NaN]}}'),
        "tokens: objects with NaN": b"[" + _filled('{"a":NaN}').encode() + b"NaN]",
        "integers as floats": publish(_JOY, f'{{"buttons":[{ones}]}}'),
        "octets as floats, the last too large": publish(_IMAGE, f'{{"data":[{ones},256]}}'),
        "octets as integers": publish(_IMAGE, f'{{"data":[{",".join(["255"] * most)}]}}'),
        "octets, the last too large": publish(
            _IMAGE, f'{{"data":[{",".join(["255"] * (most - 1))},256]}}'
        ),
        "octets as base64": publish(_IMAGE, f'{{"data":"{"A" * (room // 4 * 4)}"}}'),
        "octets as bad base64": publish(_IMAGE, f'{{"data":"{"A" * (room // 4 * 4 - 1)}?"}}'),
        "octets as bad base64 in lines": publish(
            _IMAGE, f'{{"data":"{(("A" * 76) + chr(92) + "n") * (MAX_BROKEN_TEXT // 77)}?"}}'
        ),
        "ranges: long numbers": publish(_SCAN, f'{{"ranges":[{hard}]}}'),
        "unknown fields": publish(_STRING, f"{{{members}}}"),
        "unfinished arrays": b"[" * room,
        "nothing but arrays": b"[" + b",".join([b"[]"] * containers) + b"]",
        "nothing but objects": b"[" + b",".join([b'{"a":{}}'] * (containers // 2)) + b"]",
        "colons in strings": f'{{"op":"x","y" :":",{members}}}'.encode(),
        "a duplicate among many": f'{{"op":"x","y" :":","op":"x",{members}}}'.encode(),
        "a call with many values": _operation(
            "call_service", f'"service":"/rosapi/topics","args":[{floats}]'
        ),
        "all topics with their definitions": _operation(
            "call_service", '"service":"/rosapi/topics_and_raw_types"'
        ),
        "a description of a large type": _operation(
            "describe", '"type":"visualization_msgs/msg/InteractiveMarkerUpdate"'
        ),
        "the graph": _operation("graph", '"id":1'),
        "a long name of an operation": b'{"op":"' + b"s" * room + b'"}',
        "a long topic": b'{"op":"subscribe","topic":"/' + b"s" * room + b'"}',
    }.items():
        yield HostileFrame(name, data)
    yield from _text_frames()
    yield from _cbor_frames()


def _text_frames() -> Iterator[HostileFrame]:
    """Return frames of long strings, many strings, and what is hard to tell from them."""
    room, strings = MAX_MESSAGE_BYTES - 1000, MAX_STRINGS - SPARE
    cost, back = MAX_COST - 2000, chr(92)
    escapes = (cost - room) // BACKSLASH_COST
    line = "a" * (room // escapes - 2) + back
    most_wide = cost // (1 + WIDE_COST)
    # half of the strings are names
    left = cost - STRING_COST * strings - (1 + OUTSIDE_COST) * 3 * strings
    member, wide_member = left // strings - 8, left // (1 + WIDE_COST) // strings - 8
    aside = (cost - 8_000_000) // (1 + OUTSIDE_COST)
    for name, text in {
        "": "a" * room,
        ", with a quote": back + '"' + "a" * room,
        ", with lines": (line + "n") * escapes,
        ", with quotes": (line + '"') * escapes,
        " of line ends": (back + "n") * (cost // (2 + BACKSLASH_COST)),
        " of backslashes": back * (cost // (1 + BACKSLASH_COST) // 2 * 2),
        ", with ü": "ü" + "a" * most_wide,
        ", with €": "€" + "a" * most_wide,
        ", with an emoji": "😀" + "a" * most_wide,
        ", with an escaped emoji": f"{back}ud83d{back}ude00" + "a" * most_wide,
        " of emojis": "😀" * (most_wide // 4),
        ", and numbers": "a" * 8_000_000 + f'","x":[{_hard_numbers(aside)}],"y":"',
    }.items():
        yield HostileFrame(f"a long string{name}", publish(_STRING, f'{{"data":"{text}"}}'))
        if name in {"", ", with an emoji"}:
            wrong = f'{{"op":"x","y":"{text}",}}'.encode()
            yield HostileFrame(f"a long string{name}, then a mistake", wrong)
    for name, data in {
        "too wide": f'["{"😀" + "a" * room}"]'.encode(),
        "strings of 2 KiB": b"[" + b",".join([b'"%s"' % (b"a" * 2049)] * (room // 2053)) + b"]",
        "strings of colons": _members(strings // 2, ":" * member),
        "wide strings of colons": _members(strings // 2, "😀" + ":" * (wide_member - 4)),
        "names of 2 KiB": _members(4900, "a" * 2080, "1"),
        "names with lines": _members(4900, (line + "n") * (2080 // (len(line) + 1)), "1"),
        "white space": b'["",' + b" " * (cost // (1 + OUTSIDE_COST)) + b"1]",
        "nothing but backslashes": b'"' + b"\\" * room + b'"',
        "nothing but quotes": b'"' * room,
        "nothing but colons": b":" * room,
        "strings of commas": b'["' + b"," * (LARGE_TEXT_BYTES - 10) + b'"]',
        "strings of escapes": b'["' + b'\\"' * (LARGE_TEXT_BYTES // 2 - 10) + b'"]',
    }.items():
        yield HostileFrame(name, data)


def _members(count: int, text: str, value: str | None = None) -> bytes:
    """Return an object whose names begin with a number. They and the values have a text."""
    value = f'"{text}"' if value is None else value
    members = ",".join(f'"{number:05}{text}" :{value}' for number in range(count))
    return f"{{{members}}}".encode()


def _hard_numbers(size: int) -> str:
    """Return numbers with commas, so many characters of them."""
    return f"{_HARD_NUMBER}," * (size // (len(_HARD_NUMBER) + 1) - 2) + "0"


def _cbor_frames() -> Iterator[HostileFrame]:
    """Return frames in CBOR: as many items as may be, of each kind, and what ends in a refusal."""
    most, room = MAX_SINGLE_ITEMS - SPARE, MAX_MESSAGE_BYTES - 1000
    numbers = MAX_ITEMS - SPARE
    kinds = {
        "integers": (b"\x01", most),
        "floats": (b"\xfb" + bytes(8), most),
        "texts": (b"\x61a", most),
        "octets": (b"\x41a", most),
        "arrays": (b"\x80", most),
        "maps": (b"\xa0", most),
        "arrays of one": (b"\x81\x80", most // 2),
        "maps of one": (b"\xa1\x61a\xa0", most // 3),
        "typed arrays": (b"\xd8\x55\x40", most // 5),
    }
    for name, (item, count) in kinds.items():
        yield HostileFrame(
            f"CBOR: {name}", _cbor(_STRING, "data", _cbor_array(item * count, count))
        )
    floats = cbor.head(cbor.OCTETS, 4 * numbers) + b"\0\0\0?" * numbers
    for name, type_name, field, value in (
        ("ranges as float32", _SCAN, "ranges", b"\xd8\x55" + floats),
        ("ranges as integers", _SCAN, "ranges", b"\xd8\x4e" + floats),
        ("integers as float32", _JOY, "buttons", b"\xd8\x55" + floats),
        ("octets", _IMAGE, "data", cbor.head(cbor.OCTETS, room) + bytes(room)),
        ("a long text", _STRING, "data", cbor.text("a" * room)),
        (
            "a wide text",
            _STRING,
            "data",
            cbor.text("😀" + "a" * ((MAX_COST - 1000) // (1 + WIDE_COST))),
        ),
        ("text for octets", _IMAGE, "data", cbor.text("A" * (room // 4 * 4))),
    ):
        yield HostileFrame(f"CBOR: {name}", _cbor(type_name, field, value))
    keys = b"".join(cbor.text(f"k{number}") + b"\1" for number in range(most // 2))
    yield HostileFrame("CBOR: unknown fields", cbor.head(cbor.MAP, most // 2) + keys)


def _cbor_array(items: bytes, count: int) -> bytes:
    return cbor.head(cbor.ARRAY, count) + items


def _cbor(type_name: str, field: str, value: bytes) -> bytes:
    """Return a frame that publishes a message with one field, given as CBOR."""
    start = cbor.dumps({"op": "publish", "topic": "/hostile/cbor/" + field, "type": type_name})
    four = cbor.head(cbor.MAP, 4) + start[1:]
    return four + cbor.text("msg") + cbor.head(cbor.MAP, 1) + cbor.text(field) + value


def _filled(element: str) -> str:
    """Return elements, each with its comma, as many as may stand next to a NaN."""
    tokens = element.count("NaN") + element.count("Infinity") + element.count('"') // 2
    most = min((MAX_TOKENS - SPARE) // tokens, (LARGE_TEXT_BYTES - 1000) // (len(element) + 1))
    return f"{element}," * (min(most, MAX_CONTAINERS - SPARE) if "{" in element else most)


def _operation(op: str, members: str) -> bytes:
    return f'{{"op":"{op}",{members}}}'.encode()
