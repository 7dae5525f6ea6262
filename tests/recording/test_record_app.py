# SPDX-License-Identifier: Apache-2.0
"""The end of ``ros2-gateway record``."""

import asyncio
import contextlib
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from gateway import record_app
from gateway.config.model import Config
from gateway.recording.active_recording import RecordingPlan, RecordingStatus
from gateway.recording.recorder import Recorder
from tests.core.conftest import Bench, bench  # noqa: F401  # a fixture


async def test_a_look_between_the_last_byte_and_its_report_is_harmless(
    bench: Bench,  # noqa: F811
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
):
    stop = asyncio.Event()
    held: list[Recorder] = []
    on_state = Recorder._on_state

    @contextlib.asynccontextmanager
    async def source(*_: object) -> AsyncIterator[object]:
        yield bench.ros

    def hold_the_last(recorder: Recorder) -> None:
        held.append(recorder)
        if recorder.status().state != "stopped":
            on_state(recorder)

    def show(status: RecordingStatus) -> None:
        if status.state == "recording":
            stop.set()
        if status.state == "stopped":
            asyncio.get_running_loop().call_soon(on_state, held[-1])

    monkeypatch.setattr(record_app, "open_source", source)
    monkeypatch.setattr(record_app, "PROGRESS_S", 0.01)
    monkeypatch.setattr(record_app, "_handle_signals", lambda _: stop)
    monkeypatch.setattr(Recorder, "_on_state", hold_the_last)
    config = Config.model_validate({"recording": {"directory": str(tmp_path), "min_free_bytes": 0}})
    plan = RecordingPlan()
    status = await record_app._record(config, plan, show, was_interrupted=lambda: False)
    assert (status.state, status.why) == ("stopped", "")
