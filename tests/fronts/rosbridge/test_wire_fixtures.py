# SPDX-License-Identifier: Apache-2.0
"""Every byte on rosbridge's wire, as it was recorded.

If you change the wire on purpose, run `python -m tests.fronts.rosbridge.wire_fixtures --write`. It
writes the recordings again, and their difference shows the change.
"""

import json
import re
from pathlib import Path

import pytest

from gateway.fronts.rosbridge.operations import OPERATIONS
from tests.fronts.rosbridge.wire_fixtures.stage import FILES, replay
from tests.fronts.rosbridge.wire_fixtures.text import comparable


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_each_client_gets_the_bytes_that_were_recorded(file: Path) -> None:
    recorded = file.read_text()
    assert comparable(replay(recorded)).split("\n") == comparable(recorded).split("\n")


def test_every_operation_is_recorded_and_refused() -> None:
    text = "\n".join(file.read_text() for file in FILES)
    sent = set(re.findall(r'^\w+>.*?"op":"(\w+)"', text, re.MULTILINE))
    assert sent >= set(OPERATIONS)
    frames = [
        json.loads(frame) for frame in re.findall(r"^\w+< (\{[^␊\n]*\})$", text, re.MULTILINE)
    ]
    refused = {frame.get("request") for frame in frames if frame["op"] == "status"}
    failed = {frame["op"] for frame in frames if frame.get("result") is False}
    assert failed >= {"service_response", "action_result"}  # the refusals of these two
    assert refused >= set(OPERATIONS) - {"call_service", "send_action_goal"}
