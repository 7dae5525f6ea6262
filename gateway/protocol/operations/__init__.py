# SPDX-License-Identifier: Apache-2.0
"""The operations that clients send, as frozen models.

rosbridge protocol v2 and this gateway's extensions (docs/protocol.md). Keys that an operation
does not know are ignored, because clients send extras; the keys it knows are strict.
"""

from typing import Final, get_args

from gateway.protocol.operations.actions import (
    ActionFeedback,
    ActionResult,
    AdvertiseAction,
    CancelActionGoal,
    SendActionGoal,
    UnadvertiseAction,
)
from gateway.protocol.operations.fragment import Fragment
from gateway.protocol.operations.gateway import Auth, Describe, GraphRequest, Hello, Ping, SetLevel
from gateway.protocol.operations.parameters import (
    DescribeParameters,
    GetParameters,
    ListParameters,
    SetParameters,
)
from gateway.protocol.operations.services import (
    AdvertiseService,
    CallService,
    ServiceResponse,
    UnadvertiseService,
)
from gateway.protocol.operations.topics import (
    Advertise,
    Publish,
    Subscribe,
    Unadvertise,
    Unsubscribe,
)
from gateway.protocol.operations.transforms import CancelTransform, LookupTransform

__all__ = [
    "OPERATIONS",
    "ActionFeedback",
    "ActionResult",
    "Advertise",
    "AdvertiseAction",
    "AdvertiseService",
    "Auth",
    "CallService",
    "CancelActionGoal",
    "CancelTransform",
    "ClientOperation",
    "Describe",
    "DescribeParameters",
    "Fragment",
    "GetParameters",
    "GraphRequest",
    "Hello",
    "ListParameters",
    "LookupTransform",
    "Ping",
    "Publish",
    "SendActionGoal",
    "ServiceResponse",
    "SetLevel",
    "SetParameters",
    "Subscribe",
    "Unadvertise",
    "UnadvertiseAction",
    "UnadvertiseService",
    "Unsubscribe",
]

ClientOperation = (
    Advertise
    | Unadvertise
    | Publish
    | Subscribe
    | Unsubscribe
    | CallService
    | AdvertiseService
    | UnadvertiseService
    | ServiceResponse
    | SendActionGoal
    | CancelActionGoal
    | AdvertiseAction
    | UnadvertiseAction
    | ActionFeedback
    | ActionResult
    | ListParameters
    | GetParameters
    | SetParameters
    | DescribeParameters
    | LookupTransform
    | CancelTransform
    | SetLevel
    | Hello
    | Ping
    | Describe
    | GraphRequest
    | Auth
)
"""What a router carries out; a `Fragment` is part of one of these."""

OPERATIONS: Final[dict[str, type[ClientOperation | Fragment]]] = {
    model.op: model for model in (*get_args(ClientOperation), Fragment)
}
