# SPDX-License-Identifier: Apache-2.0
import ctypes
import subprocess
import sys
from types import SimpleNamespace

import pytest

from gateway.memory import keep_large_blocks

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


def test_what_exists_is_exempt_from_collection():
    program = "from gateway.memory import exempt_from_collection as f; import gc; f()"
    frozen = subprocess.run(
        [sys.executable, "-c", f"{program}; print(gc.get_freeze_count())"],
        capture_output=True,
        check=True,
        text=True,
    )
    assert int(frozen.stdout) > 1000
