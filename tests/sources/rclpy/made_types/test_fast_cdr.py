# SPDX-License-Identifier: Apache-2.0
"""Bytes in and out of Fast CDR, as rmw has it."""

import ctypes

import pytest

from gateway.sources.rclpy.made_types import fast_cdr
from gateway.sources.rclpy.made_types.fast_cdr import FastCdr
from gateway.sources.source import RosError


class Opened:
    """A Cdr over some bytes."""

    def __init__(self, functions: FastCdr, octets: bytes) -> None:
        self.octets = ctypes.create_string_buffer(octets, len(octets))
        self._buffer = ctypes.create_string_buffer(fast_cdr._ROOM)
        self._cdr = ctypes.create_string_buffer(fast_cdr._ROOM)
        functions._buffer(self._buffer, self.octets, len(octets))
        functions._cdr(self._cdr, self._buffer, 1, 1)
        self.address = ctypes.addressof(self._cdr)


def test_written_bytes_follow_earlier_ones():
    functions = FastCdr()
    cdr = Opened(functions, bytes(9))
    for octets in (b"abc", b"", b"d\0fgh"):
        assert functions.write(cdr.address, octets=octets, count=len(octets))
    assert cdr.octets.raw == b"abcd\0fgh\0"


def test_all_is_read_from_where_it_is_to_the_end():
    functions = FastCdr()
    cdr = Opened(functions, b"headabcdefgh")
    assert functions._jump(cdr.address, 4)
    assert functions.read_all(cdr.address, 4) == (b"head", b"abcdefgh")


@pytest.mark.parametrize("missing", ["_LIBRARY", "_CDR"])
def test_another_fast_cdr_is_refused(missing: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(fast_cdr, missing, "nothing")
    with pytest.raises(RosError, match="this Fast CDR lacks a function") as caught:
        FastCdr()
    assert caught.value.code == "bad_type"


def test_a_cdr_whose_end_cannot_be_found_is_refused(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(fast_cdr, "_STEP", 5000)  # more than there is
    with pytest.raises(RosError, match="this Fast CDR does not show its end"):
        FastCdr()
