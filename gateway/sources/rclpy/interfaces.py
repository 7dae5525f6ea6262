# SPDX-License-Identifier: Apache-2.0
"""Import of the classes that ROS packages generate for their types."""

import importlib
import importlib.util
from operator import attrgetter
from pathlib import Path
from typing import Any, Final

from gateway.sources.name_checks import TypeKind, split_type
from gateway.sources.source import RosError
from schemas.interface import EVENT, FEEDBACK_MESSAGE, GET_RESULT, SEND_GOAL

# The places in rclpy of the classes that rosidl derives for topics.
_DERIVED: Final = {
    EVENT: "Event",
    FEEDBACK_MESSAGE: "Impl.FeedbackMessage",
    SEND_GOAL + EVENT: "Impl.SendGoalService.Event",
    GET_RESULT + EVENT: "Impl.GetResultService.Event",
}


def message_class(type_name: str) -> type:
    """Import the class of ``pkg/msg/Name``, or of what topics of services and actions have.

    Raises:
        RosError: ``bad_type``: the name is malformed, or no ROS package here has that message.
    """
    interface, separator, part = type_name.rpartition("/")[2].partition("_")
    place = _DERIVED.get(separator + part)
    if place is None:
        return _find_class(type_name, "msg")
    kind: TypeKind = "srv" if "/srv/" in type_name else "action"
    whole = _find_class(f"{type_name.rpartition('/')[0]}/{interface}", kind)
    try:
        found: type = attrgetter(place)(whole)
    except AttributeError as error:  # ROS before Iron has no events
        raise RosError("bad_type", f"no ROS package here has {type_name}") from error
    return found


def service_class(type_name: str) -> Any:
    """Import the class of ``pkg/srv/Name``, which has a ``Request`` and a ``Response``.

    Raises:
        RosError: ``bad_type``, as for `message_class`.
    """
    return _find_class(type_name, "srv")


def action_class(type_name: str) -> Any:
    """Import the class of ``pkg/action/Name``, whose ``Impl`` has its services and messages.

    Raises:
        RosError: ``bad_type``, as for `message_class`.
    """
    return _find_class(type_name, "action")


def _find_class(type_name: str, kind: TypeKind) -> type:
    package, name = split_type(type_name, kind)
    if not _is_ros_package(package, kind):
        raise RosError("bad_type", f"no ROS package {package} is installed here ({type_name})")
    try:
        found = getattr(importlib.import_module(f"{package}.{kind}"), name, None)
    except ImportError as error:
        raise RosError("bad_type", f"package {package} cannot be imported: {error}") from error
    if not isinstance(found, type):
        raise RosError("bad_type", f"no ROS package here has {type_name}; {package} has no {name}")
    return found


def _is_ros_package(package: str, kind: TypeKind) -> bool:
    """Return, without importing it, whether a package was generated from ROS interfaces.

    A client chooses the name: importing any package it likes would run that package's code.
    """
    try:
        spec = importlib.util.find_spec(package)
    except (ImportError, ValueError):  # ValueError: a module without a spec, such as __main__
        return False
    folders = [Path(folder) for folder in (spec and spec.submodule_search_locations) or ()]
    return any(
        (folder / kind).is_dir() and any(folder.glob(f"{package}_s__rosidl_typesupport_c*"))
        for folder in folders
    )
