# SPDX-License-Identifier: Apache-2.0
"""The definitions that the gateway knows in addition to those of ROS."""

import pytest

from gateway.definitions import known_definitions
from gateway.errors import ConfigError
from tests.schemas.test_installed import write_definition


def test_definitions_in_directories_and_shipped_ones_are_known(tmp_path):
    write_definition(tmp_path, "own_msgs/msg/Thing", "int8 x\n")
    names = known_definitions([tmp_path], "types.paths").names()
    assert {"own_msgs/msg/Thing", "tf2_msgs/msg/TFMessage", "rosapi_msgs/msg/TypeDef"} <= {*names}


def test_a_home_directory_is_understood(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    write_definition(tmp_path / "ws", "own_msgs/msg/Thing", "int8 x\n")
    assert "own_msgs/msg/Thing" in known_definitions(["~/ws"], "types.paths").names()


def test_a_folder_that_cannot_be_read_is_named_with_its_source(tmp_path):
    missing = tmp_path / "nothing"
    with pytest.raises(ConfigError, match=f"^--types-path: {missing}: no such file or directory$"):
        known_definitions([missing], "--types-path")
