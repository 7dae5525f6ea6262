# SPDX-License-Identifier: Apache-2.0
"""The unit that `ros2-gateway install-service` writes, read by systemd itself."""

import os
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

from gateway.cli import main as cli
from gateway.cli import service as service_module
from gateway.cli.report import EXIT_NO_ROS, EXIT_USAGE
from gateway.cli.service import Unit, install, unit_of
from gateway.cli.tokens import own_command
from gateway.config.files import Given
from gateway.config.reference import example
from gateway.config.settings import load
from gateway.errors import RosMissingError, UsageError
from tests.cli.test_main import refusal, ros2_gateway

MAX_EXPOSURE = 30  # of systemd-analyze security, in tenths: 3.0 is "OK"
LAN = load([Given("lan", "true", "--lan")])
ODD = Path('/opt/my $ROS 100%/it\'s "here"/setup.bash')

needs_systemd = pytest.mark.skipif(
    shutil.which("systemd-analyze") is None, reason="needs systemd-analyze"
)
needs_root = pytest.mark.skipif(os.geteuid() != 0, reason="needs root")


def analyze(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["systemd-analyze", *arguments], capture_output=True, text=True, check=False, timeout=60
    )


@pytest.fixture
def unit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file that `install` writes. Nothing starts it."""
    path = tmp_path / "ros2-gateway.service"
    monkeypatch.setattr(service_module, "UNIT", path)
    monkeypatch.setattr(service_module, "CONFIG", tmp_path / "etc/config.toml")
    monkeypatch.setattr(service_module, "_SYSTEMD_RUNS", tmp_path / "no")
    return path


@needs_systemd
@pytest.mark.parametrize("setups", [[], [Path("/opt/ros/jazzy/setup.bash"), ODD]])
def test_systemd_accepts_the_unit_and_its_protection(unit: Path, setups):
    unit.write_text(Unit("root", setups, ["--lan"], {"ROS_STATIC_PEERS": "a;b %h"}).text)
    verified = analyze("verify", str(unit))
    assert (verified.returncode, verified.stderr) == (0, "")
    judged = analyze("security", "--offline=true", f"--threshold={MAX_EXPOSURE}", str(unit))
    assert judged.returncode == 0, judged.stdout


def test_a_dry_run_prints_the_unit_with_the_ros_of_this_shell_and_changes_nothing():
    finished = ros2_gateway(
        *("install-service", "--user", "root", "--lan", "--dry-run"), ROS_DOMAIN_ID="7"
    )
    assert (finished.returncode, finished.stderr) == (0, "")
    lines = finished.stdout.splitlines()
    assert {"User=root", "Type=notify", "WatchdogSec=10"} <= set(lines)
    assert any(line.startswith('Environment="ROS_DOMAIN_ID=7"') for line in lines)
    (start,) = [line for line in lines if line.startswith("ExecStart=")]
    assert start.endswith(' serve --lan"')
    assert f"RestartPreventExitStatus={EXIT_USAGE} {EXIT_NO_ROS}" in lines
    assert "KillMode" not in {line.partition("=")[0] for line in lines}, "the guard outlives us"
    assert not Path("/etc/systemd/system/ros2-gateway.service").exists()


@pytest.mark.parametrize(
    ("result", "waits"),
    [("signal", ""), ("core-dump", ""), ("watchdog", ""), ("success", ""), ("exit-code", "2")],
)
def test_a_killed_gateway_starts_again_at_once_and_one_with_an_error_later(
    tmp_path: Path, result: str, waits: str
):
    lines = Unit("root", [], [], {}).text.splitlines()
    assert "RestartSec=100ms" in lines
    (after,) = [line.partition("=")[2] for line in lines if line.startswith("ExecStopPost=")]
    (tmp_path / "sleep").write_text('#!/bin/sh\nprintf "$1"\n')
    (tmp_path / "sleep").chmod(0o755)
    command = shlex.split(after.replace("$$", "$"))
    environment = {"PATH": f"{tmp_path}", "SERVICE_RESULT": result}
    assert subprocess.check_output(command, env=environment, text=True) == waits


@needs_root
def test_an_installation_says_what_it_did_and_how_to_go_on(unit: Path):
    config = unit.parent / "etc/config.toml"
    told = list(install(Unit("root", [], ["--lan"], {}), LAN))
    assert told[:2] == [f"wrote {unit}", f"wrote {config}, in which every setting is a comment"]
    assert "systemctl enable --now ros2-gateway" in told[2]
    assert [line.split(":")[0] for line in told[3:]] == ["its log", "its token", "another"]
    assert unit.read_text() == Unit("root", [], ["--lan"], {}).text
    assert config.read_text() == example()


@needs_root
def test_an_installation_keeps_the_configuration_and_names_the_file_of_its_tokens(unit: Path):
    config = unit.parent / "etc/config.toml"
    config.parent.mkdir()
    config.write_text("lan = true\naccess.token_file = '/var/lib/robot/t.json'\n")
    told = list(install(Unit("root", [], [], {}), load(file=config)))
    assert config.read_text().startswith("lan = true\n")
    assert "its token:  sudo cat /var/lib/robot/first-token" in told
    assert told[-1].endswith(
        " token --file /var/lib/robot/t.json create NAME --role viewer,"
        " then sudo systemctl reload ros2-gateway"
    )


@needs_root
def test_nothing_is_written_for_a_user_that_cannot_read_the_configuration(unit: Path):
    config = unit.parent / "robot.toml"
    config.touch(0o600)
    with pytest.raises(UsageError, match=rf"^nobody cannot read {config}: run chmod a\+r"):
        list(install(Unit("nobody", [], [], {}), load(file=config)))
    assert not unit.exists()


@needs_root
def test_nothing_is_written_for_a_user_that_cannot_run_the_gateway(unit: Path, monkeypatch):
    monkeypatch.setattr(service_module, "own_command", lambda: ["/root/none/ros2-gateway"])
    with pytest.raises(UsageError, match=r"^nobody cannot run /root/none/ros2-gateway \("):
        list(install(Unit("nobody", [], [], {}), load()))
    assert not unit.exists()


def test_a_token_for_a_shell_comes_with_the_command_for_the_service(
    unit: Path, tmp_path: Path, monkeypatch, capsys, restored_signals
):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert cli.main(["token", "create", "a"]) == 0
    assert "service" not in capsys.readouterr().err
    unit.write_text(Unit("robot", [], [], {}).text)
    assert cli.main(["token", "create", "b"]) == 0
    create = f"{shlex.join(own_command())} token --file {service_module.TOKENS} create NAME"
    last = capsys.readouterr().err.splitlines()[-1]
    others = "the service of this machine has other tokens"
    assert last == f"{others}: sudo -u robot {create} --role viewer"
    assert cli.main(["token", "--file", str(tmp_path / "t.json"), "create", "c"]) == 0
    assert "service" not in capsys.readouterr().err


def test_only_root_installs(unit: Path, monkeypatch):
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    with pytest.raises(UsageError, match="sudo"):
        list(install(Unit("root", [], [], {}), load()))
    assert not unit.exists()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((), "no user is named: add --user with the user that runs your ROS nodes"),
        (
            ("--user", "nobody-here"),
            "this computer has no user 'nobody-here': name the user that runs your ROS nodes",
        ),
        (
            ("--user", "root", "--setup", "/none/setup.bash"),
            "--setup: no file /none/setup.bash: name the setup.bash of ROS or a workspace",
        ),
        (
            ("--user", "root", "--config", "/none.toml"),
            "--config: no file /none.toml: name a TOML file",
        ),
    ],
)
def test_a_mistake_is_one_sentence_with_the_remedy(arguments, sentence):
    assert refusal("install-service", "--dry-run", *arguments, SUDO_USER="") == (2, sentence)


def test_the_only_ros_is_found_and_of_several_one_is_to_be_chosen(tmp_path: Path, monkeypatch):
    monkeypatch.setattr(service_module, "find_spec", lambda name: None)
    monkeypatch.setattr(service_module, "SETUPS", tmp_path)

    def found() -> list[Path]:
        return list(unit_of("root", [], {}).setups)

    with pytest.raises(RosMissingError):
        found()
    for name in ("jazzy", "kilted"):
        (tmp_path / name).mkdir()
    jazzy, kilted = (tmp_path / name / "setup.bash" for name in ("jazzy", "kilted"))
    jazzy.touch()
    assert found() == [jazzy]
    kilted.touch()
    with pytest.raises(UsageError, match="choose one by --setup"):
        found()
    assert list(unit_of("root", [kilted], {}).setups) == [kilted]
