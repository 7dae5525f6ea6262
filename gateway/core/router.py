# SPDX-License-Identifier: Apache-2.0
"""The dispatcher: it gives each operation of a client to the part that carries it out."""

import contextlib
import logging
import time
from collections.abc import Awaitable, Callable, Sequence
from concurrent.futures import Executor
from functools import partial
from typing import Any, Final, Protocol, TypeVar, assert_never, cast

from gateway.access.audit import Audit
from gateway.access.permissions import UNLIMITED, Identity
from gateway.codec.types import Types
from gateway.config.control import ControlConfig
from gateway.config.limits import Limits
from gateway.core.actions.client_actions import ClientActions
from gateway.core.actions.goals import Goals
from gateway.core.commands.commands import Commands
from gateway.core.deadline import Deadline
from gateway.core.entity_shares import EntityShares
from gateway.core.errors import ProtocolError
from gateway.core.interface_types import InterfaceTypes
from gateway.core.introspection.descriptions import Descriptions
from gateway.core.introspection.introspection import Introspection
from gateway.core.large_messages import LargeMessages
from gateway.core.learned_types import LearnedTypes
from gateway.core.missing_parts import complete
from gateway.core.names import resolve_topic
from gateway.core.permission_checks import may_carry_out
from gateway.core.role_views import RoleViews
from gateway.core.service_clients import ServiceClients
from gateway.core.services.client_services import ClientServices
from gateway.core.services.service_calls import ServiceCalls
from gateway.core.tasks import ASKING_S, FAILURES, Tasks, refuse
from gateway.core.topic_counts import CountsByTopic
from gateway.core.topic_events import TopicEvents
from gateway.core.topic_types import TopicTypes
from gateway.core.topics.publications import Publications
from gateway.core.topics.published_pictures import PublishedPictures
from gateway.core.topics.subscriptions import Subscriptions
from gateway.core.transforms.lookups import TransformLookups
from gateway.core.transforms.republisher import TfRepublisher
from gateway.core.transforms.tf_listener import TfListener
from gateway.fronts.rosbridge.operations import (
    ClientOperation,
    actions,
    commands,
    gateway,
    parameters,
    services,
    topics,
    transforms,
)
from gateway.fronts.rosbridge.operations.base import Operation
from gateway.fronts.rosbridge.operations.topics import ImageFormat
from gateway.fronts.rosbridge.session import Session
from gateway.metrics.state import ControlState, Traffic
from gateway.sources.source import Source
from schemas.table import Table

# To read 10 MB of text takes up to 16 ms, as 15 KB of CBOR do. To carry it out may take as long.
LARGE_MESSAGE_BYTES: Final = 8 * 1024


class SessionOwner(Protocol):
    """A part of the router with state for each session."""

    def leave(self, session: Session) -> None:
        """Close and forget everything of a client in this part."""


_Operation = TypeVar("_Operation", bound=ClientOperation)


class Router:
    """Shares ROS entities between many sessions, and answers every operation.

    Lives on the event loop's thread. Give it the messages of each client, in order. `leave` ends
    everything of a client.
    """

    def __init__(  # noqa: PLR0913  # one argument for each part that it shares
        self,
        source: Source,
        types: Types,
        table: Table,
        *,
        limits: Limits,
        workers: Executor,
        version: str,
        audit: Audit | None = None,
        control: ControlConfig | None = None,
        image_format: ImageFormat = "jpeg",
        asks_nodes: bool = True,
    ) -> None:
        ros = complete(source)
        self._service_clients = ServiceClients(ros)
        self._learned = LearnedTypes(
            ros, types, self._service_clients, self._on_types_learned, asks_nodes=asks_nodes
        )
        topic_types = TopicTypes(ros, types, table, self._learned.ask)
        interface_types = InterfaceTypes(ros, types)
        self._ros = ros
        self._limits = limits
        self._image_format = image_format
        self._audit = audit or Audit(time.time_ns, level=logging.DEBUG)
        self._counts = CountsByTopic()
        self._events = TopicEvents()
        self._sessions: set[Session] = set()
        self._large = LargeMessages(self._carry_out_if_allowed)
        self._calling = Tasks()
        # with separate limits: a call may take an hour, a lookup a minute
        self._asking = Tasks()
        self._looking = Tasks()
        self._views = RoleViews(ros, types, self._service_clients)
        self._subscriptions = Subscriptions(ros, topic_types, workers, self._counts, self._events)
        watched = (ros.publishing.guard, self._audit, self._counts, self._events)
        self._commands = Commands(ros, topic_types, control or ControlConfig(), *watched)
        offering = (self._commands, self._counts, self._events)
        pictures = PublishedPictures(ros, topic_types, workers)
        self._publications = Publications(ros, topic_types, *offering, pictures)
        self._service_calls = ServiceCalls(
            interface_types,
            self._service_clients,
            lambda session: self._views.of(session).rosapi,
            calling=self._calling,
            asking=self._asking,
        )
        self._services = ClientServices(ros, interface_types, self._views.unlimited.rosapi.has)
        self._goals = Goals(ros, interface_types)
        self._actions = ClientActions(ros, interface_types)
        self._listener = TfListener(ros, topic_types)
        self._transforms = TransformLookups(self._listener)
        self._republisher = TfRepublisher(ros, self._listener)
        descriptions = Descriptions(topic_types, interface_types, types.definitions)
        self._introspection = Introspection(
            ros, descriptions, self._subscriptions, limits=limits, version=version
        )
        using = (
            self._subscriptions,
            self._publications,
            self._services,
            self._goals,
            self._actions,
        )
        self._shares = EntityShares(limits, using)
        self._watch = ros.watch_graph(self._on_graph_change)

    def enter(
        self,
        wake: Callable[[], None],
        address: str = "",
        identity: Identity | None = UNLIMITED,
    ) -> Session:
        """Open a session. It calls *wake* whenever its outbox has something to send.

        *identity* is ``None`` for a client that has yet to authenticate.
        """
        session = Session(self._limits, wake, identity)
        session.address = address
        session.image_format = self._image_format
        session.check_share = partial(self._shares.check, session)
        session.drives = partial(self._commands.is_driven_by, session)
        session.on_forbidden = partial(self._record_forbidden, session)
        self._shares.enter(session, address)
        self._sessions.add(session)
        return session

    def receive(self, session: Session, data: bytes) -> None:
        """Carry out one message of a client. Every error is answered."""
        operation = session.receive(data, time.monotonic_ns())
        if operation is None:
            return
        if session.read_bytes > LARGE_MESSAGE_BYTES:
            self._large.receive(session, operation)
        else:  # which is not read in slices
            self._carry_out_if_allowed(session, cast("ClientOperation", operation))

    def _carry_out_if_allowed(self, session: Session, operation: ClientOperation) -> None:
        if session.deferred and not isinstance(operation, topics.Publish):
            self.end_turn(session)
        try:
            work = self._republisher.work(session, operation)
            is_of_tf = work is not None
            if not session.is_restricted or may_carry_out(session, operation, is_of_tf=is_of_tf):
                if work is None:
                    self._carry_out(session, operation)
                else:
                    work()
        except FAILURES as error:
            refuse(session, operation, error)

    def view(self, session: Session, request: topics.Subscribe) -> str:
        """Subscribe a viewer of pictures, and return the resolved name of its topic.

        It hears of errors at once, and waits for no topic.

        Raises:
            ProtocolError: it is refused, and nothing has changed.
            RosError: ROS refuses it, and nothing has changed.
        """
        name = resolve_topic(request.topic, session.limits.max_name_characters)
        if session.sees(name):  # else it is absent, and nothing is forbidden
            try:
                may_carry_out(session, request)
            except ProtocolError as error:
                session.on_forbidden(error, request)
                raise
        # by one name, so that all who look at it share its pictures
        self._subscriptions.view(session, request.model_copy(update={"topic": name}))
        return name

    def end_turn(self, session: Session) -> None:
        """Do what the operations of a client deferred until others have their turn."""
        deferred, session.deferred = session.deferred, {}
        for operation, work in deferred.values():
            try:
                work()
            except FAILURES as error:
                refuse(session, operation, error)

    def leave(self, session: Session) -> None:
        """Close every ROS entity of a client, and forget the client."""
        self._sessions.discard(session)
        self._shares.leave(session)
        with contextlib.ExitStack() as parts:  # each leaves, whatever another raises
            for part in self._parts():
                parts.callback(part.leave, session)

    def revoke(self, session: Session) -> None:
        """End everything of a client that may not go on. That is why its robot stops."""
        self._commands.revoke(session)
        self.leave(session)

    def stop_robots(self) -> None:
        """Stop whatever moves, before anything else of a shutdown. From now on nothing moves."""
        self._commands.shut_down()

    def close(self) -> None:
        """Stop robots, end all sessions and stop following the graph."""
        self._commands.close()
        self._watch.close()
        for session in list(self._sessions):
            self.leave(session)
        self._transforms.close()
        self._listener.close()
        self._goals.close()
        self._introspection.close()
        self._learned.close()
        self._service_clients.close()

    def traffic(self) -> Traffic:
        """Return the counts of all topics and clients, which belong together."""
        client_topics = tuple(self._subscriptions.client_topics())
        publications = (
            *self._publications.client_publications(),
            *self._commands.client_publications(),
        )
        topics = tuple(self._counts.states(client_topics, publications))
        return Traffic(client_topics, publications, topics)

    def control(self) -> ControlState:
        """Return the state of the command topics and of their guard."""
        return self._commands.control_state()

    def shared_names(self) -> Sequence[str]:
        """Return the names that several nodes of the graph have."""
        return self._ros.diagnosis.shared_names()

    def counts(self) -> dict[str, int]:
        """Count the open sessions and entities, for health reports."""
        return {
            "clients": len(self._sessions),
            "ros_entities": self._ros.diagnosis.entity_count(),
            "subscriptions": self._subscriptions.topics,
            "publishers": self._publications.publishers + self._commands.publishers,
            "services": self._services.services,
            "action_servers": self._actions.servers,
            "service_clients": self._service_clients.clients,
            "action_clients": self._goals.clients,
            "calls": sum(map(len, (self._calling, self._asking, self._looking)))
            + self._services.pending,
            "goals": self._goals.under_way + self._actions.pending,
            "transforms": self._transforms.periodic + self._republisher.arrays,
        }

    # as long as there are operations: one case each
    def _carry_out(  # noqa: C901, PLR0912, PLR0915
        self, session: Session, operation: ClientOperation
    ) -> None:
        match operation:
            case topics.Publish():
                self._publications.publish(session, operation)
            case topics.Subscribe():
                self._subscriptions.subscribe(session, operation)
            case topics.Unsubscribe():
                self._subscriptions.unsubscribe(session, operation)
            case topics.Advertise():
                self._publications.advertise(session, operation)
            case topics.Unadvertise():
                self._publications.unadvertise(session, operation)
            case services.CallService():
                self._service_calls.call(session, operation)
            case services.AdvertiseService():
                self._services.advertise(session, operation)
            case services.UnadvertiseService():
                self._services.unadvertise(session, operation)
            case services.ServiceResponse():
                self._services.respond(session, operation)
            case actions.SendActionGoal():
                self._goals.send(session, operation)
            case actions.CancelActionGoal():
                self._goals.cancel(session, operation)
            case actions.AdvertiseAction():
                self._actions.advertise(session, operation)
            case actions.UnadvertiseAction():
                self._actions.unadvertise(session, operation)
            case actions.ActionFeedback():
                self._actions.feedback(session, operation)
            case actions.ActionResult():
                self._actions.finish(session, operation)
            case (
                parameters.ListParameters()
                | parameters.GetParameters()
                | parameters.SetParameters()
                | parameters.DescribeParameters()
            ):
                self._ask_node(session, operation)
            case transforms.LookupTransform(rate=None):
                self._answer_later(session, operation, self._transforms.lookup, self._looking)
            case transforms.LookupTransform():
                self._transforms.watch(session, operation)
            case transforms.CancelTransform():
                self._transforms.cancel(session, operation)
            case commands.Stop():
                self._commands.stop(session, operation)
            case commands.AcquireControl():
                self._commands.acquire(session, operation)
            case commands.ReleaseControl():
                self._commands.release(session, operation)
            case commands.Control():
                self._commands.control(session, operation)
            case gateway.Ping():
                self._introspection.ping(session, operation)
            case gateway.Hello():
                self._introspection.hello(session, operation)
            case gateway.Help():
                self._introspection.help(session, operation)
            case gateway.Describe():
                self._introspection.describe(session, operation)
            case gateway.Generate():
                self._generate(session, operation)
            case gateway.FetchAsset():
                self._answer_later(session, operation, self._introspection.fetch, self._asking)
            case gateway.GraphRequest():
                self._introspection.graph(session, operation)
            case gateway.Events():
                self._events.watch(session, operation)
            case gateway.SetLevel():
                session.set_level(operation.level)
            case gateway.Auth():
                session.authenticate(operation)
            case _:
                assert_never(operation)

    def _ask_node(self, session: Session, operation: parameters.ParameterOperation) -> None:
        work = self._views.of(session).parameters.carry_out
        self._answer_later(session, operation, work, self._asking)

    def _generate(self, session: Session, operation: gateway.Generate) -> None:
        write = partial(self._introspection.generate, session)
        self._answer_later(session, operation, write, self._asking)

    def _parts(self) -> tuple[SessionOwner, ...]:
        return (
            self._calling,
            self._asking,
            self._looking,
            self._introspection,
            self._events,
            self._transforms,
            self._republisher,
            self._subscriptions,
            self._publications,
            self._services,
            self._goals,
            self._actions,
            self._commands,  # the last one leaves first
        )

    def _record_forbidden(
        self, session: Session, error: ProtocolError, operation: Operation
    ) -> None:
        if session.identity is not None:  # else it is still at the door
            self._audit.record(
                "forbidden",
                client=session.client,
                name=session.identity.name,
                role=session.identity.role,
                address=session.address,
                op=operation.op,
                reason=str(error),
            )

    def _answer_later(
        self,
        session: Session,
        operation: _Operation,
        work: Callable[[_Operation], Awaitable[dict[str, Any]]],
        tasks: Tasks,
    ) -> None:
        async def answer() -> None:
            session.answer(operation.op, operation.id, **await work(operation))

        tasks.start(session, operation, answer, Deadline.within(ASKING_S))

    def _on_types_learned(self) -> None:
        self._subscriptions.refresh()
        self._publications.refresh()

    def _on_graph_change(self) -> None:
        self._learned.on_graph_change()
        self._subscriptions.refresh()
        self._commands.on_graph_change()
        self._introspection.on_graph_change()
