# SPDX-License-Identifier: Apache-2.0
"""The TypeScript of `ros2-gateway generate`, compiled by tsc: alone, with messages, with roslib."""

import json
import subprocess

import pytest

from gateway.codec.json import dumps
from gateway.codec.types import Types
from schemas.generate.typescript_clients import files, text
from schemas.generate.typescript_text import identifier
from tests.clients.driver import INSTALLED, ROSLIB_2
from tests.messages import RandomMessages, to_json
from tests.schemas.generate.client_code import (
    awkward_definitions,
    names_of_messages,
    request_of_everything,
    write_texts,
)

COMPILER = INSTALLED / "typescript-5.9.3/node_modules/typescript/bin/tsc"
TIMEOUT_S = 500
NOW_NS = 1_700_000_000_123_456_789

# The code of an application with roslib 2.
APPLICATION = """\
import { Action, Ros, Service, Topic } from "roslib";
import type * as geometry_msgs from "./geometry_msgs.js";
import type * as sensor_msgs from "./sensor_msgs.js";
import { NavSatStatus } from "./sensor_msgs.js";
import type * as std_srvs from "./std_srvs.js";
import type * as test_msgs from "./test_msgs.js";

const ros = new Ros({ url: "ws://localhost:9090" });
const twists = new Topic<geometry_msgs.Twist>({
  ros, name: "/cmd_vel", messageType: "geometry_msgs/msg/Twist" });
twists.subscribe((twist) => { const x: number = twist.linear.x ?? 0; console.log(x); });
const zero = { x: 0, y: 0, z: 0 };
twists.publish({ linear: zero, angular: { ...zero, z: null } });

const fixes = new Topic<sensor_msgs.NavSatFix>({
  ros, name: "/fix", messageType: "sensor_msgs/msg/NavSatFix" });
fixes.subscribe((fix) => console.log(fix.status.status === NavSatStatus.STATUS_NO_FIX));

const power = new Service<std_srvs.SetBool_Request, std_srvs.SetBool_Response>({
  ros, name: "/motor_power", serviceType: "std_srvs/srv/SetBool" });
power.callService({ data: true }, (response) => {
  const text: string = response.message;
  console.log(text);
});

const action = new Action<
  test_msgs.Fibonacci_Goal, test_msgs.Fibonacci_Feedback, test_msgs.Fibonacci_Result
>({ ros, name: "/fibonacci", actionType: "test_msgs/action/Fibonacci" });
action.sendGoal({ order: 3 }, (result) => console.log(result.sequence[0]), () => undefined);
"""


@pytest.fixture(scope="module", autouse=True)
def compiler():
    if not COMPILER.exists():
        pytest.skip(f"no TypeScript in {INSTALLED}: `sh tools/make-clients.sh VENV` installs it")


@pytest.fixture(scope="module")
def definitions(tmp_path_factory):
    return awkward_definitions(tmp_path_factory.mktemp("definitions"))


def compiled(folder, *sources, module="nodenext"):
    """Compile files without output. Return the output of the compiler, empty if all is well."""
    resolution = "bundler" if module == "esnext" else module
    (folder / "package.json").write_text('{"type": "module"}')
    finished = subprocess.run(
        [
            *(str(INSTALLED / "bin/node"), str(COMPILER), "--noEmit", "--strict"),
            *("--target", "es2022", "--module", module, "--moduleResolution", resolution),
            *("--isolatedModules", "--skipLibCheck"),
            *map(str, sources),
        ],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    assert bool(finished.stdout) == bool(finished.returncode)
    return finished.stdout


@pytest.mark.parametrize("wire", ["json", "cbor"])
@pytest.mark.parametrize("module", ["nodenext", "esnext"])
def test_the_modules_of_all_types_compile(definitions, tmp_path, wire, module):
    sources = write_texts(tmp_path, files(request_of_everything(definitions, wire=wire)))
    assert len(sources) > 20
    assert compiled(tmp_path, *sources, module=module) == ""


@pytest.mark.parametrize("wire", ["json", "cbor"])
def test_one_text_of_all_types_compiles(definitions, tmp_path, wire):
    made = text(request_of_everything(definitions, wire=wire))
    assert compiled(tmp_path, *write_texts(tmp_path, {"all.ts": made})) == ""


def as_sent(definitions, name, seed):
    """Return the JSON that the gateway makes of a random message."""
    message_type = Types(definitions).get(name)
    values = to_json(RandomMessages(definitions, seed, longest=2).message(name))
    return dumps(message_type.decode(message_type.encode(values, now_ns=NOW_NS))).decode()


def constant_of(name, number, value):
    package, _, short_name = name.split("/")
    return f"export const m{number}: ros.{identifier(package)}.{short_name} = {value};\n"


def test_messages_of_every_type_fit_its_interface(definitions, tmp_path):
    messages = "".join(
        constant_of(name, number, as_sent(definitions, name, number))
        for number, name in enumerate(names_of_messages(definitions))
    )
    made = {
        "all.ts": text(request_of_everything(definitions)),
        "messages.ts": f'import type * as ros from "./all.js";\n{messages}',
    }
    assert compiled(tmp_path, *write_texts(tmp_path, made)) == ""


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ({"linear": {"x": 0, "y": 0, "z": 0}}, "'angular' is missing"),
        ({"linear": "fast", "angular": {"x": 0, "y": 0, "z": 0}}, "'string' is not assignable"),
    ],
)
def test_a_message_that_does_not_fit_is_found(definitions, tmp_path, value, reason):
    line = constant_of("geometry_msgs/msg/Twist", 0, json.dumps(value))
    made = {
        "all.ts": text(request_of_everything(definitions)),
        "messages.ts": f'import type * as ros from "./all.js";\n{line}',
    }
    assert reason in compiled(tmp_path, *write_texts(tmp_path, made))


def test_roslib_takes_the_interfaces_for_topics_services_and_actions(definitions, tmp_path):
    (tmp_path / "node_modules").symlink_to(ROSLIB_2.directory / "node_modules")
    made = files(request_of_everything(definitions)) | {"application.ts": APPLICATION}
    write_texts(tmp_path, made)
    assert compiled(tmp_path, tmp_path / "application.ts", module="esnext") == ""
