# SPDX-License-Identifier: Apache-2.0
"""Publishers and actions of types that need no package, as those of tf2_msgs, which PyPI lacks.

They take values by field name, and send CDR, so the gateway's codec and the types that it makes
from definitions are all they need.
"""

import asyncio
import contextlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile

from gateway.codec.cdr import Decoder, Encoder, compile_decoder, compile_encoder
from gateway.sources.rclpy import fast_dds
from gateway.sources.rclpy.action_forms import ActionForm
from gateway.sources.rclpy.message_classes import MessageClasses, why_types_cannot_be_made
from gateway.sources.source import RosError
from schemas.definition import Definition
from schemas.folders import SHIPPED
from schemas.installed import InstalledDefinitions

_SLICE_S: Final = 0.002  # of the caller's time for each look at the test


class MissingTypeError(Exception):
    """Raised if a type is not installed and cannot be made. The text says why."""


class ValuePublisher:
    """Publishes values of one type."""

    def __init__(self, publisher: Publisher, encode: Encoder) -> None:
        self._publisher = publisher
        self._encode = encode

    def has_subscribers(self) -> bool:
        """Return whether there are subscribers."""
        return bool(self._publisher.get_subscription_count())

    def publish(self, values: Mapping[str, Any]) -> None:
        """Publish values by field name. Fields that are left out are 0 or empty."""
        self._publisher.publish(self._encode(values, 0))


@dataclass(frozen=True, slots=True)
class AnyAction:
    """An action type. Fields that its definition here lacks are left out."""

    form: ActionForm
    read_goal: Decoder  # raises a ValueError for bytes that are not CDR of the type
    write_result: Callable[[Mapping[str, Any]], bytes]
    write_feedback: Callable[[Mapping[str, Any]], bytes]


class AnyTypes:
    """Creates publishers and actions of some types, once `poll` returns true.

    That is at once if all of them are installed. Otherwise a separate process first tries for a
    second whether this ROS accepts made types. See `gateway.sources.rclpy.message_classes`.
    """

    def __init__(self, type_names: Sequence[str]) -> None:
        self._definitions = InstalledDefinitions(folders=[SHIPPED])
        self._classes = MessageClasses(self._definitions)
        self._trial: _Trial | None = None
        try:
            for name in type_names:
                self._find(name)
        except RosError:
            self._trial = _Trial()

    def poll(self) -> bool:
        """Return whether they can be created. If not, ask again a few milliseconds later."""
        if self._trial is None:
            return True
        if not self._trial.has_ended():
            return False
        self._classes.allow_made_types(self._trial.why_not())
        self.close()
        return True

    def publisher(
        self, node: Node, type_name: str, topic: str, qos: QoSProfile | int
    ) -> ValuePublisher:
        """Create a publisher, which ends with its node.

        Raises:
            MissingTypeError: the type is not installed, and cannot be made here.
        """
        try:
            message_class = self._classes.get(type_name)
        except RosError as error:
            raise MissingTypeError(str(error)) from error
        encode = compile_encoder(self._definitions.get(type_name), self._definitions)
        publisher = node.create_publisher(message_class, topic, qos)
        fast_dds.forget_error()
        return ValuePublisher(publisher, encode)

    def action(self, type_name: str) -> AnyAction:
        """Return an action type, ``pkg/action/Name``.

        Raises:
            MissingTypeError: the type is not installed, and cannot be made here.
        """
        try:
            form = self._classes.action(type_name)
        except RosError as error:
            raise MissingTypeError(str(error)) from error
        parts = self._definitions.interface(type_name, "action").parts
        return AnyAction(
            form,
            compile_decoder(parts["goal"], self._definitions),
            self._writer(parts["result"]),
            self._writer(parts["feedback"]),
        )

    def _writer(self, definition: Definition) -> Callable[[Mapping[str, Any]], bytes]:
        encode = compile_encoder(definition, self._definitions)
        names = {each.name for each in definition.fields}
        return lambda values: encode({k: v for k, v in values.items() if k in names}, 0)

    def _find(self, type_name: str) -> object:
        if "/action/" in type_name:
            return self._classes.action(type_name)
        return self._classes.get(type_name)

    def close(self) -> None:
        """End the process that tries, if there is one."""
        if self._trial is not None:
            self._trial.close()
            self._trial = None


class _Trial:
    """An asyncio task that goes on while it is asked about, on the caller's thread."""

    def __init__(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._task = why_types_cannot_be_made(self._loop)

    def has_ended(self) -> bool:
        self._loop.run_until_complete(asyncio.wait({self._task}, timeout=_SLICE_S))
        return self._task.done()

    def why_not(self) -> str | None:
        return self._task.result()

    def close(self) -> None:
        self._task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            self._loop.run_until_complete(self._task)
        self._loop.close()
