# SPDX-License-Identifier: Apache-2.0
"""The operations that clients send, as frozen models.

rosbridge protocol v2 and this gateway's extensions (docs/reference/protocol/). Unknown keys are
ignored, because clients send extras. Known keys are strict.
"""

from typing import Final, get_args

from gateway.fronts.rosbridge.operations import (
    actions,
    commands,
    fragment,
    gateway,
    parameters,
    recording,
    services,
    topics,
    transforms,
)

ClientOperation = (
    topics.Advertise
    | topics.Unadvertise
    | topics.Publish
    | topics.Subscribe
    | topics.Unsubscribe
    | services.CallService
    | services.AdvertiseService
    | services.UnadvertiseService
    | services.ServiceResponse
    | actions.SendActionGoal
    | actions.CancelActionGoal
    | actions.AdvertiseAction
    | actions.UnadvertiseAction
    | actions.ActionFeedback
    | actions.ActionResult
    | parameters.ListParameters
    | parameters.GetParameters
    | parameters.SetParameters
    | parameters.DescribeParameters
    | transforms.LookupTransform
    | transforms.CancelTransform
    | commands.Stop
    | commands.AcquireControl
    | commands.ReleaseControl
    | commands.Control
    | gateway.SetLevel
    | gateway.Hello
    | gateway.Help
    | gateway.Ping
    | gateway.Describe
    | gateway.Generate
    | gateway.FetchAsset
    | gateway.GraphRequest
    | gateway.Events
    | gateway.Auth
    | gateway.Log
    | recording.Record
)
"""The operations that a router carries out. A `Fragment` is a part of one of these."""

OPERATIONS: Final[dict[str, type[ClientOperation | fragment.Fragment]]] = {
    model.op: model for model in (*get_args(ClientOperation), fragment.Fragment)
}
