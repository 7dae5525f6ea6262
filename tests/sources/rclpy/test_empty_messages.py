# SPDX-License-Identifier: Apache-2.0
"""Empty messages in CDR, against those of rclpy and of the codec."""

from pathlib import Path

import pytest
from rclpy.serialization import deserialize_message

from gateway.codec.types import Types
from gateway.sources.rclpy.empty_messages import empty_message
from schemas.installed import InstalledDefinitions
from tests.messages import ros_class

DEFINITIONS = InstalledDefinitions()
HEADER = b"\0\1\0\0"
DEFAULTS = """\
bool a true
int16 b -2
float64 c 1.5
string d "gr\u00fc\u00dfe"
wstring e "\U0001f916"
int32[] f [1, 2, 3]
uint8[3] g [1, 2, 3]
string[<=3] h ["a", "bc"]
float32[5] i
wstring[2] j
geometry_msgs/Quaternion[2] k
std_msgs/Empty[] l
byte m 200
std_msgs/Empty n
uint8[1000000] o
float64 p
"""


@pytest.mark.parametrize("name", DEFINITIONS.names(kind="action"))
def test_an_empty_result_is_that_of_rclpy(name: str):
    result = DEFINITIONS.get(f"{name}_Result")
    response_class = ros_class(name).Impl.GetResultService.Response
    cdr = HEADER + empty_message(result, DEFINITIONS, before=b"\0")
    assert deserialize_message(cdr, response_class) == response_class()


def test_an_empty_message_is_that_of_rclpy():
    for name in DEFINITIONS.names():
        cdr = HEADER + empty_message(DEFINITIONS.get(name), DEFINITIONS)
        assert deserialize_message(cdr, ros_class(name)) == ros_class(name)(), name


def test_defaults_of_all_kinds_are_those_of_the_codec(tmp_path: Path):
    folder = tmp_path / "my_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "All.msg").write_text(DEFAULTS)
    definitions = InstalledDefinitions(None, [tmp_path])
    cdr = HEADER + empty_message(definitions.get("my_msgs/msg/All"), definitions)
    assert cdr == Types(definitions).get("my_msgs/msg/All").encode({}, 0)
