# SPDX-License-Identifier: Apache-2.0
"""A recorder over the fake ROS."""

import contextlib
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from gateway.access.audit import Audit
from gateway.access.permissions import UNLIMITED
from gateway.config.recording import RecordingConfig
from gateway.recording.active_recording import RecordingPlan
from gateway.recording.recorder import Recorder
from tests.client import eventually
from tests.core.conftest import Bench, bench  # noqa: F401  # a fixture


@dataclass
class Studio:
    """A recorder, and the robot that it records."""

    bench: Bench
    recorder: Recorder
    audit: Audit

    async def start(self, **plan: Any) -> Path:
        """Begin to record, and return the directory."""
        self.recorder.start(RecordingPlan(**plan))
        await eventually(lambda: self.recorder.status().state != "starting")
        path = self.recorder.status().path
        assert path is not None
        return path

    async def stop(self, **options: Any) -> None:
        """End the recording, with all that the robot has published."""
        await self.bench.settle()
        self.recorder.stop(UNLIMITED, **options)
        await eventually(lambda: not self.recorder.is_recording)


MakeStudio = Callable[..., Studio]


@pytest.fixture
def make_studio(bench: Bench, tmp_path: Path) -> Iterator[MakeStudio]:  # noqa: F811
    """Return a function that makes a recorder with settings."""
    with contextlib.ExitStack() as stack:

        def make(**settings: Any) -> Studio:
            # the disk of a test may be nearly full
            config = RecordingConfig(**{"min_free_bytes": 0, **settings})
            audit = Audit(time.time_ns)
            recorder = Recorder(bench.router, bench.types, tmp_path, config, audit)
            stack.callback(recorder.close, 60)
            return Studio(bench, recorder, audit)

        yield make


@pytest.fixture
def studio(make_studio: MakeStudio) -> Studio:
    return make_studio()
