# SPDX-License-Identifier: Apache-2.0
"""The wheel: complete, and of use without ROS and without this source tree."""

import json
import os
import re
import subprocess
import sys
import venv
import zipfile
from importlib.metadata import Distribution, distribution
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]
TIMEOUT_S = 400


def run(*command: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    # a ROS installation that this shell has sourced would be found through these
    environment = dict(os.environ)
    for variable in ("PYTHONPATH", "AMENT_PREFIX_PATH"):
        environment.pop(variable, None)
    return subprocess.run(
        command,
        cwd=cwd,
        env=environment,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("wheel")
    built = run(
        sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", directory, cwd=ROOT
    )
    assert built.returncode == 0, built.stderr
    (path,) = directory.glob("*.whl")
    return path


@pytest.fixture(scope="module")
def bare_venv(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a virtual environment with the wheel and what it requires, and so without ROS."""
    directory = tmp_path_factory.mktemp("venv")
    venv.create(directory, symlinks=True)
    installed = run(
        *(sys.executable, "-m", "pip", "--python", directory / "bin" / "python", "install"),
        *("--quiet", "--no-deps", "--no-index", wheel),
        cwd=directory,
    )
    assert installed.returncode == 0, installed.stderr
    (site_packages,) = directory.glob("lib/python*/site-packages")
    for required in requirements("ros2-json-gateway", found={}).values():
        for top in {file.parts[0] for file in required.files or ()} - {"..", "__pycache__"}:
            (site_packages / top).symlink_to(Path(str(required.locate_file(top))))
    return directory


def requirements(name: str, found: dict[str, Distribution]) -> dict[str, Distribution]:
    """Collect the installed distributions that *name* requires, extras left out."""
    for requirement in distribution(name).requires or ():
        needed, _, marker = requirement.partition(";")
        match = re.match(r"[\w.-]+", needed)
        assert match
        # "python_version < ..." names what this Python may well do without
        if match[0] not in found and not marker:
            found[match[0]] = distribution(match[0])
            requirements(match[0], found)
    return found


def test_the_pages_take_less_than_half_a_megabyte_of_it(wheel):
    with zipfile.ZipFile(wheel) as archive:
        pages = [
            each for each in archive.infolist() if each.filename.startswith("gateway/fronts/pages/")
        ]
    assert any(each.filename.endswith("index.html") for each in pages)
    assert sum(each.compress_size for each in pages) < 500_000


def test_the_wheel_holds_every_file_of_its_packages(wheel):
    expected = {
        str(path.relative_to(ROOT))
        for package in ("gateway", "gateway_sim", "schemas")
        for path in (ROOT / package).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    packaged = re.compile(r"(?!ros2_json_gateway-[^/]+/)")  # neither metadata nor documentation
    held = set(filter(packaged.match, zipfile.ZipFile(wheel).namelist()))
    assert held == expected
    assert "schemas/messages.toml" in held
    assert "schemas/json/nav_msgs/Odometry.json" in held
    assert "gateway_sim/fastdds_profile.xml" in held
    assert "schemas/definitions/nav2_msgs/action/NavigateToPose.action" in held


def test_the_wheel_has_licence_command_and_extra(wheel):
    archive = zipfile.ZipFile(wheel)
    held = {name.partition(".dist-info/")[2]: name for name in archive.namelist()}
    assert "Apache License" in archive.read(held["licenses/LICENSE"]).decode()
    assert "ros2-gateway = gateway.__main__:run" in archive.read(held["entry_points.txt"]).decode()
    required = [
        line
        for line in archive.read(held["METADATA"]).decode().splitlines()
        if line.startswith("Requires-Dist: ")
    ]
    ros = [line for line in required if "ros-jazzy" in line]
    assert len(ros) == 2
    assert all("extra == 'ros'" in line for line in ros)


def test_the_help_names_the_documentation_that_is_installed(bare_venv, tmp_path):
    shown = run(bare_venv / "bin" / "ros2-gateway", "--help", cwd=tmp_path).stdout
    index = Path(shown.rpartition("The documentation: ")[2].strip())
    assert index.is_relative_to(bare_venv)
    for page in ("reference/errors.md", "how-to/install.md", "tutorials/first-robot.md"):
        assert (index.parent / page).exists()


def test_without_rclpy_the_two_ways_to_get_it_are_told(bare_venv, tmp_path):
    for command in ("serve", "demo", "sim", "mock"):
        finished = run(bare_venv / "bin" / "ros2-gateway", command, cwd=tmp_path)
        assert finished.returncode == 3
        assert finished.stdout == ""
        assert finished.stderr.startswith("ros2-gateway: rclpy cannot be imported")
        assert "pip install '.[ros]'  in the source tree" in finished.stderr
        assert "source /opt/ros/" in finished.stderr
        assert "--system-site-packages" in finished.stderr


def test_without_ros_a_definition_needs_its_package_and_no_other_name(bare_venv, tmp_path):
    command = (bare_venv / "bin" / "ros2-gateway", "schema", "--definition")
    assert run(*command, "std_msgs/Header", cwd=tmp_path).returncode == 0  # it is shipped
    finished = run(*command, "xyzzy/Plugh", cwd=tmp_path)
    assert finished.returncode == 2
    assert finished.stderr == (
        "ros2-gateway: no definition of xyzzy/msg/Plugh is installed:"
        " install its package, or name a folder with its definition by --types-path\n"
    )
    misspelt = run(*command, "std_msgs/Headr", cwd=tmp_path)
    assert misspelt.stderr.endswith("is installed, did you mean std_msgs/msg/Header\n")


def test_commands_that_need_no_ros_work_without_it(bare_venv, tmp_path):
    command = bare_venv / "bin" / "ros2-gateway"
    assert run(command, "check-config", cwd=tmp_path).returncode == 0
    schema = run(command, "schema", "nav_msgs/Odometry", cwd=tmp_path)
    assert (schema.returncode, schema.stderr) == (0, "")
    commented = (ROOT / "schemas/json/nav_msgs/Odometry.json").read_text("utf-8")
    assert without_comments(schema.stdout) == without_comments(commented)


def without_comments(schema: str) -> Any:
    """Return a schema without texts: definitions that are shipped have no comments."""
    texts = {"$comment", "description"}
    return json.loads(
        schema, object_hook=lambda part: {k: v for k, v in part.items() if k not in texts}
    )


def test_clients_code_is_generated_without_ros(bare_venv, tmp_path):
    folder = tmp_path / "own_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Thing.msg").write_text("int8 x\n")
    command = (bare_venv / "bin" / "ros2-gateway", "generate")
    for language in ("csharp", "typescript", "python", "json-schema"):
        made = run(*command, language, "own_msgs/Thing", "--types-path", tmp_path, cwd=tmp_path)
        assert (made.returncode, made.stderr) == (0, "")
        assert "Thing" in made.stdout
    missing = run(*command, "python", "xyzzy/Plugh", cwd=tmp_path)
    assert missing.returncode == 2
    assert missing.stderr.startswith(
        "ros2-gateway: no definition of xyzzy/msg/Plugh is installed: install its package"
    )
