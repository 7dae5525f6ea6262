# SPDX-License-Identifier: Apache-2.0
"""Recordings that clients start."""

import json
from collections.abc import Callable
from typing import Any

import pytest

from gateway.access.permissions import Identity, Policy
from gateway.config.access import AccessConfig, AnyRole, OperatorConfig
from gateway.recording.record_requests import RecordRequests
from tests.client import Frame, eventually
from tests.core.conftest import STRING, Bench, Socketless
from tests.recording.conftest import MakeStudio, Studio
from tests.recording.readers import EVENTS, by_all, decoded

Client = Callable[..., Socketless]


def identity(role: AnyRole, **config: Any) -> Identity:
    return Identity(f"the {role}", Policy(AccessConfig(**config)).of(role))


@pytest.fixture
def served(studio: Studio) -> Studio:
    """A recorder that clients reach."""
    RecordRequests(studio.bench.router, studio.recorder)
    return studio


async def answer(client: Socketless, **request: Any) -> Frame:
    """Send a request, and return its answer, which may take a file."""
    before = len(client.frames)
    client.send(op="record", **request)
    await eventually(lambda: len(client.frames) > before)
    return client.frames[-1]


async def test_a_client_records(served: Studio):
    client = served.bench.client()
    served.bench.ros.add_publisher("/chatter", STRING)
    started = await answer(client, id=1, action="start", topics=["/chatter"], task="pick")
    assert (started["id"], started["state"], started["episode"]) == (1, "recording", 0)
    served.bench.say("/chatter", "x", "y")
    await served.bench.settle()
    assert (await answer(client, id=2, action="mark", text="now"))["id"] == 2
    stopped = await answer(client, id=3, action="stop", success=True)
    assert (stopped["id"], stopped["action"], stopped["state"]) == (3, "stop", "stopped")
    folder = served.recorder.status().path
    assert folder is not None
    assert (stopped["recording"], stopped["topics"]) == (folder.name, 1)
    assert len(by_all(folder)["/chatter"]) == 2
    assert stopped["bytes"] > 500
    (mark,) = (each for each in events(served) if each["event"] == "mark")
    assert (mark["text"], mark["name"], mark["role"]) == ("now", "anonymous", "admin")


def events(studio: Studio) -> list[dict[str, Any]]:
    folder = studio.recorder.status().path
    assert folder is not None
    return [json.loads(each.data) for each in decoded(folder)[EVENTS]]


async def test_a_recording_outlives_its_client(served: Studio):
    first, second = served.bench.client(), served.bench.client()
    served.bench.ros.add_publisher("/chatter", STRING)
    await answer(first, action="start")
    served.bench.router.leave(first.session)
    refused = await answer(second, action="start")
    assert (refused["code"], refused["level"]) == ("limit_exceeded", "error")
    assert "is under way: stop it first" in refused["msg"]
    served.bench.say("/chatter", "x")
    await served.bench.settle()
    assert (await answer(second, action="stop"))["topics"] == 1


async def test_a_role_needs_the_permission_to_record(bench: Bench, served: Studio):
    viewer = bench.client(identity=identity("viewer"))
    for action in ("start", "stop", "mark"):
        refused = await answer(viewer, action=action)
        text = "recording requires role operator or admin, and this client is viewer"
        assert (refused["code"], refused["msg"]) == ("forbidden", text)
    assert (await answer(viewer, action="status"))["state"] == "stopped"
    page = bench.client(identity=identity("page"))
    assert (await answer(page, action="start"))["code"] == "forbidden"
    forbidding = OperatorConfig(record=False)
    operator = bench.client(identity=identity("operator", operator=forbidding))
    assert "requires role admin" in (await answer(operator, action="start"))["msg"]
    operator = bench.client(identity=identity("operator"))
    assert (await answer(operator, action="start"))["state"] == "recording"


async def test_watchers_hear_of_each_change_and_of_progress(served: Studio):
    watcher, client = served.bench.client(), served.bench.client()
    await answer(watcher, id="w", action="status", watch=True)
    await answer(client, action="start")
    await eventually(lambda: len(watcher.of("record")) > 3)  # without a change
    await answer(client, action="stop")
    await eventually(lambda: watcher.frames[-1]["state"] == "stopped")
    assert {frame["id"] for frame in watcher.of("record")} == {"w"}
    await answer(watcher, action="status", watch=False)
    seen = len(watcher.frames)
    await answer(client, action="start")
    assert len(watcher.frames) == seen


async def test_a_full_disk_is_reported_to_all(make_studio: MakeStudio):
    studio = make_studio(min_free_bytes=10**18, min_free_share=1)
    RecordRequests(studio.bench.router, studio.recorder)
    client = studio.bench.client()
    refused = await answer(client, id=7, action="start")
    assert (refused["id"], refused["code"]) == (7, "internal")
    assert "the disk has" in refused["msg"]
    assert "delete old recordings, or lower recording.min_free_share" in refused["msg"]
    state = await answer(client, action="status")
    assert state["state"] == "stopped"
    assert "the disk has" in state["why"]
    (fault,) = studio.recorder.faults()
    assert fault.severity == "degraded"
    assert "the recording has ended: the disk has" in fault.text


async def test_the_starter_hears_of_an_end_that_nobody_asked_for(
    served: Studio, monkeypatch: pytest.MonkeyPatch
):
    client = served.bench.client()
    served.bench.ros.add_publisher("/chatter", STRING)
    await answer(client, id=1, action="start")
    monkeypatch.setattr("gateway.recording.writer.why_full", lambda *_: "no room: make some")
    served.bench.say("/chatter", "x")
    await eventually(lambda: bool(client.of("status")))
    (told,) = client.of("status")
    assert told["msg"] == "the recording has ended: no room: make some"
    assert not served.recorder.is_recording
    assert (await answer(client, action="stop"))["code"] == "not_found"
    monkeypatch.undo()
    assert (await answer(client, action="start"))["state"] == "recording"
    assert served.recorder.faults() == ()


async def test_without_a_recorder_recording_is_refused(bench: Bench):
    client = bench.client()
    assert (await answer(client))["msg"] == "this gateway has no recorder"
