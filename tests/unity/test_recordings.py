# SPDX-License-Identifier: Apache-2.0
"""The C# tests that only look at the simulated robot also pass if its recording is played."""

import pytest

from tests.gateway_process import GatewayProcess
from tests.unity import csharp, mono, package

NAMES = (
    "TopicTests.OdometryOfTheRobotComesAsATypedMessage",
    "TopicTests.OnlyTheFieldsThatWereAskedForCome",
    "TopicTests.AScanThatIsFilledAnewKeepsItsArray",
    "TopicTests.ATypeWithoutAClassCanBeReadAsATree",
    "TopicTests.TheGatewaysWordsOnARefusalAreAnEvent",
    "TopicTests.ASecondSubscriptionToALatchedTopicGetsTheLatchedMessageToo",
    "TransformWatchTests.APoseThatNeverChangesIsNeverOld",
    "TransformWatchTests.APoseThatIsPublishedComesAgainAndAgain",
    "TransformWatchTests.AFrameThatNobodyKnowsIsToldInTheGatewaysWords",
    "RecordingTests.NothingInItMovesAndTheGatewaySaysWhy",
)

pytestmark = pytest.mark.skipif(bool(mono.missing()), reason=mono.missing())


def test_a_recording_is_as_good_as_its_robot(
    mono_runner: csharp.Runner, recording: GatewayProcess
) -> None:
    binary = package.compiled("Ros2Gateway.Core.Tests", csharp.IN_EDITOR)
    addresses = ("ROS2GATEWAY_TEST_URL", "ROS2GATEWAY_RECORDING_URL")
    tests = [csharp.CSharpTest(name, binary) for name in NAMES]
    mono_runner.check_all(tests, lambda _: dict.fromkeys(addresses, recording.url))
