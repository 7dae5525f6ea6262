# SPDX-License-Identifier: Apache-2.0
"""Drives roslibpy, 1.8 or 2.x, as `driver.mjs` drives roslib: the same commands and events.

Started with the version to drive on `PYTHONPATH`. Not imported by any test.
"""

import json
import logging
import os
import sys
import threading
from collections import UserDict
from collections.abc import Callable
from enum import Enum
from typing import Any
from urllib.parse import urlsplit

import roslibpy  # type: ignore[import-not-found]  # on the path that this is started with
from roslibpy.tf import TFClient  # type: ignore[import-not-found]

_TIMEOUT_S = 120  # as long as `tests.client.TIMEOUT_S`

_writing = threading.Lock()


def say(**line: Any) -> None:
    """Write one line."""
    with _writing:
        print(json.dumps(line, default=dict), flush=True)  # noqa: T201  # this is how it speaks


class Warnings(logging.Handler):
    """Tells what roslibpy logs from warnings on."""

    def emit(self, record: logging.LogRecord) -> None:
        text = logging.Formatter().format(record)
        say(event="warning", connection="", name="", value=text)


class Answer:
    """The answer to a command, given from whichever thread."""

    def __init__(self, number: int) -> None:
        self._number = number

    def result(self, value: Any = None) -> None:
        say(n=self._number, result=value)

    def failure(self, reason: Any) -> None:
        say(n=self._number, failure=reason)

    def of(self, call: Callable[[], Any]) -> None:
        """Answer with what a blocking call returns, in a separate thread."""

        def run() -> None:
            try:
                self.result(call())
            except Exception as error:  # noqa: BLE001  # whatever roslibpy raises is the answer
                self.failure(str(error) or type(error).__name__)

        threading.Thread(target=run, daemon=True).start()


class Ros(roslibpy.Ros):  # type: ignore[misc]  # of a library without types
    """A connection that is told of from its first attempt on, which is made by the constructor."""

    def __init__(self, url: str, token: str | None, tell: Callable[[str, str, Any], None]) -> None:
        self._tell = tell
        self._opened = threading.Event()
        address = urlsplit(url)
        headers = None if token is None else {"Authorization": f"Bearer {token}"}
        super().__init__(address.hostname, address.port, headers=headers)

    def connect(self) -> None:
        self.factory.setProtocolOptions(openHandshakeTimeout=_TIMEOUT_S)
        # Of its attempts to connect again. They would come ever more rarely, each 2.7 times as long
        # after the last, while a gateway starts slowly.
        self.factory.initialDelay = 0.1
        self.factory.maxDelay = 1.0
        self.on("close", lambda _: self._tell("closed", "", None))
        self.on("ready", lambda _: self._tell("connected", "", None))
        self.on("ready", lambda _: self._opened.set())
        super().connect()

    def run(self, timeout: float) -> None:
        """Wait until the connection is open.

        The library's own asks whether it is open and then listens for that: what opens between the
        two is never heard of.
        """
        self.factory.manager.run()
        if not self._opened.wait(timeout):
            raise TimeoutError(f"no connection within {timeout} s")


class Connection:
    """One connection, and what was made on it, each by its name.

    A command returns whether it has been carried out. Otherwise *answer* is given when it has.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._made: dict[tuple[type, str], Any] = {}

    def connect(
        self, answer: Answer, url: str, again: bool = False, token: str | None = None
    ) -> bool:
        self._ros = Ros(url, token, self._tell)
        # Version 1 connects outside the reactor's thread, which then sleeps on for up to a second.
        self._ros.call_later(0, lambda: None)
        answer.of(lambda: self._ros.run(_TIMEOUT_S))
        return False

    def close(self, answer: Answer) -> bool:
        answer.of(self._ros.close)
        return False

    def subscribe(self, _: Answer, topic: str, **about: Any) -> bool:
        self._topic(topic, **about).subscribe(
            lambda message: self._tell("message", topic, dict(message))
        )
        return True

    def unsubscribe(self, _: Answer, topic: str) -> bool:
        self._topic(topic).unsubscribe()
        return True

    def advertise(self, _: Answer, topic: str, **about: Any) -> bool:
        self._topic(topic, **about).advertise()
        return True

    def unadvertise(self, _: Answer, topic: str) -> bool:
        self._topic(topic).unadvertise()
        return True

    def publish(self, _: Answer, topic: str, message: Any, **about: Any) -> bool:
        self._topic(topic, **about).publish(roslibpy.Message(message))
        return True

    def call_service(
        self, answer: Answer, service: str, type_name: str, args: Any, timeout: float | None = None
    ) -> bool:
        request = roslibpy.ServiceRequest(args)
        self._one(roslibpy.Service, service, type_name).call(request, answer.result, answer.failure)
        return False

    def advertise_service(
        self, _: Answer, service: str, type_name: str, values: Any, result: bool
    ) -> bool:
        def handle(request: Any, response: Any) -> bool:
            self._tell("request", service, request)
            response.update(values)
            return result

        self._one(roslibpy.Service, service, type_name).advertise(handle)
        return True

    def unadvertise_service(self, _: Answer, service: str) -> bool:
        self._one(roslibpy.Service, service).unadvertise()
        return True

    def send_goal(self, answer: Answer, action: str, type_name: str, goal: Any) -> bool:
        identified = threading.Event()
        goals: list[str] = []

        def tell(event: str) -> Callable[[Any], None]:
            def arrive(value: Any) -> None:
                identified.wait(_TIMEOUT_S)
                self._tell(event, goals[0], _plain(value))

            return arrive

        goals.append(
            self._one(roslibpy.ActionClient, action, type_name).send_goal(
                roslibpy.Goal(goal), tell("result"), tell("feedback"), tell("failure")
            )
        )
        answer.result(goals[0])
        identified.set()
        return False

    def cancel_goal(self, _: Answer, action: str, goal_id: str) -> bool:
        self._one(roslibpy.ActionClient, action).cancel_goal(goal_id)
        return True

    def follow(self, _: Answer, frame: str, options: dict[str, Any], **about: Any) -> bool:
        del about  # there is only one client of transforms, which asks a service
        made = self._one(TFClient, "", **options)
        made.subscribe(frame, lambda transform: self._tell("transform", frame, _plain(transform)))
        return True

    def dispose(self, _: Answer, kind: str) -> bool:
        del kind
        self._made[TFClient, ""].dispose()
        return True

    def get_param(self, answer: Answer, name: str) -> bool:
        answer.of(lambda: roslibpy.Param(self._ros, name).get(timeout=_TIMEOUT_S))
        return False

    def set_param(self, answer: Answer, name: str, value: Any) -> bool:
        answer.of(lambda: roslibpy.Param(self._ros, name).set(value, timeout=_TIMEOUT_S))
        return False

    def delete_param(self, answer: Answer, name: str) -> bool:
        answer.of(lambda: roslibpy.Param(self._ros, name).delete(timeout=_TIMEOUT_S))
        return False

    def ask(self, answer: Answer, question: str, args: list[Any]) -> bool:
        method = getattr(self._ros, question)
        if question == "get_action_servers":  # it alone does not block
            method(lambda result: answer.result(result["action_servers"]), answer.failure)
        else:
            answer.of(lambda: _plain(method(*args)))
        return False

    def set_status_level(self, _: Answer, level: str) -> bool:
        self._ros.set_status_level(level, "all")
        return True

    def _tell(self, event: str, name: str, value: Any) -> None:
        say(event=event, connection=self._name, name=name, value=value)

    def _topic(self, topic: str, type_name: str = "", options: dict[str, Any] | None = None) -> Any:
        return self._one(roslibpy.Topic, topic, type_name, **(options or {}))

    def _one(self, kind: Any, name: str, *about: Any, **options: Any) -> Any:
        if (kind, name) not in self._made:
            names = (name, *about) if name else ()
            self._made[kind, name] = kind(self._ros, *names, **options)
        return self._made[kind, name]


def _plain(value: Any) -> Any:
    if isinstance(value, UserDict | dict):
        return {key: _plain(each) for key, each in value.items()}
    return value.value if isinstance(value, Enum) else value


def main() -> None:
    """Carry out commands until there are no more."""
    roslibpy.set_rosapi_timeout(_TIMEOUT_S)
    logging.getLogger().addHandler(Warnings(logging.WARNING))
    connections: dict[str, Connection] = {}
    for line in sys.stdin:
        command = json.loads(line)
        answer = Answer(command.pop("n"))
        name = command.pop("connection")
        connection = connections.setdefault(name, Connection(name))
        try:
            if getattr(connection, command.pop("do"))(answer, **command):
                answer.result()
        except Exception as error:  # noqa: BLE001  # whatever roslibpy raises is the answer
            answer.failure(repr(error))
    # The reactor's thread knows no end that other connections in this process would survive.
    os._exit(0)


main()
