# SPDX-License-Identifier: Apache-2.0
"""The dispatcher: it gives each request of a client to the part that carries it out."""

import contextlib
import logging
import time
from collections.abc import Awaitable, Callable, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial
from typing import Any, Final, Protocol, TypeVar

from typing_extensions import assert_never

from gateway.access.audit import Audit
from gateway.codec.types import Types
from gateway.config.control import ControlConfig
from gateway.config.limits import Limits
from gateway.core import requests
from gateway.core.actions.client_actions import ClientActions
from gateway.core.actions.goals import Goals
from gateway.core.commands.commands import Commands
from gateway.core.commands.interface import CommandTopics, OpenCommands
from gateway.core.deadline import Deadline
from gateway.core.entity_shares import EntityShares
from gateway.core.errors import ProtocolError
from gateway.core.interface_types import InterfaceTypes
from gateway.core.introspection.descriptions import Descriptions
from gateway.core.introspection.introspection import Introspection, seen_by
from gateway.core.learned_types import LearnedTypes
from gateway.core.names import resolve_topic
from gateway.core.permission_checks import may_carry_out
from gateway.core.requests import AnyRequest, ImageFormat, Request
from gateway.core.role_views import RoleViews
from gateway.core.service_clients import ServiceClients
from gateway.core.services.client_services import ClientServices
from gateway.core.services.service_calls import ServiceCalls
from gateway.core.session import Session
from gateway.core.tasks import ASKING_S, FAILURES, Tasks, refuse
from gateway.core.topic_counts import CountsByTopic
from gateway.core.topic_events import TopicEvents
from gateway.core.topic_types import TopicTypes
from gateway.core.topics.publications import Publications
from gateway.core.topics.published_pictures import PublishedPictures
from gateway.core.topics.subscription import TopicKey
from gateway.core.topics.subscriptions import Subscriptions
from gateway.core.transforms.lookups import TransformLookups
from gateway.core.transforms.republications import Republications
from gateway.core.transforms.tf_listener import TfListener
from gateway.metrics.state import ControlState, Traffic
from gateway.sources.graph import Graph
from gateway.sources.source import Qos, Ros
from schemas.table import Table


class SessionOwner(Protocol):
    """A part of the router with state for each session."""

    def leave(self, session: Session) -> None:
        """Close and forget everything of a client in this part."""


_Asked = TypeVar("_Asked", bound=Request)


class RequestedRecorder(SessionOwner, Protocol):
    """The part that makes recordings. It stands above the core."""

    def carry_out(self, session: Session, request: requests.Record) -> None:
        """Carry out a request."""


class Router:
    """Shares ROS entities between many sessions, and answers every request.

    Lives on the event loop's thread. Give it the requests of each client, in order. `leave` ends
    everything of a client.
    """

    def __init__(  # noqa: PLR0913  # one argument for each part that it shares
        self,
        ros: Ros,
        types: Types,
        table: Table,
        *,
        limits: Limits,
        workers: Executor,
        version: str,
        audit: Audit | None = None,
        control: ControlConfig | None = None,
        image_format: ImageFormat = "jpeg",
        open_commands: OpenCommands | None = None,
    ) -> None:
        self._service_clients = ServiceClients(ros)
        self._learned = LearnedTypes(ros, types.definitions, self._on_types_learned)
        topic_types = TopicTypes(ros, types, table, self._learned.ask)
        interface_types = InterfaceTypes(ros, types)
        self.ros = ros
        self.limits: Final = limits
        self.image_format: Final = image_format
        self._audit = audit or Audit(time.time_ns, level=logging.DEBUG)
        self._counts = CountsByTopic()
        self._events = TopicEvents()
        self._sessions: set[Session] = set()
        self._calling = Tasks()
        # with separate limits: a call may take an hour, a lookup a minute
        self._asking = Tasks()
        self._looking = Tasks()
        self._views = RoleViews(ros, types, self._service_clients)
        self._subscriptions = Subscriptions(ros, topic_types, workers, self._counts, self._events)
        watched = (ros.publishing.guard, self._audit, self._counts, self._events)
        here = partial(Commands, ros, control or ControlConfig(), *watched)
        self.commands: Final[CommandTopics] = (open_commands or here)(topic_types)
        offering = (self.commands, self._counts, self._events)
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
        self.republications = Republications(self._listener)
        self._of_fronts: list[SessionOwner] = []
        self._recorder: RequestedRecorder | None = None
        descriptions = Descriptions(topic_types, interface_types, types.definitions)
        self.introspection = Introspection(
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

    def join(self, part: SessionOwner) -> None:
        """Let a part of a front forget each session that leaves."""
        self._of_fronts.append(part)

    def join_recorder(self, recorder: RequestedRecorder) -> None:
        """Let a recorder, which is a client of the core, carry out the requests about it."""
        self._recorder = recorder
        self.join(recorder)

    def enter(self, session: Session) -> None:
        """Take in a client that a front has opened a session for."""
        self._shares.enter(session, session.address)
        self._sessions.add(session)

    def carry_out(self, session: Session, request: AnyRequest) -> None:
        """Carry out a request of a client. Every error is answered."""
        if session.deferred and not isinstance(request, requests.Publish):
            self.end_turn(session)
        try:
            if not session.is_restricted or may_carry_out(session, request):
                self._carry_out(session, request)
        except FAILURES as error:
            refuse(session, request, error)

    def permit(self, session: Session, request: Request, work: Callable[[], None]) -> None:
        """Let a front carry out a request itself. Every error is answered.

        It may answer with transforms: a request that needs a permission needs that for these.
        """
        if session.deferred and not isinstance(request, requests.Publish):
            self.end_turn(session)
        try:
            if not session.is_restricted or may_carry_out(session, request, is_of_tf=True):
                work()
        except FAILURES as error:
            refuse(session, request, error)

    def view(self, session: Session, request: requests.Subscribe) -> str:
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
                self.record_forbidden(session, error, request)
                raise
        # by one name, so that all who look at it share its pictures
        self._subscriptions.view(session, replace(request, topic=name))
        return name

    def graph_seen_by(self, session: Session) -> Graph:
        """Return the graph without the names that are hidden from a client."""
        return seen_by(session, self.ros.graph())

    def check_share(self, session: Session) -> None:
        """Raise ProtocolError if a client may not have one more ROS entity."""
        self._shares.check(session)

    def is_driven_by(self, session: Session) -> bool:
        """Return whether a client has control of a command topic."""
        return self.commands.is_driven_by(session)

    def record_forbidden(self, session: Session, error: ProtocolError, request: Request) -> None:
        """Note what the role of a client forbids. See `Core` of `gateway.core.session`."""
        if session.identity is not None:  # else it has not authenticated yet
            self._audit.record(
                "forbidden",
                client=session.client,
                name=session.identity.name,
                role=session.identity.role,
                address=session.address,
                op=request.kind,
                reason=str(error),
            )

    def end_turn(self, session: Session) -> None:
        """Do what the operations of a client deferred until others have their turn."""
        for request, work in session.take_deferred():
            try:
                work()
            except FAILURES as error:
                refuse(session, request, error)

    def leave(self, session: Session) -> None:
        """Close every ROS entity of a client, and forget the client."""
        self._sessions.discard(session)
        self._shares.leave(session)
        with contextlib.ExitStack() as parts:  # each leaves, whatever another raises
            for part in self._parts():
                parts.callback(part.leave, session)

    def revoke(self, session: Session) -> None:
        """End everything of a client that may not go on. That is why its robot stops."""
        self.commands.revoke(session)
        self.leave(session)

    def stop_robots(self) -> None:
        """Stop whatever moves, before anything else of a shutdown. From now on nothing moves."""
        self.commands.shut_down()

    def close(self) -> None:
        """Stop robots, end all sessions and stop following the graph."""
        self.commands.close()
        self._watch.close()
        for session in list(self._sessions):
            self.leave(session)
        self._transforms.close()
        self._listener.close()
        self._goals.close()
        self.introspection.close()
        self._learned.close()
        self._service_clients.close()

    def traffic(self) -> Traffic:
        """Return the counts of all topics and clients, which belong together."""
        client_topics = tuple(self._subscriptions.client_topics())
        publications = (
            *self._publications.client_publications(),
            *self.commands.client_publications(),
        )
        topics = tuple(self._counts.states(client_topics, publications))
        return Traffic(client_topics, publications, topics)

    def offers(self, topic: TopicKey) -> Sequence[Qos]:
        """Return what the publishers of a topic that has subscribers offer."""
        return self._subscriptions.offers(topic)

    def control(self) -> ControlState:
        """Return the state of the command topics and of their guard."""
        return self.commands.control_state()

    def counts(self) -> dict[str, int]:
        """Count the open sessions and entities, for health reports."""
        return {
            "clients": len(self._sessions),
            "ros_entities": self.ros.diagnosis.entity_count() - self.introspection.own_entities,
            "subscriptions": self._subscriptions.topics,
            "publishers": self._publications.publishers + self.commands.publishers,
            "services": self._services.services,
            "action_servers": self._actions.servers,
            "service_clients": self._service_clients.clients,
            "action_clients": self._goals.clients,
            "calls": sum(map(len, (self._calling, self._asking, self._looking)))
            + self._services.pending,
            "goals": self._goals.under_way + self._actions.pending,
            "transforms": self._transforms.periodic + len(self.republications),
        }

    # as long as there are requests: one case each
    def _carry_out(  # noqa: C901, PLR0912, PLR0915
        self, session: Session, request: AnyRequest
    ) -> None:
        match request:
            case requests.Publish():
                self._publications.publish(session, request)
            case requests.Subscribe():
                self._subscriptions.subscribe(session, request)
            case requests.Unsubscribe():
                self._subscriptions.unsubscribe(session, request)
            case requests.Advertise():
                self._publications.advertise(session, request)
            case requests.Unadvertise():
                self._publications.unadvertise(session, request)
            case requests.CallService():
                self._service_calls.call(session, request)
            case requests.AdvertiseService():
                self._services.advertise(session, request)
            case requests.UnadvertiseService():
                self._services.unadvertise(session, request)
            case requests.ServiceResponse():
                self._services.respond(session, request)
            case requests.SendActionGoal():
                self._goals.send(session, request)
            case requests.CancelActionGoal():
                self._goals.cancel(session, request)
            case requests.AdvertiseAction():
                self._actions.advertise(session, request)
            case requests.UnadvertiseAction():
                self._actions.unadvertise(session, request)
            case requests.ActionFeedback():
                self._actions.feedback(session, request)
            case requests.ActionResult():
                self._actions.finish(session, request)
            case requests.ParameterRequest():
                self._ask_node(session, request)
            case requests.LookupTransform(rate=None):
                self._answer_later(session, request, self._transforms.lookup, self._looking)
            case requests.LookupTransform():
                self._transforms.watch(session, request)
            case requests.CancelTransform():
                self._transforms.cancel(session, request)
            case requests.Stop():
                self.commands.stop(session, request)
            case requests.AcquireControl():
                self.commands.acquire(session, request)
            case requests.ReleaseControl():
                self.commands.release(session, request)
            case requests.Control():
                self.commands.control(session, request)
            case requests.Ping():
                self.introspection.ping(session, request)
            case requests.Hello():
                self.introspection.hello(session, request)
            case requests.Describe():
                self.introspection.describe(session, request)
            case requests.Generate():
                self._generate(session, request)
            case requests.FetchAsset():
                self._answer_later(session, request, self.introspection.fetch, self._asking)
            case requests.GraphRequest():
                self.introspection.graph(session, request)
            case requests.Events():
                self._events.watch(session, request)
            case requests.Record():
                if self._recorder is None:
                    raise ProtocolError("not_found", "this gateway has no recorder")
                self._recorder.carry_out(session, request)
            case _:
                assert_never(request)

    def _ask_node(self, session: Session, request: requests.ParameterRequest) -> None:
        work = self._views.of(session).parameters.carry_out
        self._answer_later(session, request, work, self._asking)

    def _generate(self, session: Session, request: requests.Generate) -> None:
        write = partial(self.introspection.generate, session)
        self._answer_later(session, request, write, self._asking)

    def _parts(self) -> tuple[SessionOwner, ...]:
        return (
            self._calling,
            self._asking,
            self._looking,
            self.introspection,
            self._events,
            self._transforms,
            self.republications,
            *self._of_fronts,
            self._subscriptions,
            self._publications,
            self._services,
            self._goals,
            self._actions,
            self.commands,  # the last one leaves first
        )

    def _answer_later(
        self,
        session: Session,
        request: _Asked,
        work: Callable[[_Asked], Awaitable[dict[str, Any]]],
        tasks: Tasks,
    ) -> None:
        async def answer() -> None:
            session.answer(request.kind, request.id, **await work(request))

        tasks.start(session, request, answer, Deadline.within(ASKING_S))

    def _on_types_learned(self) -> None:
        self._subscriptions.refresh()
        self._publications.refresh()

    def _on_graph_change(self) -> None:
        self._learned.on_graph_change()
        self._subscriptions.refresh()
        self.commands.on_graph_change()
        self.introspection.on_graph_change()
