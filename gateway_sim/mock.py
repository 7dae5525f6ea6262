# SPDX-License-Identifier: Apache-2.0
"""The mock system: a node that publishes every type and listens to every type.

It publishes made-up messages (`gateway_sim.content`) below ``/mock``, and writes each message that
arrives below ``/mock_in`` as one line of text.
"""

import re
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

from rclpy.context import Context
from rclpy.node import Node

from gateway.errors import ConfigError
from gateway_sim.content import Inventor
from gateway_sim.instances import Builder, message_class, one_line
from gateway_sim.loop import Loop, ros_context, stopped_by_signals
from schemas.installed import InstalledDefinitions
from schemas.table import Table, TypeNameError, resolve_type

MAX_RATE_HZ: Final = 1000.0  # far above the rate that 180 types reach, to catch typing errors
_TICK_NS: Final = (
    10_000_000  # publishing in bursts of 10 ms saves wake-ups, and the delay does not matter
)
_DEPTH: Final = 100  # samples: a test's burst of one second waits and is not lost
_WORD_START: Final = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=.)(?=[A-Z][a-z])")


@dataclass(frozen=True, slots=True)
class MockOptions:
    """The options of the mock system.

    Raises:
        ConfigError: a value is out of its range, or a type is unknown.
    """

    rate_hz: float = 1.0  # of each type
    types: tuple[str | int, ...] = ()  # names or numbers, all types if empty
    publish: bool = True
    listen: bool = True
    write: Callable[[str], None] = print  # gets a line for each message that arrives

    def __post_init__(self) -> None:
        if not 0 < self.rate_hz <= MAX_RATE_HZ:
            raise ConfigError(f"rate_hz {self.rate_hz:g} is not above 0 and up to 1000 Hz")
        self.type_names()

    def type_names(self) -> tuple[str, ...]:
        """Return the types as ``pkg/msg/Name``, each once."""
        table = Table.load()
        if not self.types:
            return tuple(row.name for row in table.rows)
        try:
            return tuple(dict.fromkeys(resolve_type(requested, table) for requested in self.types))
        except TypeNameError as error:
            raise ConfigError(str(error)) from error


def run(options: MockOptions) -> int:
    """Run the mock system until SIGINT or SIGTERM, and return the exit code 0.

    Raises:
        ConfigError: a type that the options name is not installed.
    """
    stop = threading.Event()
    with stopped_by_signals(stop), ros_context() as context:
        mock = MockSystem(context, options)
        try:
            mock.loop.run(stop)
        finally:
            mock.close()
    return 0


def topic_of(type_name: str, prefix: str) -> str:
    """Return the mock system's topic for a type: ``/mock/std_msgs/u_int8`` for ``UInt8``.

    The name has the form of rosidl's header names.
    """
    package, _, name = type_name.split("/")
    return f"{prefix}/{package}/{_WORD_START.sub('_', name).lower()}"


class MockSystem:
    """The node ``mock_system``. Everything happens on the thread that runs ``loop``.

    Without types in the options, types whose packages are not installed are left out, with a
    warning in the log.
    """

    def __init__(self, context: Context, options: MockOptions) -> None:
        """Create the node.

        Raises:
            ConfigError: a type that the options name is not installed.
        """
        definitions = InstalledDefinitions()
        self._inventor = Inventor(definitions)
        self._builder = Builder(definitions)
        self._write = options.write
        classes, missing = _message_classes(options.type_names())
        if missing and options.types:
            raise ConfigError(*missing)
        self._node = Node("mock_system", context=context)
        self.loop = Loop(context)
        for problem in missing:
            self._node.get_logger().warning(f"left out: {problem}")
        self._names = tuple(classes)
        if options.listen:
            for name, cls in classes.items():
                self._listen(name, cls)
        self._publishers = [
            self._node.create_publisher(cls, topic_of(name, "/mock"), _DEPTH)
            for name, cls in classes.items()
            if options.publish
        ]
        self._published = 0
        self._start_ns = time.monotonic_ns()
        self._interval_ns = 1e9 / (options.rate_hz * max(1, len(classes)))
        if self._publishers:
            self.loop.every(_TICK_NS, self._publish_due)
        self.loop.add_node(self._node)
        doing = [
            f"publishing at {options.rate_hz:g} Hz below /mock" if options.publish else "",
            "listening below /mock_in" if options.listen else "",
        ]
        count = "1 type" if len(classes) == 1 else f"{len(classes)} types"
        self._node.get_logger().info(f"{count}: {', '.join(filter(None, doing))}")

    def close(self) -> None:
        """Take the node off the graph."""
        self.loop.close()
        self._node.destroy_node()

    def _listen(self, name: str, cls: Any) -> None:
        topic = topic_of(name, "/mock_in")

        def written(message: Any) -> None:
            self._write(f"{topic} {name} {one_line(message)}")

        self._node.create_subscription(cls, topic, written, _DEPTH)

    def _publish_due(self) -> None:
        """Publish the types in turn, evenly over time, and skip those late by a whole period."""
        due = int((time.monotonic_ns() - self._start_ns) / self._interval_ns)
        for index in range(max(self._published, due - len(self._names)), due):
            counter, position = divmod(index, len(self._names))
            publisher = self._publishers[position]
            if publisher.get_subscription_count() > 0:
                name = self._names[position]
                values = self._inventor.values(name, counter, time.time_ns())
                publisher.publish(self._builder.build(name, values))
        self._published = max(self._published, due)


def _message_classes(names: Sequence[str]) -> tuple[dict[str, Any], list[str]]:
    """Return the classes by type, and an error text for each type that is not installed."""
    classes: dict[str, Any] = {}
    missing = []
    for name in names:
        try:
            classes[name] = message_class(name)
        except ImportError as error:
            missing.append(f"{name} is not installed: {error}")
    return classes, missing
