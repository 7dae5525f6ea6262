# SPDX-License-Identifier: Apache-2.0
"""Test processes keep out of each other's DDS domains, and of a robot's."""

import contextlib
import os
import subprocess
import sys

from tests import dds_domain
from tests.client import TIMEOUT_S
from tests.sources.outside import Outside

OWN = int(os.environ["ROS_DOMAIN_ID"])


def printed(code: str) -> list[int]:
    """Run a program in another process, and return the numbers that it prints."""
    code = f"import os, socket\nfrom tests import dds_domain\n{code}"
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, check=True, capture_output=True, timeout=TIMEOUT_S)
    return [int(word) for word in done.stdout.split()]


def begin_with(domain: int | str) -> str:
    return f"os.getpid = lambda: dds_domain.DOMAINS.index({domain})\n"


def test_a_domain_is_claimed_once() -> None:
    claimed = printed("print(*(dds_domain.claim() for _ in range(5)))")
    assert len({*claimed, OWN}) == 6


def test_a_claim_ends_with_its_process() -> None:
    (claimed,) = printed("print(dds_domain.claim())")
    assert printed(f"{begin_with(claimed)}print(dds_domain.claim())") == [claimed]


def test_a_domain_where_others_are_is_not_claimed() -> None:
    taken, claimed = printed(
        "robot = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)\n"
        "number = next(n for n in dds_domain.DOMAINS if not dds_domain._is_in_use(n))\n"
        "robot.bind(('', 7410 + 250 * number))\n"
        f"{begin_with('number')}print(number, dds_domain.claim())"
    )
    assert claimed != taken


def test_a_participant_of_a_domain_is_seen() -> None:
    with contextlib.closing(Outside()):
        assert dds_domain._is_in_use(OWN)
