# SPDX-License-Identifier: Apache-2.0
"""Conversion of rclpy's exceptions to the port's."""

import contextlib
import logging
import warnings
from collections.abc import Iterator
from typing import Final

from rclpy.exceptions import (
    NameValidationException,
    NotInitializedException,
    NoTypeSupportImportedException,
)

from gateway.sources.rclpy import fast_dds
from gateway.sources.rclpy.rclpy_private.handles import RESPONSE_TIMED_OUT
from gateway.sources.source import RosError

# RCLError and its kin are RuntimeErrors. A class without type support raises an AttributeError, a
# number that C does not hold a ValueError or an OverflowError. A limit of the process, such as its
# number of descriptors, raises an OSError.
REFUSALS: Final = (
    RuntimeError,
    ValueError,
    OverflowError,
    OSError,
    AttributeError,
    NameValidationException,
    NotInitializedException,
    NoTypeSupportImportedException,
)

_logger = logging.getLogger(__name__)


def refused(subject: str, error: Exception) -> RosError:
    """Return the port's exception for one of `REFUSALS`. Its text begins with *subject*."""
    if isinstance(error, NameValidationException):
        return RosError("bad_name", f"{subject}: {error}")
    reason = str(error).split(", at ")[0]  # rcl's tail names its source files
    return RosError("internal", f"{subject}: {reason or type(error).__name__}")


@contextlib.contextmanager
def refusals(subject: str) -> Iterator[None]:
    """Turn what rclpy raises within into what the port raises."""
    try:
        yield
    except REFUSALS as error:
        raise refused(subject, error) from error


@contextlib.contextmanager
def creation(subject: str) -> Iterator[None]:
    """Do so for the creation of an entity, which may leave an error behind in rmw."""
    with refusals(subject):
        yield
    fast_dds.forget_error()


@contextlib.contextmanager
def losses(subject: str) -> Iterator[list[warnings.WarningMessage]]:
    """Drop a response that cannot be sent because rmw finds that its client has gone.

    rclpy raises then, or warns if rmw has waited 0.1 s for the client. The list that is yielded
    holds that warning afterwards.
    """
    with warnings.catch_warnings(record=True) as waits:
        warnings.filterwarnings("always", RESPONSE_TIMED_OUT, RuntimeWarning)
        try:
            yield waits
        except RuntimeError as error:  # RCLError
            _logger.info("%s", refused(subject, error))


def remapped(subject: str, given: str) -> RosError:
    """Return the refusal of a name that ROS arguments of this process turn into another."""
    other = given.partition("/_action/")[0]  # an action's parts are remapped one by one
    return RosError("bad_name", f"{subject} is remapped to {other} here, ask for {other}")
