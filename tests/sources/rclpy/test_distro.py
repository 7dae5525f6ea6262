# SPDX-License-Identifier: Apache-2.0

from importlib import metadata

import pytest

from gateway.sources.rclpy.distro import distro


def test_the_sourced_installation_says_it(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("ROS_DISTRO", "lyrical")
    assert distro() == "lyrical"


@pytest.mark.parametrize(
    ("version", "name"), [("7.1.5", "jazzy"), ("9.1.2", "kilted"), ("70.0", "unknown")]
)
def test_otherwise_rclpy_does(version: str, name: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("ROS_DISTRO", "")
    monkeypatch.setattr(metadata, "version", {"rclpy": version}.get)
    assert distro() == name


def test_an_rclpy_without_a_version_is_unknown(monkeypatch: pytest.MonkeyPatch):
    def version(name: str) -> str:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setenv("ROS_DISTRO", "")
    monkeypatch.setattr(metadata, "version", version)
    assert distro() == "unknown"
