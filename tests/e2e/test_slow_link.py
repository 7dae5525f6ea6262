# SPDX-License-Identifier: Apache-2.0
"""A link that is too slow for odometry and pictures, between two network namespaces."""

import contextlib
import json
import subprocess
import sys
from itertools import pairwise

import pytest

from benchmarks.receivers import publishing
from benchmarks.servers import MeasuredServer
from benchmarks.two_networks import reason_against, two_networks
from tests.client import TIMEOUT_S

PICTURES = 25

pytestmark = pytest.mark.skipif(reason_against() is not None, reason=str(reason_against()))


# a short queue drops packets on this machine, which the kernel counts as sent all the same
@pytest.mark.parametrize(("bits_per_s", "queue_ms"), [(400_000, 1000), (2_000_000, 100)])
def test_a_slow_link_carries_odometry_in_order_and_pictures_that_fit_it(
    bits_per_s: int, queue_ms: int, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("benchmarks.two_networks._ROUTERS_QUEUE_MS", queue_ms)
    with contextlib.ExitStack() as stack:
        networks = stack.enter_context(two_networks())
        networks.shape(bits_per_s)
        for name, rate_hz in (("odometry", 50.0), ("image", 15.0)):
            stack.enter_context(publishing(name, rate_hz, before=networks.near))
        server = MeasuredServer().running_in(networks.near, networks.url_host)
        url, _ = stack.enter_context(server)
        client = (sys.executable, "-m", "tests.e2e.far_client", url, str(PICTURES))
        done = subprocess.run(
            [*networks.far, *client],
            capture_output=True,
            text=True,
            check=False,
            timeout=TIMEOUT_S,
        )
    assert not done.returncode, done.stderr
    frames = [json.loads(line) for line in done.stdout.splitlines()]
    pictures = [frame for frame in frames if frame["width"] is not None]
    odometry = [frame for frame in frames if frame["width"] is None]
    assert (pictures[0]["width"], pictures[0]["quality"]) == (640, 80)
    assert (pictures[-1]["width"], pictures[-1]["quality"]) < (640, 80)
    assert len(odometry) > len(pictures)
    # missing messages were dropped, and are counted
    for one, next_one in pairwise(odometry):
        lost = next_one["dropped"] - one["dropped"]
        assert next_one["seq"] - one["seq"] - 1 == lost >= 0
    assert (odometry[-1]["dropped"] > 0) or bits_per_s > 400_000
