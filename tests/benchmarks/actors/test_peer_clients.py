# SPDX-License-Identifier: Apache-2.0
"""Frames of both protocols count, also those that the kernel discards."""

import struct

import pytest

from benchmarks.actors.peer_clients import FOXGLOVE, PeerMessages
from benchmarks.samples import SAMPLES, message_type
from gateway.codec import cbor
from gateway.codec.json import dumps
from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions
from tests.benchmarks.actors.test_connection import connected

NOW_NS = 1_795_280_256_507_552_123
KINDS = ("odometry", "compressed-image", "point-cloud")


def frame(form, name):
    cdr = SAMPLES[name].cdr()
    SAMPLES[name].clockwork.write(cdr, NOW_NS)
    if form == FOXGLOVE:
        return struct.pack("<BIQ", 1, 1, NOW_NS) + bytes(cdr)
    if form == "cbor-raw":
        return cbor.dumps({"op": "publish", "msg": {"secs": 1, "nsecs": 2, "bytes": bytes(cdr)}})
    return dumps(Types(InstalledDefinitions()).get(message_type(name)).decode(bytes(cdr)))


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("form", [FOXGLOVE, "cbor-raw", "none"])
def test_the_age_of_a_frame_is_recorded(form, name):
    messages = PeerMessages(form)
    for _ in range(2):
        messages.note(1, memoryview(frame(form, name)), NOW_NS + 2_000_000)
    assert messages.report()["p50_ms"] == 2
    assert (messages.served(), messages.count()) == (1, 2)


def test_discarded_bytes_count_as_frames_as_long_as_the_others():
    messages = PeerMessages(FOXGLOVE)
    wire = frame(FOXGLOVE, "odometry")
    messages.note_discarded(2, 3 * (len(wire) + 4))
    assert (messages.served(), messages.count()) == (0, 0)
    messages.note(1, memoryview(wire), NOW_NS)
    assert (messages.served(), messages.count()) == (2, 4)


def test_a_connection_discards_what_has_arrived():
    with connected(lambda socket: socket.send(bytes(1000))) as connection:
        size = 0
        while size < 1004:
            size += connection.discard()
        assert size >= 1004
