# SPDX-License-Identifier: Apache-2.0
"""The files of the configuration, and the lines of their settings."""

from pathlib import Path

import pytest

from gateway.config import files as files_module
from gateway.config.files import lines_of_keys
from gateway.config.settings import load
from gateway.errors import ConfigError


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder that stands for /etc/ros2-gateway."""
    path = tmp_path / "etc"
    (path / "config.d").mkdir(parents=True)
    monkeypatch.setattr(files_module, "FOLDER", path)
    return path


def test_later_files_override_earlier_ones_and_each_value_has_its_origin(folder, tmp_path):
    main, named = folder / "config.toml", tmp_path / "named.toml"
    fleet, robot = folder / "config.d/10-fleet.toml", folder / "config.d/20-robot.toml"
    main.write_text("port = 1\npath = '/main'\nqr = false\nlan = true\n")
    robot.write_text("[ros]\nnamespace = '/r7'\n[log]\nlevel = 'debug'\n")
    fleet.write_text("port = 2\nlog.level = 'error'\npath = '/fleet'\n")
    named.write_text("path = '/named'\nros.node_prefix = 'a'\n")
    loaded = load(environment={"ROS2_GATEWAY_ROS__NODE_PREFIX": "b"}, file=named)
    assert {key: origin for key, origin in loaded.origins.items() if origin != "default"} == {
        "lan": f"{main}:4",
        "qr": f"{main}:3",
        "port": f"{fleet}:1",
        "log.level": f"{robot}:4",
        "ros.namespace": f"{robot}:2",
        "path": f"{named}:1",
        "ros.node_prefix": "ROS2_GATEWAY_ROS__NODE_PREFIX",
    }
    config = loaded.config
    assert (config.port, config.log.level, config.path) == (2, "debug", "/named")
    assert loaded.files == [main, fleet, robot, named]


def test_only_toml_files_are_drop_ins_and_the_others_are_known(folder):
    for name in ("10-lan.conf", ".#robot.toml", "robot.toml"):
        (folder / "config.d" / name).touch()
    loaded = load()
    assert [path.name for path in loaded.files] == ["robot.toml"]
    assert [path.name for path in loaded.ignored] == [".#robot.toml", "10-lan.conf"]


def test_mistakes_of_all_files_are_reported_with_their_lines(folder):
    (folder / "config.toml").write_text("prt = 1\n")
    (folder / "config.d/a.toml").write_text("\n[limits]\n# many\nmax_clients = 0\n")
    (folder / "config.d/b.toml").write_text("port = \n")
    with pytest.raises(ConfigError) as caught:
        load()
    broken, unknown, wrong = caught.value.problems
    assert unknown == f"{folder}/config.toml:1: unknown setting prt, did you mean port"
    assert wrong.startswith(f"{folder}/config.d/a.toml:4: limits.max_clients: got 0, expected ")
    assert broken.startswith(f"{folder}/config.d/b.toml is not valid TOML: ")
    assert "line 1" in broken


def test_another_folder_may_be_named_and_must_exist(folder, tmp_path):
    other = tmp_path / "image"
    environment = {"ROS2_GATEWAY_CONFIG_DIR": str(other)}
    with pytest.raises(ConfigError, match=f"^cannot read {other}, no such file or directory$"):
        load(environment=environment)
    other.mkdir()
    (folder / "config.toml").write_text("port = 1\n")
    (other / "config.toml").write_text("port = 2\n")
    assert load(environment=environment).config.port == 2


def test_a_folder_that_cannot_be_listed_is_a_mistake(folder):
    (folder / "config.d").rmdir()
    (folder / "config.d").touch()
    with pytest.raises(ConfigError, match=f"^cannot read {folder}/config.d, not a directory$"):
        load()


def test_a_value_that_contradicts_another_is_named_with_its_origin(folder):
    (folder / "config.toml").write_text("\nlan = true\n")
    problem = ConfigError("lan: got true, but", "tls.cert, tls.key: cannot read", "port: taken")
    assert load().located(problem).problems == (
        f"{folder}/config.toml:2: lan: got true, but",
        "tls.cert, tls.key: cannot read",
        "port: taken",
    )


def test_the_line_of_a_key_is_where_its_statement_begins():
    text = '''# a comment
port = 1  # another

allowed_hosts = [
  "a",  # [not a table]
  "b",
]
[limits] # a table
max_clients = 3
types = { paths = ["x"] }
[access.viewer]
publish = ["""
[log]
"""]
log."level" = 3
'''
    assert lines_of_keys(text) == {
        "port": 2,
        "allowed_hosts": 4,
        "limits": 8,
        "limits.max_clients": 9,
        "limits.types": 10,
        "limits.types.paths": 10,
        "access": 11,
        "access.viewer": 11,
        "access.viewer.publish": 12,
        "access.viewer.log": 15,
        "access.viewer.log.level": 15,
    }
