# SPDX-License-Identifier: Apache-2.0
"""The relay of what libraries write, as the process that it is."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import pytest

from gateway.cli import output_relay
from gateway.cli.output_relay import MAX_WAITING_BYTES
from gateway.ending_signals import ENDING
from tests.client import TIMEOUT_S


@dataclass
class Relay:
    """A relay with one pair: what is written to `source` can be read from `sink`."""

    process: "subprocess.Popen[bytes]"
    source: int
    sink: IO[bytes]

    def write(self, data: bytes) -> None:
        """Write all, and wait while the pipe is full."""
        while data:
            data = data[os.write(self.source, data) :]

    def finish(self) -> None:
        self.process.stdin.close()

    def ended_well(self) -> bool:
        return self.process.wait(TIMEOUT_S) == 0


@pytest.fixture
def relay() -> Iterator[Relay]:
    with started() as relay:
        yield relay


@contextmanager
def started() -> Iterator[Relay]:
    source, writable = os.pipe()
    readable, sink = os.pipe()
    process = subprocess.Popen(
        [sys.executable, "-I", "-S", output_relay.__file__, str(source), str(sink)],
        stdin=subprocess.PIPE,
        pass_fds=(source, sink),
    )
    os.close(source)
    os.close(sink)
    with os.fdopen(readable, "rb") as file, os.fdopen(writable, "wb"), process:
        try:
            yield Relay(process, writable, file)
        finally:
            process.kill()


def test_nobody_who_writes_waits_for_who_reads_and_what_is_too_much_is_counted(relay: Relay):
    written = 4 * MAX_WAITING_BYTES
    relay.write(b"x" * written)
    relay.finish()
    first, notice = relay.sink.read().splitlines()
    assert set(first) == set(b"x")
    assert MAX_WAITING_BYTES / 2 < len(first) < 2 * MAX_WAITING_BYTES  # with what a pipe takes
    assert notice == b"%d bytes are missing here" % (written - len(first))
    assert relay.ended_well()


def test_output_after_a_loss_is_handed_on_again(relay: Relay):
    relay.write(bytes(2 * MAX_WAITING_BYTES))
    relay.sink.read(MAX_WAITING_BYTES // 2)
    relay.write(b"afterwards\n")
    relay.finish()
    _, notice, line = relay.sink.read().splitlines()
    assert (notice.endswith(b" bytes are missing here"), line) == (True, b"afterwards")


def test_it_ends_when_nobody_can_write_any_more(relay: Relay):
    relay.write(b"last")
    with Path(os.devnull).open("wb") as nowhere:
        os.dup2(nowhere.fileno(), relay.source)
    assert relay.sink.read() == b"last"
    assert relay.ended_well()


def test_it_ends_when_it_must_though_others_may_still_write(relay: Relay):
    relay.write(b"last")
    relay.finish()
    assert relay.sink.read() == b"last"
    assert relay.ended_well()


def test_it_ends_when_nobody_reads_any_more(relay: Relay):
    relay.write(bytes(MAX_WAITING_BYTES // 2))
    relay.sink.close()
    assert relay.ended_well()


@pytest.mark.parametrize("number", [*ENDING, signal.SIGHUP])
def test_a_signal_that_is_for_the_gateway_ends_nothing(relay: Relay, number: signal.Signals):
    relay.write(b"first\n")
    assert relay.sink.readline() == b"first\n"  # it has started
    relay.process.send_signal(number)
    relay.write(b"second\n")
    assert relay.sink.readline() == b"second\n"
    relay.finish()
    assert relay.ended_well()
