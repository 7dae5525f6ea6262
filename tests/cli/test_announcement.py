# SPDX-License-Identifier: Apache-2.0
import io
import json
import os
import pwd
import shlex
import stat
from pathlib import Path

import pytest

from gateway.access.posture import Posture
from gateway.access.token_file import default_path
from gateway.app import Listening
from gateway.cli import announcement
from gateway.cli import tokens as tokens_module
from gateway.cli.announcement import filled, own_url, qr_code, qr_text
from gateway.cli.tokens import kept_from_logs
from tests.doc_blocks import texts

LAN = (("0.0.0.0", 9090), ("::", 9090))  # noqa: S104  # of a text, not bound
HERE = (("127.0.0.1", 9090),)
TOKENS = default_path(os.environ)
HOME = "192.168.1.7"


def listening(
    addresses=LAN,
    anonymous_role=None,
    new_token=None,
    certificate=None,
    path="/",
    tokens=TOKENS,
) -> Listening:
    is_open = addresses[:1] != HERE
    posture = Posture(tuple(host for host, _ in addresses), is_open, anonymous_role)
    return Listening(addresses, path, posture, tokens, new_token, certificate)


@pytest.fixture(autouse=True)
def home(monkeypatch):
    monkeypatch.setattr(announcement, "own_addresses", lambda: [HOME])


@pytest.mark.parametrize("addresses", [HERE, (*HERE, ("::1", 9090))])
def test_on_this_machine_alone_it_is_one_line(addresses):
    lines = announcement.announcement(listening(addresses, "admin"))
    assert lines == "listening on ws://127.0.0.1:9090/"


def test_a_new_token_is_in_lines_for_wscat_and_unity():
    lines = announcement.announcement(listening(new_token="r2g_x")).splitlines()  # noqa: S106
    assert lines == [
        "listening on every network of this machine, port 9090",
        "  on this machine   ws://localhost:9090/",
        f"  from a headset    ws://{HOME}:9090/",
        (
            "other machines can connect, so clients need a token."
            " This one is for an operator, and shown only once:"
        ),
        f"  wscat   npx wscat -c ws://{HOME}:9090/ -H 'Authorization: Bearer r2g_x'",
        f"  Unity   Address: ws://{HOME}:9090/   Token: r2g_x",
        f"  more    ros2-gateway token create NAME --role viewer, then kill -HUP {os.getpid()}",
    ]


def test_the_page_about_the_network_shows_these_lines():
    shown = texts("how-to/open-to-network.md", "text")[0].strip()
    lines = announcement.announcement(listening(new_token="r2g_..."))  # noqa: S106
    assert shown == lines.replace(f"kill -HUP {os.getpid()}", "kill -HUP 1234")


def test_another_file_of_tokens_is_named():
    lines = announcement.announcement(listening(tokens=Path("/conf/my tokens.json")))
    create = "ros2-gateway token --file '/conf/my tokens.json' create NAME --role viewer"
    assert lines.endswith(f"  more    {create}, then kill -HUP {os.getpid()}")


@pytest.mark.parametrize(
    ("cgroup", "apply"),
    [
        ("0::/system.slice/robot.service\n", "systemctl reload robot"),
        ("0::/\n", "kill -HUP {pid}"),
    ],
)
def test_the_log_of_a_service_names_the_commands_that_work_for_that_service(
    tmp_path, monkeypatch, cgroup, apply
):
    monkeypatch.setenv("NOTIFY_SOCKET", "/run/systemd/notify")
    monkeypatch.setattr(tokens_module, "_CGROUP", tmp_path / "cgroup")
    (tmp_path / "cgroup").write_text(cgroup)
    path = tmp_path / "tokens.json"
    last = announcement.announcement(listening(tokens=path)).splitlines()[-1]
    user = pwd.getpwuid(os.geteuid()).pw_name
    create = f"sudo -u {user} {shlex.join(tokens_module.own_command())} token --file {path} create"
    apply = apply.format(pid=os.getpid())
    assert last == f"  more    {create} NAME --role viewer, then sudo {apply}"


def test_a_new_token_is_not_shown_on_an_output_that_may_be_a_log(tmp_path):
    with_token = listening(new_token="r2g_x", tokens=tmp_path / "tokens.json")  # noqa: S106
    kept = kept_from_logs(with_token, io.StringIO())
    path = tmp_path / "first-token"
    assert (path.read_text(), stat.S_IMODE(path.stat().st_mode)) == ("r2g_x\n", 0o600)
    text = announcement.announcement(kept) + filled("WSCAT PAGE", kept)
    assert "r2g_x" not in text
    assert f'-H "Authorization: Bearer $(cat {path})"' in text
    assert f"A new one, for an operator, is in {path}\n" in text


def test_a_new_token_that_cannot_be_kept_is_not_shown_either(caplog):
    with_token = listening(new_token="r2g_x", tokens=Path("/proc/none/tokens.json"))  # noqa: S106
    kept = kept_from_logs(with_token, io.StringIO())
    text = announcement.announcement(kept) + filled("WSCAT PAGE", kept) + caplog.text
    assert "r2g_x" not in text
    assert "cannot write /proc/none/first-token, no such file or directory" in text
    assert "make another by ros2-gateway token --file /proc/none/tokens.json create NAME" in text


def test_without_a_network_it_says_how_to_find_an_address(monkeypatch):
    monkeypatch.setattr(announcement, "own_addresses", list)
    line = announcement.announcement(listening()).splitlines()[2]
    assert line.startswith("  from a headset    ws://ADDRESS:9090/ ")
    assert "`ip -br address`" in line


def test_a_token_that_is_kept_as_a_hash_has_a_place_in_the_lines():
    lines = announcement.announcement(listening())
    assert f"The hashes of the valid ones are in {TOKENS}" in lines
    assert "Bearer TOKEN'" in lines
    assert "Token: TOKEN\n" in lines


@pytest.mark.parametrize(
    ("role", "what"),
    [("viewer", "watch"), ("operator", "drive the robot"), ("admin", "everything")],
)
def test_an_open_gateway_without_tokens_says_what_everybody_may_do(role, what):
    last = announcement.announcement(listening(anonymous_role=role)).splitlines()[-1]
    assert last.startswith("WARNING: without a token, everybody on the network may")
    assert last.endswith(what)


def test_with_a_certificate_all_addresses_are_encrypted():
    lines = announcement.announcement(listening(certificate="/conf/my cert.pem"))
    assert "ws://" not in lines.replace("wss://", "")
    assert "--ca '/conf/my cert.pem'" in lines


@pytest.mark.parametrize(
    ("addresses", "url"),
    [
        (HERE, "ws://localhost:9090/"),
        (LAN, "ws://localhost:9090/"),
        ((("::1", 1),), "ws://[::1]:1/"),
        ((("192.168.1.7", 1),), "ws://192.168.1.7:1/"),
    ],
)
def test_the_address_on_this_machine_can_be_typed(addresses, url):
    assert own_url(listening(addresses, "admin")) == url


def test_the_command_for_this_machine_has_the_token():
    here = listening(HERE, "admin")
    assert filled("WSCAT", here) == "npx wscat -c ws://localhost:9090/"
    assert filled("PAGE", here) == "http://localhost:9090/"
    assert filled("PAGE", listening(certificate="c", path="/ros")) == "https://localhost:9090/"
    assert filled("PAGE", listening(new_token="r2g_x")).endswith("/#token=r2g_x")  # noqa: S106
    assert filled("WSCAT", listening(new_token="r2g_x")).endswith("Bearer r2g_x'")  # noqa: S106


@pytest.mark.parametrize(
    ("given", "addresses", "text"),
    [
        (listening(), [HOME], f"http://{HOME}:9090/"),
        (listening(new_token="r2g_x"), [HOME], f"http://{HOME}:9090/#token=r2g_x"),  # noqa: S106
        (listening(certificate="c", path="/ros"), [HOME], f"https://{HOME}:9090/ros"),
        (listening((("192.168.1.9", 1),)), [HOME], "http://192.168.1.9:1/"),
        (listening((("fd00::1", 1),)), [HOME], "http://[fd00::1]:1/"),
        (listening(), [], None),
    ],
)
def test_the_qr_code_is_a_web_address_whose_fragment_alone_has_the_token(given, addresses, text):
    assert qr_text(given, addresses) == text


def test_a_qr_code_fits_a_terminal():
    drawn = qr_code(f"http://{HOME}:9090/#token=r2g_" + "x" * 43).splitlines()
    assert len(drawn) < 24
    assert max(map(len, drawn)) < 80


def test_in_json_each_line_is_an_object_with_the_address():
    there = listening(anonymous_role="viewer")
    text = f"{announcement.announcement(there)}\n{filled('into WSCAT', there)}"
    lines = [json.loads(line) for line in announcement.in_json(there, text)]
    shown = announcement.announcement(there).splitlines()
    messages = [line["message"] for line in lines]
    assert messages[:-2] == [line.strip() for line in shown[:-1]]
    assert messages[-2:] == [
        "without a token, everybody on the network may watch",
        "into npx wscat -c ws://localhost:9090/",
    ]
    assert [line["level"] for line in lines] == ["info"] * len(shown[:-1]) + [
        "warning",
        "info",
    ]
    assert {line["url"] for line in lines} == {"ws://localhost:9090/"}
