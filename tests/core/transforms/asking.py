# SPDX-License-Identifier: Apache-2.0
"""The requests of clients of tf2_web_republisher, and the answers."""

from typing import Any

from tests.core.conftest import Socketless

ACTION = "/tf2_web_republisher"


def request(**more: Any) -> dict[str, Any]:
    """Return the fields of a request for two frames."""
    fields = {"source_frames": ["base_link", "laser"], "target_frame": "odom", "rate": 200}
    return {**fields, "angular_thres": 0.5, "trans_thres": 0.5, **more}


def send_goal(client: Socketless, goal_id: str | None = "goal", **more: Any) -> None:
    client.send(
        op="send_action_goal", id=goal_id, action=ACTION, feedback=True, args=request(**more)
    )


def transforms(client: Socketless) -> list[dict[str, Any]]:
    """Return the arrays in the feedback that a client got."""
    return [frame["values"]["transforms"] for frame in client.of("action_feedback")]


def xs(arrays: list[Any]) -> list[dict[str, float]]:
    """Return the x of the frames in each array."""
    return [
        {each["child_frame_id"]: each["transform"]["translation"]["x"] for each in array}
        for array in arrays
    ]
