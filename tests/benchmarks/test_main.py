# SPDX-License-Identifier: Apache-2.0
"""The command line refuses what makes no sense by exit code 2. A failed comparison ends by 1."""

import os
import signal
import socket

import pytest

from benchmarks import __main__ as command
from benchmarks import figures
from benchmarks.catalogue import COMPARED, SCENARIOS, Scenario
from benchmarks.errors import BenchmarkError


@pytest.fixture(autouse=True)
def nothing_is_measured(monkeypatch, tmp_path):
    """Make scenarios return one ratio, and undo changes of the command line to this process."""
    monkeypatch.setattr(figures, "REFERENCES", tmp_path)
    for name in ("ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE"):
        monkeypatch.setenv(name, os.environ.get(name, ""))
    for name in SCENARIOS:
        fake = Scenario("", "", lambda _, name=name: [figures.ratio(name, "cpu", 1.0)])
        monkeypatch.setitem(SCENARIOS, name, fake)
    before = signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGTERM, before)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["odometri"], "unknown WHAT: odometri"),
        (["--compare", "missing"], "no stored figures missing"),
        (["--rounds", "0"], "need a number above 0"),
        (["--seconds", "x"], "invalid number"),
        (["--beside", "server"], "give both"),
        (["--beside-port", "9090"], "give both"),
        (["--beside", "", "--beside-port", "9"], "name a command"),
        (["--beside", "a 'b", "--beside-port", "9"], "No closing quotation"),
        (["--json", "/"], "is a directory"),
        (["--json", "/nowhere/at/all.json"], "no directory /nowhere/at"),
    ],
)
def test_senseless_options_are_refused(arguments, reason, capsys):
    with pytest.raises(SystemExit) as ended:
        command.main(arguments)
    assert ended.value.code == 2
    assert reason in capsys.readouterr().err


def test_a_port_that_is_taken_is_refused(capsys):
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = str(other.getsockname()[1])
        with pytest.raises(SystemExit) as ended:
            command.main(["--beside", "server", "--beside-port", port])
    assert ended.value.code == 2
    assert f"port {port} is taken" in capsys.readouterr().err


def test_help_names_everything_that_can_be_measured(capsys):
    with pytest.raises(SystemExit):
        command.main(["--help"])
    shown = capsys.readouterr().out
    assert all(name in shown for name in SCENARIOS)


def test_figures_are_written_whole(tmp_path):
    file = tmp_path / "some.json"
    file.write_text("what was there")
    assert command.main(["codec", "idle", "--json", str(file)]) == 0
    assert [one.scenario for one in figures.read(str(file))] == ["codec", "idle"]


@pytest.mark.parametrize(("stored", "code"), [(1.0, 0), (0.5, 1), (2.0, 0)])
def test_a_comparison_fails_where_a_ratio_is_worse(tmp_path, stored, code, capsys):
    figures.write(tmp_path / "ref.json", [figures.ratio("odometry", "cpu", stored)])
    assert command.main(["--compare", "ref"]) == code
    assert ("WORSE" in capsys.readouterr().out) == bool(code)


def test_a_comparison_measures_what_is_compared_by_default(tmp_path, capsys):
    figures.write(tmp_path / "ref.json", [figures.ratio("odometry", "cpu", 1.0)])
    command.main(["--compare", "ref"])
    measured = [line for line in capsys.readouterr().out.splitlines() if "measuring" in line]
    assert measured == [f"measuring {name} ..." for name in COMPARED]


def test_a_comparison_with_nothing_in_common_fails(tmp_path, capsys):
    figures.write(tmp_path / "ref.json", [figures.ratio("odometry", "cpu", 1.0)])
    assert command.main(["codec", "--compare", "ref"]) == 1
    assert "no ratio of what was measured" in capsys.readouterr().err


def test_a_measurement_that_fails_is_said_in_one_line_and_costs_no_other(
    monkeypatch, tmp_path, capsys
):
    def fail(_):
        raise BenchmarkError("client has ended unexpectedly")

    monkeypatch.setitem(SCENARIOS, "codec", Scenario("", "", fail))
    file = tmp_path / "some.json"
    assert command.main(["codec", "idle", "--json", str(file)]) == 1
    assert capsys.readouterr().err == "codec: client has ended unexpectedly\n"
    assert [one.scenario for one in figures.read(str(file))] == ["idle"]


def test_the_figures_so_far_are_written_at_ctrl_c(monkeypatch, tmp_path):
    def interrupt(_):
        raise KeyboardInterrupt

    monkeypatch.setitem(SCENARIOS, "codec", Scenario("", "", interrupt))
    file = tmp_path / "some.json"
    assert command.main(["idle", "codec", "--json", str(file)]) == 130
    assert [one.scenario for one in figures.read(str(file))] == ["idle"]
