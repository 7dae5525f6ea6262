# SPDX-License-Identifier: Apache-2.0
"""Recordings of the real rmw_zenoh. See tests/data/rmw_zenoh/README.md."""

import json
from functools import cache
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parents[2] / "data/rmw_zenoh"
NAMES = sorted(path.stem for path in FOLDER.glob("*.jsonl"))


@cache
def recording(name: str) -> list[dict[str, Any]]:
    """Return the lines of one recording."""
    lines = (FOLDER / f"{name}.jsonl").read_text("utf-8").splitlines()
    return [json.loads(line) for line in lines]


def of_robot(name: str, kind: str) -> list[dict[str, Any]]:
    """Return what the ROS nodes did, without what Zenoh's library does for them."""
    return [
        line
        for line in recording(name)
        if (line["kind"], line["by"]) == (kind, "real") and "/@adv/" not in (line["key"] or "")
    ]


def tokens(name: str) -> list[str]:
    """Return the tokens of ROS nodes and their endpoints."""
    return [line["key"] for line in of_robot(name, "token_put")]
