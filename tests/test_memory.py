# SPDX-License-Identifier: Apache-2.0
import ctypes
import subprocess
import sys
from types import SimpleNamespace

import pytest

from gateway.memory import keep_large_blocks, returning_free_memory
from tests.client import TIMEOUT_S
from tests.clock import StoppedClock

MIB = 1024**2


def test_blocks_of_32_mib_come_from_the_heap_which_keeps_64_mib(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[tuple[int, int]] = []
    library = SimpleNamespace(mallopt=lambda *option: asked.append(option))
    monkeypatch.setattr(ctypes, "CDLL", lambda name: library)
    keep_large_blocks()
    m_trim_threshold, m_mmap_threshold = -1, -3  # malloc.h
    assert sorted(asked) == [(m_mmap_threshold, 32 * MIB), (m_trim_threshold, 64 * MIB)]


def test_another_c_library_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ctypes, "CDLL", lambda name: SimpleNamespace())
    keep_large_blocks()
    with returning_free_memory():
        pass


async def test_free_memory_goes_back_again_and_again_until_the_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[int] = []
    monkeypatch.setattr(ctypes, "CDLL", lambda name: SimpleNamespace(malloc_trim=asked.append))
    clock = StoppedClock(monkeypatch)
    with returning_free_memory():
        await clock.advance(59)
        assert asked == []
        await clock.advance(2)
        await clock.advance(61)
        assert asked == [0, 0]
    await clock.advance(3600)
    assert asked == [0, 0]


def test_free_memory_returns_to_the_kernel() -> None:
    """Leave holes below a block that lives on. Nothing but asking for it gives these back."""
    program = """
import asyncio
from gateway import memory

def resident_kb():
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("RssAnon"))

async def main():
    memory.keep_large_blocks()
    memory.RETURN_S = 0.01
    blocks = [bytearray(b"x") * 100_000 for _ in range(400)]
    last = bytearray(b"x") * 100_000
    del blocks
    before_kb = resident_kb()
    with memory.returning_free_memory():
        while before_kb - resident_kb() < 20_000:
            await asyncio.sleep(0.01)

asyncio.run(main())
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=TIMEOUT_S)


def test_existing_objects_are_exempt_from_collection():
    program = "from gateway.memory import exempt_from_collection as f; import gc; f()"
    frozen = subprocess.run(
        [sys.executable, "-c", f"{program}; print(gc.get_freeze_count())"],
        capture_output=True,
        check=True,
        text=True,
    )
    assert int(frozen.stdout) > 1000
