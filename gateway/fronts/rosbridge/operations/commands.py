# SPDX-License-Identifier: Apache-2.0
"""Moving a robot: stop, control of a command topic, its state."""

from gateway.core import requests
from gateway.fronts.rosbridge.operations.base import Operation


class Stop(Operation):
    """Stop one command topic, or without a name all of them. Any client may."""

    op = "stop"
    makes = requests.Stop
    topic: str | None = None


class AcquireControl(Operation):
    """Take control of a command topic, also from another client. It is stopped first."""

    op = "acquire_control"
    makes = requests.AcquireControl
    topic: str | None = None


class ReleaseControl(Operation):
    """Give control back. A robot that moves is stopped."""

    op = "release_control"
    makes = requests.ReleaseControl
    topic: str | None = None


class Control(Operation):
    """Ask for the state of a command topic.

    Once or, with ``watch: true``, with all later changes. ``watch: false`` ends these.
    """

    op = "control"
    makes = requests.Control
    topic: str | None = None
    watch: bool | None = None
