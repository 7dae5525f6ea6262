# SPDX-License-Identifier: Apache-2.0
"""Transforms as nodes publish and hear them, whether tf2_msgs is installed or not: as CDR."""

import functools
from collections.abc import Mapping
from typing import Any

from gateway.codec.types import Types
from gateway.sources.rclpy.message_classes import MessageClasses
from gateway.tf import TF_MESSAGE
from schemas.folders import SHIPPED
from schemas.installed import InstalledDefinitions

DEFINITIONS = InstalledDefinitions(folders=[SHIPPED])
_TYPE = Types(DEFINITIONS).get(TF_MESSAGE)


@functools.cache
def tf_message() -> Any:
    """Return the class for raw publishers and subscriptions."""
    classes = MessageClasses(DEFINITIONS)
    classes.allow_made_types()
    return classes.get(TF_MESSAGE)


def to_cdr(*transforms: Mapping[str, Any]) -> bytes:
    """Return what such a publisher publishes."""
    return _TYPE.encode({"transforms": list(transforms)}, 0)


def from_cdr(message: bytes) -> list[Any]:
    """Return the transforms that such a subscription hears."""
    transforms: list[Any] = _TYPE.decode(message)["transforms"]
    return transforms
