# SPDX-License-Identifier: Apache-2.0
"""The ROS package: `colcon build` against the wheels, and what `ros2 run` and `ros2 launch` start.

There are no wheels of ros2cli and of launch. The tests run the executables that `ros2 run` finds,
and stand-ins for launch list the nodes that the launch files start.
"""

import asyncio
import importlib.util
import os
import re
import shlex
import subprocess
import sys
import venv
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

from tests.client import client
from tests.gateway_process import gateway_process

ROOT = Path(__file__).parents[1]
COLCON = Path(sys.prefix) / "colcon"
PACKAGE = "ros2_json_gateway"
TIMEOUT_S = 300


@pytest.fixture(scope="module", params=["", "--symlink-install"], ids=["copied", "linked"])
def setup_script(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the setup.sh of a workspace whose only package is this source tree."""
    if not (COLCON / ".ready").exists():
        pytest.skip("colcon is not installed: `sh tools/make-colcon.sh .venv`")
    workspace = tmp_path_factory.mktemp("workspace")
    (workspace / "src").mkdir()
    (workspace / "src/gateway").symlink_to(ROOT)
    built = subprocess.run(
        [sys.executable, "-m", "colcon", "build", *request.param.split()],
        cwd=workspace,
        # without the interfaces of other tests, which are not a workspace
        env=os.environ
        | {
            "PYTHONPATH": str(COLCON),
            "COLCON_LOG_PATH": str(workspace / "log"),
            "AMENT_PREFIX_PATH": "",
        },
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    assert built.returncode == 0, built.stderr
    assert "WARNING" not in built.stderr  # of colcon, where a package lacks its index or manifest
    return workspace / "install/setup.sh"


def sourced(setup_script: Path, *command: str | Path, python: Path = Path(sys.prefix)) -> list[str]:
    """Return a command that runs in a shell with this workspace, and this Python before others."""
    path = f"{python / 'bin'}:{os.environ['PATH']}"
    run = f'. {shlex.quote(str(setup_script))} && PATH={shlex.quote(path)} exec "$@"'
    return ["sh", "-c", run, "sh", *map(str, command)]


def executables(setup_script: Path) -> Path:
    """Return the folder in which `ros2 run` looks, as ament's index names it."""
    look = "import ament_index_python as it; print(it.get_package_prefix('ros2_json_gateway'))"
    command = sourced(setup_script, "python", "-c", look)
    prefix = subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    assert Path(prefix).is_relative_to(setup_script.parent)
    return Path(prefix, "lib", PACKAGE)


def test_the_workspace_has_its_own_gateway(setup_script, tmp_path):
    found = executables(setup_script)
    assert {path.name for path in found.iterdir()} == {"ros2-gateway", "serve", "sim"}
    command = sourced(setup_script, "python", "-c", "import gateway; print(gateway.__file__)")
    module = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert module.stdout.startswith(str(setup_script.parents[1]))


def test_it_says_what_to_install_where_rosdep_has_no_package(setup_script, tmp_path):
    venv.create(tmp_path, symlinks=True)
    serve = sourced(setup_script, executables(setup_script) / "serve", python=tmp_path)
    finished = subprocess.run(serve, capture_output=True, text=True, check=False)
    assert finished.returncode == 1
    assert "No module named 'pydantic'): install what the gateway needs, by" in finished.stderr


class Launch:
    """Runs launch files with stand-ins for the modules of launch: it collects their nodes."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, **given: str) -> None:
        self.given = given
        self.declared: set[str] = set()
        self.nodes: list[SimpleNamespace] = []
        stand_ins = {
            "launch": {"LaunchDescription": list, "LaunchContext": Launch},
            "launch.actions": {
                "DeclareLaunchArgument": self._declare,
                "IncludeLaunchDescription": self.run,
                "OpaqueFunction": lambda function: function(self),
            },
            "launch.launch_description_sources": {"PythonLaunchDescriptionSource": Path},
            "launch.substitutions": {"LaunchConfiguration": self._configuration},
            "launch_ros.actions": {"Node": self._node},
        }
        for name, members in stand_ins.items():
            module = ModuleType(name)
            vars(module).update(members)
            monkeypatch.setitem(sys.modules, name, module)

    def run(self, path: Path) -> None:
        """Run a launch file."""
        spec = importlib.util.spec_from_file_location("launch_file", path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        module.generate_launch_description()

    def _declare(self, name: str, default_value: str, description: str) -> None:
        assert description
        self.declared.add(name)
        self.given.setdefault(name, default_value)

    def _configuration(self, name: str) -> SimpleNamespace:
        assert name in self.declared
        return SimpleNamespace(perform=lambda _: self.given[name])

    def _node(self, package: str, executable: str, output: str, arguments: Sequence[str] = ()):
        assert (package, output) == (PACKAGE, "screen")
        # launch_ros ends each command so
        command = [executable, *arguments, "--ros-args"]
        self.nodes.append(command)
        return command


def launched(setup_script: Path, name: str, launch: Launch) -> list[list[str]]:
    """Return the commands that a launch file of the workspace starts."""
    folder = executables(setup_script)
    launch.run(folder.parents[1] / "share" / PACKAGE / "launch" / name)
    return [sourced(setup_script, folder / name, *arguments) for name, *arguments in launch.nodes]


def test_each_argument_of_the_launch_file_is_a_setting(setup_script, monkeypatch, tmp_path):
    file = tmp_path / "gateway.toml"
    file.write_text("[limits]\nmax_clients = 7\n")
    values = {"port": "21201", "lan": "true", "namespace": "/robot1", "log_level": "debug"}
    launch = Launch(monkeypatch, config=str(file), **values)
    (serve,) = launched(setup_script, "gateway.launch.py", launch)
    assert launch.given.keys() == launch.declared
    command = [*serve, "--", "--print-config"]
    shown = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    given = [line.partition("  # ") for line in shown.splitlines()]
    assert {setting for setting, mark, source in given if mark and source != "default"} == {
        *("port = 21201", "lan = true", 'namespace = "/robot1"', 'level = "debug"'),
        "max_clients = 7",
    }


def test_the_page_names_the_versions_that_the_gateway_needs():
    text = (ROOT / "pyproject.toml").read_text("utf-8").partition("dependencies = [")[2]
    needed = re.findall(r'^  "([\w-]+)>=([\d.]+)",$', text.partition("\n]")[0], re.MULTILINE)
    page = (ROOT / "docs/how-to/workspace.md").read_text("utf-8")
    rows = re.findall(r"^\| `([\w-]+)` \| .* \| ([\d.]+) \|$", page, re.MULTILINE)
    assert rows == needed


async def test_a_launch_file_starts_a_robot_and_the_gateway(setup_script, monkeypatch):
    robot, serve = launched(setup_script, "demo.launch.py", Launch(monkeypatch))
    assert serve[-2:] == [str(executables(setup_script) / "serve"), "--ros-args"]
    simulated = await asyncio.create_subprocess_exec(*robot)
    try:
        async with (
            gateway_process(program=[*serve, "--"]) as gateway,
            client(gateway.url) as speaker,
        ):
            await speaker.send(op="subscribe", topic="/odom", type="nav_msgs/msg/Odometry")
            await speaker.message("/odom")
    finally:
        simulated.terminate()
        await simulated.wait()
