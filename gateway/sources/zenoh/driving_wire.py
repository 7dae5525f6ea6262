# SPDX-License-Identifier: Apache-2.0
"""The wire between a relay and the robot that its clients drive.

docs/reference/driving-wire.md has it in words. Bytes come in, values go out. Anything that a peer
sends is read, or raises `WireError`.
"""

import re
import struct
from typing import Annotated, Any, Final, Literal, NamedTuple, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from gateway.sources.zenoh.keys import WireError

BEAT: Final = "beat"  # put by the robot
CONTROL: Final = "control"  # put by the robot, when a state has changed and once a second
LEASE: Final = "lease"  # a query to the robot: operations
STOP: Final = "lease/stop"  # a query to the robot. It stops the robot with any payload
# With the client behind them
COMMAND: Final = "cmd"  # put by the relay
TOKEN: Final = "client"  # noqa: S105  # a liveliness token of the relay
TOLD: Final = "control"  # put by the robot

MAX_COMMAND_BYTES: Final = 2048  # a topic, a frame and six numbers
MAX_OPERATION_BYTES: Final = 4096
MAX_ANSWER_BYTES: Final = 64 * 1024  # ten command topics, and what was refused
MAX_NAME_CHARACTERS: Final = 256
MAX_TEXT_CHARACTERS: Final = 2048
MAX_EVENTS: Final = 32  # of one operation

_CLIENT: Final = re.compile(r"[0-9a-f]{1,32}/[0-9]{1,10}", re.ASCII)
_BEAT: Final = struct.Struct("<QQ")

Name = Annotated[str, Field(max_length=MAX_NAME_CHARACTERS)]
Client = Annotated[str, Field(pattern=rf"^{_CLIENT.pattern}$")]
Number = Annotated[int, Field(ge=0, lt=2**63)]
# as a text of ROS: a NUL would end it
FrameId = Annotated[str, Field(max_length=MAX_NAME_CHARACTERS, pattern=r"^[^\x00]*$")]
_Float = Annotated[float, Field(allow_inf_nan=False)]
_Milliseconds = Annotated[float, Field(ge=0, le=1e15, allow_inf_nan=False)]  # 30,000 years


class _Message(BaseModel):
    model_config = ConfigDict(frozen=True, strict=True, extra="forbid")

    @property
    def packed(self) -> bytes:
        """The bytes on the wire."""
        return self.model_dump_json(exclude_defaults=True).encode()


class Beat(NamedTuple):
    """A sign of life of the robot's gateway, with its time."""

    epoch: int  # a random number, another one after each start and each loss of the router
    time_ns: int  # of the monotonic clock of the robot's gateway

    @property
    def packed(self) -> bytes:
        """The bytes on the wire."""
        return _BEAT.pack(*self)


class RemoteCommand(_Message):
    """One command of a client of a relay."""

    epoch: Number
    number: Number  # of the client, greater than that of each operation and command before it
    beat_ns: Number  # the time of the newest beat that the relay has seen
    topic: Name
    type: Name
    # linear and angular in m/s and rad/s. None: the message did not fit its type
    values: tuple[_Float, _Float, _Float, _Float, _Float, _Float] | None = None
    frame_id: FrameId = ""
    monotonic_ms: _Milliseconds | None = None  # of the client's clock
    waited_ms: _Milliseconds = 0.0  # at the relay
    is_behind: bool = False  # the client has spent its time budget at the relay
    wants_answer: bool = False


class RemoteOperation(_Message):
    """An operation of a client of a relay, or a question of the relay itself."""

    op: Literal["enter", "acquire", "release", "advertise", "unadvertise", "look"]
    client: Client
    number: Number
    name: Name = ""  # of its token at the relay, for the audit log of the robot
    address: Name = ""
    topic: Name | None = None
    type: Name | int | None = None


class RemoteStop(_Message):
    """A stop. Without a topic it stops all."""

    client: Client | None = None
    number: Number = 0  # none of the client's commands up to this number counts any more
    topic: Name | None = None
    name: Name = ""
    address: Name = ""


class ToldEvent(_Message):
    """A message to a client: an answer, a refusal, a warning, or that it must enter again.

    *number* is that of the operation or command, if its client wants an answer to each.
    """

    what: Literal["answer", "refusal", "warning", "info", "lost"]
    number: Number | None = None
    kind: Name = ""
    code: Name = ""
    text: Annotated[str, Field(max_length=MAX_TEXT_CHARACTERS)] = ""
    is_warning: bool = False  # a refusal of what is not there
    members: dict[str, Any] = Field(default_factory=dict)


class TopicControl(_Message):
    """The state of a command topic, for all clients."""

    topic: Name
    type: Name | None = None
    holder: Name | None = None  # a client of a relay, or `other`
    members: dict[str, Any]  # of a `control` frame


class Told(_Message):
    """A message of the robot: its beat, the states of its topics, and events for a client."""

    epoch: Number
    time_ns: Number
    topics: Annotated[tuple[TopicControl, ...], Field(max_length=MAX_EVENTS)] = ()
    events: Annotated[tuple[ToldEvent, ...], Field(max_length=MAX_EVENTS)] = ()

    @property
    def beat(self) -> Beat:
        """The sign of life in it."""
        return Beat(self.epoch, self.time_ns)


_Read = TypeVar("_Read", bound=_Message)


def read_beat(data: bytes) -> Beat:
    """Read a beat.

    Raises:
        WireError: it is something else.
    """
    if len(data) != _BEAT.size:
        raise WireError(f"beat of {len(data)} bytes, expected {_BEAT.size}")
    return Beat(*_BEAT.unpack(data))


def read_command(data: bytes) -> RemoteCommand:
    """Read a command.

    Raises:
        WireError: it is something else, or too long.
    """
    return _read(RemoteCommand, data, MAX_COMMAND_BYTES, "command")


def read_operation(data: bytes) -> RemoteOperation:
    """Read an operation.

    Raises:
        WireError: it is something else, or too long.
    """
    return _read(RemoteOperation, data, MAX_OPERATION_BYTES, "operation")


def read_stop(data: bytes) -> RemoteStop:
    """Read a stop.

    Raises:
        WireError: it is something else, or too long.
    """
    return _read(RemoteStop, data, MAX_OPERATION_BYTES, "stop")


def read_told(data: bytes) -> Told:
    """Read a message of a robot.

    Raises:
        WireError: it is something else, or too long.
    """
    return _read(Told, data, MAX_ANSWER_BYTES, "answer")


def client_of(key: str) -> str:
    """Return the client that a key ends with.

    Raises:
        WireError: the key is another one.
    """
    client = "/".join(key.rsplit("/", 2)[1:])
    if not _CLIENT.fullmatch(client):
        raise WireError(f"not the key of a client: {key[:120]!r}")
    return client


def _read(model: type[_Read], data: bytes, most: int, noun: str) -> _Read:
    if len(data) > most:
        raise WireError(f"{noun} of {len(data)} bytes, at most {most}")
    try:
        return model.model_validate_json(data)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False, include_context=False)[0]
        where = ".".join(map(str, first["loc"]))
        raise WireError(f"{noun}: {where}: {first['msg']}"[:200]) from error
