# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.cli.main import main
from gateway.cli.ros_arguments import without_ros_arguments
from gateway.errors import UsageError


@pytest.mark.parametrize(
    ("of_ros", "ours"),
    [
        ([], []),
        (["-r", "__ns:=/robot1"], ["--namespace=/robot1"]),
        (["--remap", "__node:=bridge"], ["--node-prefix=bridge"]),
        (["-r", "__name:=bridge"], ["--node-prefix=bridge"]),
        (["-p", "limits.max_clients:=7"], ["--set=limits.max_clients=7"]),
        (["--param", "use_sim_time:=True"], ["--set=ros.use_sim_time=True"]),
        (["--log-level", "WARN"], ["--log-level=warning"]),
        (["--log-level", "fatal"], ["--log-level=error"]),
        (["--log-level", "debug", "-r", "__ns:=/a"], ["--log-level=debug", "--namespace=/a"]),
    ],
)
def test_an_argument_of_ros_becomes_a_flag(of_ros, ours):
    assert without_ros_arguments(["serve", "--ros-args", *of_ros]) == ["serve", *ours]
    between = ["serve", "--ros-args", *of_ros, "--", "--lan", "--ros-args", *of_ros]
    assert without_ros_arguments(between) == ["serve", *ours, "--lan", *ours]


@pytest.mark.parametrize(
    "of_ros",
    ["-r /scan:=/front", "-r", "-p limits.max_clients", "--params-file /tmp/x", "--log-level a:=b"],
)
def test_an_argument_of_ros_without_a_flag_is_refused(of_ros):
    with pytest.raises(UsageError, match=f"^--ros-args {of_ros} is not available: give a"):
        without_ros_arguments(["serve", "--ros-args", *of_ros.split()])


def test_serve_takes_the_arguments_of_ros(capsys):
    command = ["serve", "--print-config", "--ros-args", "-r", "__ns:=/robot1"]
    assert main([*command, "-p", "use_sim_time:=True"]) == 0
    shown = capsys.readouterr().out
    assert 'namespace = "/robot1"  # --namespace\n' in shown
    assert "use_sim_time = true  # --set ros.use_sim_time\n" in shown
