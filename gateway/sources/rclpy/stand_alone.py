# SPDX-License-Identifier: Apache-2.0
"""A node that only publishes, for a process without an event loop."""

import contextlib
from types import TracebackType
from typing import Any

from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from typing_extensions import Self

from gateway.sources.name_checks import check_topic
from gateway.sources.rclpy.creating import create_publisher
from gateway.sources.rclpy.errors import REFUSALS, refused
from gateway.sources.rclpy.interfaces import message_class
from gateway.sources.rclpy.shared_memory import without_shared_memory


class StandAlone:
    """One participant with one node. Nothing spins it. A context manager.

    It has no shared memory. Another process may have been killed with the mutex of a reader's port,
    and what is sent after that would reach the reader a second later.
    """

    def __init__(self, name: str, namespace: str, domain_id: int | None) -> None:
        self._context = Context()
        with without_shared_memory():
            arguments = ["--ros-args", "--disable-stdout-logs", "--disable-external-lib-logs"]
            self._context.init(args=arguments, domain_id=domain_id)
            self._node = Node(
                name,
                context=self._context,
                namespace=namespace,
                enable_rosout=False,
                start_parameter_services=False,
                parameter_overrides=[Parameter("start_type_description_service", value=False)],
            )
        self._publishers: list[Any] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._node.destroy_node()
        self._context.try_shutdown()
        self._context.destroy()

    def advertise(self, topic: str, type_name: str, lifespan_ns: int) -> "StandAlonePublisher":
        """Create a publisher of the newest message on a fully resolved topic name.

        Raises:
            RosError: as for `gateway.sources.source.Publishing.advertise`.
        """
        check_topic(topic)
        found = message_class(type_name)
        # not by `gateway.sources.rclpy.profile`: its imports take as long as all the others
        newest = QoSProfile(
            reliability=ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.VOLATILE,
            history=HistoryPolicy.KEEP_LAST,
            depth=1,
            lifespan=Duration(nanoseconds=lifespan_ns),
        )
        publisher = create_publisher(self._node, f"topic {topic}", topic, found, newest)
        self._publishers.append(publisher)
        return StandAlonePublisher(self, publisher)

    def readers(self, topic: str) -> set[str]:
        """Return the ids of the subscriptions to a topic.

        See `gateway.sources.source.Publishing.readers`.
        """
        # not by `gateway.sources.rclpy.graph`, as above
        infos = self._node.get_subscriptions_info_by_topic(topic)
        return {bytes(each.endpoint_gid).hex() for each in infos}

    is_cut_off = False  # DDS has no router in between

    def moves(self, _: str) -> None:
        """Do nothing."""

    def flush(self, timeout_s: float) -> None:
        """Wait until reliable readers have what was published, at most for a time."""
        for publisher in self._publishers:
            with contextlib.suppress(*REFUSALS):
                publisher.wait_for_all_acked(Duration(seconds=timeout_s))

    def destroy(self, publisher: Any) -> None:
        """Destroy a publisher."""
        self._publishers.remove(publisher)
        self._node.destroy_publisher(publisher)


class StandAlonePublisher:
    """A publisher of raw samples. See `gateway.sources.source.Publisher`."""

    def __init__(self, owner: StandAlone, publisher: Any) -> None:
        self._owner = owner
        self._publisher = publisher

    def publish(self, cdr: bytes) -> None:
        """Publish one sample, encapsulation header included."""
        try:
            self._publisher.publish(cdr)
        except REFUSALS as error:
            raise refused(f"topic {self._publisher.topic_name}", error) from error

    @property
    def is_acknowledged(self) -> bool:
        """Return whether all matched reliable readers have what was published last.

        Expired samples count as well. True where the middleware cannot tell.
        """
        try:
            return bool(self._publisher.wait_for_all_acked(Duration(seconds=0)))
        except REFUSALS:
            return True

    def close(self) -> None:
        """Destroy it."""
        self._owner.destroy(self._publisher)
