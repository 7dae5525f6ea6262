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


def test_a_comparison_measures_what_is_compared_by_default_and_needs_a_ratio(tmp_path, capsys):
    figures.write(tmp_path / "ref.json", [figures.ratio("odometry", "cpu", 1.0)])
    command.main(["--compare", "ref"])
    measured = [line for line in capsys.readouterr().out.splitlines() if "measuring" in line]
    assert measured == [f"measuring {name} ..." for name in COMPARED]
    assert command.main(["codec", "--compare", "ref"]) == 1
    assert "no ratio of what was measured" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("error", "order", "code", "said"),
    [
        (BenchmarkError("it has ended"), ["codec", "idle"], 1, "codec: it has ended\n"),
        (KeyboardInterrupt(), ["idle", "codec"], 130, ""),
    ],
)
def test_a_measurement_that_fails_or_is_interrupted_costs_no_figures_of_others(
    monkeypatch, tmp_path, capsys, error, order, code, said
):
    def fail(_):
        raise error

    monkeypatch.setitem(SCENARIOS, "codec", Scenario("", "", fail))
    file = tmp_path / "some.json"
    assert command.main([*order, "--json", str(file)]) == code
    assert capsys.readouterr().err.startswith(said)
    assert [one.scenario for one in figures.read(str(file))] == ["idle"]
