# SPDX-License-Identifier: Apache-2.0
"""The page docs/reference/http.md names the answers of the server."""

import json
import re

from gateway.config.model import TAKEN_PATHS
from gateway.fronts.pictures.requests import _IGNORED, _KNOWN
from gateway.transport.counters import _REFUSALS
from gateway.transport.health import _WORST_FIRST
from gateway.transport.http import _PROTOCOL
from tests.doc_blocks import DOCS, texts
from tests.transport.conftest import Serve

PAGE = "reference/http.md"
ROWS = re.findall(r"^\| (.*?) \|", (DOCS / PAGE).read_text("utf-8"), re.MULTILINE)
NAMED = {name for row in ROWS for name in re.findall(r"`([^`]*)`", row)}
VERSION, HEALTH = (json.loads(text) for text in reversed(texts(PAGE, "json")))


def test_the_page_names_all_paths():
    assert {name for name in NAMED if name.startswith("/")} == {*TAKEN_PATHS, "/", "/drive", "/lab"}


def test_the_page_names_all_parameters_of_images():
    parameters = {name for known in _KNOWN.values() for name in known} | set(_IGNORED)
    assert parameters <= NAMED


def test_the_page_names_all_status_codes():
    assert {int(row) for row in ROWS if row.isdigit()} == set(_REFUSALS)


def test_the_example_of_the_version_is_an_answer():
    assert VERSION["protocol"] == _PROTOCOL


async def test_the_page_names_members_of_the_health(serve: Serve):
    async with serve() as served:
        found = set(served.server.health())
    counts = {"messages_in", "refused", "frames_out", "dropped", "coalesced", "replaced"}
    assert counts <= NAMED & found
    assert {*_WORST_FIRST, "ok"} <= NAMED
    assert set(HEALTH) == {"status", "live", "ready", "reasons"}
