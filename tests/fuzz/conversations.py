# SPDX-License-Identifier: Apache-2.0
"""Operations of several clients in any order, and the answers that the gateway must give.

The model knows what each client has open, so it knows which operations are refused and by which
codes. It does not know the ROS graph, which follows later. If the graph decides, several outcomes
are right. Every operation is answered once, and nothing stays behind.
"""

import json
from collections import Counter
from functools import cache
from typing import Any, ClassVar, cast, get_args

from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, precondition, rule

from gateway.core.errors import StatusCode
from tests.client import Frame
from tests.fuzz import vocabulary as words
from tests.fuzz.speaker import Speaker
from tests.fuzz.stage import SETTINGS, Stage
from tests.fuzz.target import check
from tests.fuzz.vocabulary import Said

MAX_CLIENTS = 3
CODES = frozenset(get_args(StatusCode)) - {"internal"}
# of what ROS refuses: two types on one topic, no room for one more
OF_ROS = frozenset({"type_conflict", "limit_exceeded", "bad_type"})
ANSWER_OF_ROS = {"call_service": "service_response", "send_action_goal": "action_result"}
SETBOOL, FIBONACCI = "std_srvs/SetBool", "test_msgs/Fibonacci"


BOMBS = cache(words.bombs)


class Client:
    """One client, and what the model knows of it."""

    def __init__(self, speaker: Speaker) -> None:
        self.speaker = speaker
        self.subscriptions: set[tuple[str, Any]] = set()
        self.advertised: set[tuple[str, Any]] = set()
        self.services: set[str] = set()
        self.actions: set[str] = set()
        self.later: Counter[tuple[str, Any]] = Counter()  # answers that are still to come
        self.seen = 0

    def news(self) -> list[Frame]:
        """Return the frames that came since the last time."""
        found, self.seen = self.speaker.frames[self.seen :], len(self.speaker.frames)
        return found

    def requests(self, op: str) -> list[Frame]:
        """Return what the gateway has asked this client."""
        return [frame for frame in self.speaker.frames if frame["op"] == op and "id" in frame]


class Conversations(RuleBasedStateMachine):
    """The rules. A subclass has the stage."""

    stage: ClassVar[Stage]
    exchanges: ClassVar[int] = 0  # in all of this process

    def __init__(self) -> None:
        super().__init__()
        self.clients: list[Client] = []
        self.wild: Client | None = None
        self.count = 0

    @initialize()
    def begin(self) -> None:
        self.connect()

    # Coming and going

    @precondition(lambda self: len(self.clients) < MAX_CLIENTS)
    @rule()
    def connect(self) -> None:
        self.clients.append(Client(self.stage.open()))

    @precondition(lambda self: len(self.clients) > 1)
    @rule(who=words.numbers)
    def vanish(self, who: int) -> None:
        client = self.of(who)
        self.stage.run(client.speaker.cut())
        self.clients.remove(client)

    @precondition(lambda self: len(self.clients) > 1)
    @rule(who=words.numbers)
    def leave(self, who: int) -> None:
        client = self.of(who)
        self.stage.run(client.speaker.leave())
        check(client.speaker.close_code == 1000, client.speaker.close_code)
        self.clients.remove(client)

    @rule(who=words.numbers, broken=words.pick(words.BROKEN_WIRE))
    def break_the_wire(self, who: int, broken: tuple[bytes, frozenset[int]]) -> None:
        """Send bytes that are not WebSocket. The connection ends as documented."""
        client = self.of(who)
        data, codes = broken
        speaker = client.speaker
        # past the library, which would not send it
        self.stage.run(calling(lambda: speaker.socket.transport.write(data)))
        self.stage.run(speaker.until(lambda: speaker.close_code is not None))
        check(speaker.close_code in codes, data, speaker.close_code)
        self.clients.remove(client)
        if not self.clients:
            self.connect()

    # Topics

    @rule(
        who=words.numbers,
        topic=words.pick(words.NAMES),
        request_id=words.pick(words.IDS),
        options=st.lists(words.pick(words.SUBSCRIBING), max_size=3),
    )
    def subscribe(self, who: int, topic: str, request_id: Any, options: list[Said]) -> None:
        client = self.of(who)
        operation = {"op": "subscribe", "topic": topic, "type": words.TYPE_OF[topic]}
        for option in options:
            operation |= option.members
        options = [each for each in options if each.is_part_of(operation)]
        codes = frozenset().union(*(each.codes for each in options if each.verdict != "good"))
        key = topic, request_id
        if (
            key not in client.subscriptions
            and len(client.subscriptions) >= SETTINGS["limits.max_subscriptions"]
        ):
            refused = self.say(client, operation, request_id, {*codes, "limit_exceeded"}, must=True)
        else:
            # other subscriptions of the client do not change this answer
            is_cut = "fields" in operation and operation.get("compression") == "cbor-raw"
            is_bad = is_cut or any(each.verdict == "bad" for each in options)
            # together with the others of the topic: image options may not fit an image of these
            more = {*codes, *OF_ROS, "bad_request"}
            refused = self.say(client, operation, request_id, more, must=is_bad)
        if not refused:
            client.subscriptions.add(key)

    @rule(who=words.numbers, topic=words.pick(words.NAMES), request_id=words.pick(words.IDS))
    def unsubscribe(self, who: int, topic: str, request_id: Any) -> None:
        client = self.of(who)
        # a client may have both `words` and `/words`: frames come under each, and both end as one
        ended = {(name, request_id) for name in {topic, f"/{topic.lstrip('/')}", topic.lstrip("/")}}
        is_open = not ended.isdisjoint(client.subscriptions)
        codes = set() if is_open else {"not_found"}
        self.say(client, {"op": "unsubscribe", "topic": topic}, request_id, codes, not is_open)
        client.subscriptions -= ended

    @rule(
        who=words.numbers,
        topic=words.pick(words.NAMES),
        request_id=words.pick(words.IDS),
        more=words.pick([{}, {"latch": True}, {"queue_size": 0}, {"queue_size": 2**62}]),
    )
    def advertise(self, who: int, topic: str, request_id: Any, more: dict[str, Any]) -> None:
        client = self.of(who)
        operation = {"op": "advertise", "topic": topic, "type": words.TYPE_OF[topic], **more}
        if not self.say(client, operation, request_id, {*OF_ROS, "bad_request"}):
            client.advertised.add((resolved(topic), request_id))

    @rule(who=words.numbers, topic=words.pick(words.NAMES), request_id=words.pick(words.IDS))
    def unadvertise(self, who: int, topic: str, request_id: Any) -> None:
        client = self.of(who)
        key = resolved(topic), request_id
        is_open = key in client.advertised
        codes = set() if is_open else {"not_found"}
        self.say(client, {"op": "unadvertise", "topic": topic}, request_id, codes, not is_open)
        client.advertised.discard(key)

    @rule(
        who=words.numbers,
        topic=words.pick(words.NAMES),
        message=words.pick(words.GOOD_MESSAGES),
        more=words.pick([{}, {"latch": True}, {"monotonic_ms": 1e15}]),
    )
    def publish(self, who: int, topic: str, message: Any, more: dict[str, Any]) -> None:
        operation = {"op": "publish", "topic": topic, "msg": message, **more}
        operation["type"] = words.TYPE_OF[topic]
        codes = {*OF_ROS}
        if "String" not in words.TYPE_OF[topic]:
            codes.add("invalid_value")
        self.say(self.of(who), operation, self.new_id(), codes)

    @rule(who=words.numbers, topic=words.pick(words.NAMES), message=words.pick(words.BAD_MESSAGES))
    def publish_what_does_not_fit(self, who: int, topic: str, message: Any) -> None:
        operation = {"op": "publish", "topic": topic, "msg": message, "type": words.TYPE_OF[topic]}
        must = "String" in words.TYPE_OF[topic]
        self.say(self.of(who), operation, self.new_id(), {*OF_ROS, "invalid_value"}, must)

    @rule(
        who=words.numbers,
        message=st.fixed_dictionaries(
            {},
            optional={"linear": st.fixed_dictionaries({"x": words.pick([0, 0.5, 9, None, 1e308])})},
        ),
        stamp=words.pick([None, 0, 1, 1e9]),
    )
    def drive(self, who: int, message: dict[str, Any], stamp: float | None) -> None:
        operation = {"op": "publish", "topic": "/cmd_vel", "type": "geometry_msgs/Twist"}
        codes = {"tripped", "not_lease_holder", "stale_command", "invalid_value", "limit_exceeded"}
        more = {"msg": message, "monotonic_ms": stamp}
        self.say(self.of(who), {**operation, **more}, self.new_id(), codes)

    @rule(topic=words.pick(sorted(words.TOPICS)), number=words.numbers)
    def let_the_robot_publish(self, topic: str, number: int) -> None:
        self.stage.publish(topic, number)

    @rule(
        who=words.numbers,
        op=words.pick(["subscribe", "advertise", "publish", "unsubscribe", "advertise_service"]),
        name=words.pick(words.BAD_NAMES),
    )
    def use_a_bad_name(self, who: int, op: str, name: str) -> None:
        operation = {"op": op, "topic": name, "service": name, "msg": {}, "type": "std_msgs/String"}
        codes = {"bad_name", "not_found", "bad_type"}
        self.say(self.of(who), operation, self.new_id(), codes, must=True)

    # Services

    @rule(
        who=words.numbers,
        service=words.pick(["/arm", "/s0", "/s1", "/nobody", "arm"]),
        args=words.pick(words.CALLS),
        more=words.pick([{}, {"fragment_size": 64}, {"type": "std_srvs/Trigger"}]),
    )
    def call(self, who: int, service: str, args: Any, more: dict[str, Any]) -> None:
        operation = {"op": "call_service", "service": service, "args": args, "timeout": 1, **more}
        self.ask_of_ros(self.of(who), operation)

    @rule(who=words.numbers, timeout=words.pick([words.SILENT_S, 1e-9, -1, "x", 1e300]))
    def call_what_never_answers(self, who: int, timeout: Any) -> None:
        operation = {"op": "call_service", "service": "/silent", "timeout": timeout}
        self.ask_of_ros(self.of(who), operation)

    @rule(who=words.numbers, name=words.pick(words.ROSAPI), args=words.pick(words.ARGUMENTS))
    def call_rosapi(self, who: int, name: str, args: Any) -> None:
        self.ask_of_ros(
            self.of(who), {"op": "call_service", "service": f"/rosapi/{name}", "args": args}
        )

    @rule(who=words.numbers, service=words.pick(["/s0", "/s1"]))
    def advertise_service(self, who: int, service: str) -> None:
        client = self.of(who)
        operation = {"op": "advertise_service", "service": service, "type": SETBOOL}
        if not self.say(client, operation, self.new_id(), OF_ROS):
            for other in self.clients:
                other.services.discard(service)
            client.services.add(service)

    @rule(who=words.numbers, service=words.pick(["/s0", "/s1", "/arm"]))
    def unadvertise_service(self, who: int, service: str) -> None:
        client = self.of(who)
        is_own = service in client.services
        operation = {"op": "unadvertise_service", "service": service}
        codes = set() if is_own else {"not_found"}
        self.say(client, operation, self.new_id(), codes, must=not is_own)
        client.services.discard(service)

    @rule(who=words.numbers, number=words.numbers, answer=words.pick(words.ANSWERS))
    def answer_a_call(self, who: int, number: int, answer: dict[str, Any]) -> None:
        """Answer one of the requests so far, perhaps again, or one that never was."""
        client = self.of(who)
        calls = client.requests("call_service")
        asked = calls[number % len(calls)] if calls else {"service": "/s0", "id": "nothing"}
        operation = {"op": "service_response", "service": asked["service"], **answer}
        codes = {"not_found", "invalid_value", "bad_request"}
        self.say(client, operation, asked["id"], codes, must=not calls)

    # Actions

    @rule(
        who=words.numbers,
        action=words.pick(["/fib", "/a0", "/nothing"]),
        args=words.pick([{"order": 3}, [1], {}, {"order": "x"}, [1, 2], None, {"order": 2**31}]),
        more=words.pick([{}, {"feedback": True}, {"fragment_size": 64, "feedback": True}]),
    )
    def send_goal(self, who: int, action: str, args: Any, more: dict[str, Any]) -> None:
        operation = {"op": "send_action_goal", "action": action, "args": args, **more}
        self.ask_of_ros(self.of(who), operation)

    @rule(who=words.numbers, number=words.numbers)
    def cancel_goal(self, who: int, number: int) -> None:
        client = self.of(who)
        goals = [request_id for op, request_id in client.later if op == "send_action_goal"]
        request_id = goals[number % len(goals)] if goals else "nothing"
        operation = {"op": "cancel_action_goal", "action": "/a0"}
        self.say(client, operation, request_id, {"not_found"}, must=not goals)

    @rule(who=words.numbers)
    def advertise_action(self, who: int) -> None:
        client = self.of(who)
        operation = {"op": "advertise_action", "action": "/a0", "type": FIBONACCI}
        if not self.say(client, operation, self.new_id(), OF_ROS):
            for other in self.clients:
                other.actions.clear()
            client.actions.add("/a0")

    @rule(who=words.numbers)
    def unadvertise_action(self, who: int) -> None:
        client = self.of(who)
        is_own = bool(client.actions)
        operation = {"op": "unadvertise_action", "action": "/a0"}
        codes = set() if is_own else {"not_found"}
        self.say(client, operation, self.new_id(), codes, must=not is_own)
        client.actions.clear()

    @rule(
        who=words.numbers,
        op=words.pick(["action_result", "action_feedback"]),
        number=words.numbers,
        result=words.pick(words.RESULTS),
    )
    def answer_a_goal(self, who: int, op: str, number: int, result: dict[str, Any]) -> None:
        client = self.of(who)
        goals = client.requests("send_action_goal")
        goal_id = goals[number % len(goals)]["id"] if goals else "nothing"
        codes = {"not_found", "invalid_value", "bad_request"}
        operation = {"op": op, "action": "/a0", **result}
        self.say(client, operation, goal_id, codes, must=not goals)

    # All else

    @rule(who=words.numbers, asked=words.pick(words.ASKED))
    def ask(self, who: int, asked: tuple[dict[str, Any], str, frozenset[str]]) -> None:
        operation, answer, codes = asked
        client, request_id = self.of(who), self.new_id()
        news = self.exchange(client, {**operation, "id": request_id})
        answers = [
            frame
            for frame in news
            if frame.get("id") == request_id
            and (frame["op"] == answer or frame.get("level") == "error")
        ]
        check(answers, "not answered", operation)
        refusals = [frame for frame in answers if frame["op"] == "status"]
        check(all(frame["code"] in codes for frame in refusals), operation, refusals)
        if answer == "pong" and not refusals:
            check(answers[0].get("value") == operation["value"], operation, answers)

    @rule(who=words.numbers, operation=words.pick(words.ASKED_OF_NODES))
    def ask_a_node(self, who: int, operation: dict[str, Any]) -> None:
        self.ask_of_ros(self.of(who), operation)

    @rule(who=words.numbers, level=words.pick(["warning", "info", "none?", 3]))
    def set_level(self, who: int, level: Any) -> None:
        is_known = level in {"warning", "info"}
        operation = {"op": "set_level", "level": level}
        codes = set() if is_known else {"bad_request"}
        self.say(self.of(who), operation, self.new_id(), codes, must=not is_known)

    @rule(who=words.numbers, garbage=words.pick(words.GARBAGE))
    def send_garbage(self, who: int, garbage: str | bytes) -> None:
        client = self.of(who)
        news = self.exchange(client, garbage)
        late = {request_id for _, request_id in client.later}  # may be refused in the meantime
        errors = (frame for frame in news if frame.get("level") == "error")
        codes = {frame.get("code") for frame in errors if frame.get("id") not in late}
        check(codes, "garbage was not answered", garbage[:100])
        check(codes <= {"bad_json", "bad_request", "unknown_op", "limit_exceeded"}, codes)

    @rule(
        who=words.numbers,
        order=st.permutations(range(4)),
        left_out=words.pick([None, None, 0, 3]),
        is_binary=st.booleans(),
    )
    def send_in_pieces(
        self, who: int, order: list[int], left_out: int | None, is_binary: bool
    ) -> None:
        """Send a message in pieces. Without one of them nothing happens until it is too late."""
        client, request_id = self.of(who), self.new_id()
        text = json.dumps({"op": "ping", "id": request_id, "value": "grüße"})
        size = -(-len(text) // 4)
        # the same id: a message that is never complete takes one of four places
        fragment_id = f"pieces {request_id}" if left_out is None else "incomplete"
        pieces = [
            {"op": "fragment", "id": fragment_id, "num": number, "total": 4}
            | {"data": text[number * size : (number + 1) * size]}
            for number in order
            if number != left_out
        ]
        encoded = [json.dumps(piece) for piece in pieces]
        news = self.exchange(client, *(each.encode() if is_binary else each for each in encoded))
        pongs = [frame for frame in news if frame.get("id") == request_id]
        check(len(pongs) == (left_out is None), pieces, pongs)

    @rule(who=words.numbers)
    def ping_the_socket(self, who: int) -> None:
        async def ping() -> None:
            await (await self.of(who).speaker.socket.ping())

        self.stage.run(ping())

    # One client of which the model knows nothing

    @rule(op=words.pick(words.operations), seed=words.numbers)
    def say_what_is_nearly_right(self, op: str, seed: int) -> None:
        self.say_wildly(words.nearly_right(op, seed))

    @rule(text=words.extremes)
    def say_extreme_numbers(self, text: str) -> None:
        self.say_wildly(text)

    @rule(number=words.numbers)
    def send_what_takes_most(self, number: int) -> None:
        frames = BOMBS()
        self.say_wildly(frames[number % len(frames)].data)

    @rule(operation=words.pick(words.ASKED_FOR_ARRAYS), request_id=words.pick([None, *words.IDS]))
    def ask_for_arrays(self, operation: dict[str, Any], request_id: Any) -> None:
        self.say_wildly({**operation, "id": request_id})

    def say_wildly(self, said: dict[str, Any] | str | bytes) -> None:
        """Send what may open anything, or nothing. It is answered by codes that are documented."""
        if self.wild is None:
            self.wild = Client(self.stage.open())
        self.exchange(self.wild, said)

    # The model

    def of(self, number: int) -> Client:
        return self.clients[number % len(self.clients)]

    def new_id(self) -> str:
        self.count += 1
        return f"request {self.count}"

    def exchange(self, client: Client, *sent: dict[str, Any] | str | bytes) -> list[Frame]:
        """Send frames, wait until they are handled, and return all that came."""
        Conversations.exchanges += 1
        speaker = client.speaker
        sync_id = f"sync {self.new_id()}"
        client.news()

        async def send() -> None:
            for each in sent:
                await speaker.say(json.dumps(each) if isinstance(each, dict) else each)
            await speaker.say(json.dumps({"op": "ping", "id": sync_id}))
            await speaker.until(
                lambda: (
                    speaker.close_code is not None
                    or any(frame.get("id") == sync_id for frame in speaker.frames)
                )
            )

        self.stage.run(send())
        check(speaker.close_code is None, "closed", speaker.close_code, str(sent)[:300])
        news = client.news()
        for frame in news:
            if frame["op"] == "status" and "code" in frame:
                check(frame["code"] in CODES, frame)
        return news

    def say(
        self,
        client: Client,
        operation: dict[str, Any],
        request_id: Any,
        codes: set[str] | frozenset[str] = frozenset(),
        must: bool = False,
    ) -> bool:
        """Send an operation that is not answered unless it is refused. Return whether it is."""
        news = self.exchange(client, {**operation, "id": request_id})
        errors = [
            frame
            for frame in news
            if frame.get("id") == request_id and is_refusal(frame, operation["op"])
        ]
        check(len(errors) <= 1, "refused twice", operation, errors)
        check(all(error["code"] in codes for error in errors), operation, errors, codes)
        check(errors or not must, "was not refused", operation, news)
        return bool(errors)

    def ask_of_ros(self, client: Client, operation: dict[str, Any]) -> None:
        """Send an operation whose answer may come later, but comes once."""
        request_id = self.new_id()
        client.later[operation["op"], request_id] += 1
        client.seen = len(client.speaker.frames)
        self.exchange(client, {**operation, "id": request_id})

    def answers(self, client: Client, op: str, request_id: Any) -> list[Frame]:
        answer = ANSWER_OF_ROS.get(op, op)
        return [
            frame
            for frame in client.speaker.frames
            if frame.get("id") == request_id and (frame["op"] == answer or is_refusal(frame, op))
        ]

    def teardown(self) -> None:
        try:
            if self.wild is not None:  # first: it may have taken a service over
                self.stage.run(self.wild.speaker.cut())
            if self.clients:
                self.end()
        finally:
            for client in self.clients:
                self.stage.run(client.speaker.cut())
        self.stage.until_nobody_is_left()
        self.stage.check_log()

    def end(self) -> None:
        """Let the providers withdraw. Then all that was asked has to be answered, once."""
        for client in self.clients:
            for service in sorted(client.services):
                self.say(client, {"op": "unadvertise_service", "service": service}, self.new_id())
            for action in sorted(client.actions):
                self.say(client, {"op": "unadvertise_action", "action": action}, self.new_id())
        for client in self.clients:
            self.stage.run(
                client.speaker.until(
                    lambda client=client: all(self.answers(client, *key) for key in client.later)
                )
            )
            self.exchange(client)  # a second answer would be here by now
            for key in client.later:
                check(len(self.answers(client, *key)) == 1, key, self.answers(client, *key))


def is_refusal(frame: Frame, op: str) -> bool:
    """Return whether a frame refuses an operation, or warns that there is nothing to end."""
    is_absent = frame.get("code") == "not_found" and op != "subscribe"
    is_status = (frame["op"], frame.get("request")) == ("status", op)
    return is_status and (frame.get("level") == "error" or is_absent)


async def calling(work: Any) -> None:
    work()


def resolved(topic: str) -> str:
    return topic if topic.startswith("/") else f"/{topic}"


def on(stage: Stage) -> type[Conversations]:
    """Return the machine on a stage."""
    return cast("type[Conversations]", type("Conversations", (Conversations,), {"stage": stage}))
