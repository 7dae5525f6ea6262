# SPDX-License-Identifier: Apache-2.0
"""Translation of rclpy's exceptions."""

import warnings

import pytest

from gateway.sources.rclpy.errors import losses, refusals
from gateway.sources.source import RosError


def test_a_refusal_names_its_subject_and_not_the_source_of_rcl() -> None:
    with pytest.raises(RosError, match=r"^topic /a: no room$"), refusals("topic /a"):
        raise RuntimeError("no room, at ./src/rcl/publisher.c:12")


def test_an_exception_that_is_not_a_refusal_is_let_through() -> None:
    with pytest.raises(LookupError), refusals("topic /a"):
        raise LookupError


def test_a_refusal_without_words_has_its_kind() -> None:
    with pytest.raises(RosError, match="starting ROS: OSError"), refusals("starting ROS"):
        raise OSError


def test_a_response_that_rmw_cannot_send_is_lost() -> None:
    with losses("service /arm"):
        raise RuntimeError("failed to send response")


def test_a_response_whose_client_rmw_has_waited_for_is_lost() -> None:
    with losses("service /arm"):
        warnings.warn("failed to send response (timeout): gone", RuntimeWarning, stacklevel=1)


def test_another_warning_or_exception_is_not_lost_with_a_response() -> None:
    with pytest.raises(RuntimeWarning, match="another"), losses("service /arm"):
        warnings.warn("another", RuntimeWarning, stacklevel=1)
    with pytest.raises(LookupError), losses("service /arm"):
        raise LookupError
