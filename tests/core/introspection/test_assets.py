# SPDX-License-Identifier: Apache-2.0
import base64
import os
import threading

import pytest

from gateway.core.introspection import assets
from tests.clock import StoppedClock
from tests.core.conftest import Bench

MESH = bytes(range(256)) * 300  # 76.8 kB, three chunks
UPPER = "package://arm/meshes/upper.stl"


@pytest.fixture
def share(tmp_path, monkeypatch):
    """Return the folder of a package in the second of two prefixes."""
    share = tmp_path / "robot/share/arm"
    (share / "meshes").mkdir(parents=True)
    (share / "meshes/upper.stl").write_bytes(MESH)
    (share / "package.xml").write_text("<package/>")
    (tmp_path / "overlay/share/other").mkdir(parents=True)
    prefixes = (tmp_path / "overlay", tmp_path / "robot")
    monkeypatch.setenv("AMENT_PREFIX_PATH", os.pathsep.join(map(str, prefixes)))
    return share


@pytest.fixture
def fifo(share):
    """A FIFO: opening it blocks until the test has ended."""
    path = share / "meshes/fifo.stl"
    os.mkfifo(path)
    yield
    os.close(os.open(path, os.O_RDWR | os.O_NONBLOCK))


async def fetched(bench: Bench, **members) -> dict:
    client = bench.sender(op="fetch_asset", id="a", **members)
    (answer,) = await client.sees(1, "fetch_asset")
    return answer


async def refused(bench: Bench, **members) -> tuple[str, str]:
    client = bench.sender(op="fetch_asset", id="a", **members)
    ((identifier, code, text),) = [
        (f["id"], f["code"], f["msg"]) for f in await client.sees(1, "status")
    ]
    assert identifier == "a"
    return code, text


async def test_a_mesh_comes_in_chunks_which_are_the_file(bench: Bench, share):
    got, sizes = b"", []
    while len(got) < len(MESH):
        answer = await fetched(bench, uri=UPPER, offset=len(got))
        assert (answer["id"], answer["uri"], answer["offset"], answer["size"]) == (
            *("a", UPPER, len(got)),
            len(MESH),
        )
        chunk = base64.b64decode(answer["data"], validate=True)
        sizes.append(len(chunk))
        got += chunk
    assert got == MESH
    assert sizes == [32 * 1024, 32 * 1024, len(MESH) - 64 * 1024]


async def test_without_an_offset_it_begins_at_the_start_and_at_its_end_is_nothing(
    bench: Bench, share
):
    first = await fetched(bench, uri=UPPER)
    assert base64.b64decode(first["data"]) == MESH[: 32 * 1024]
    end = await fetched(bench, uri=UPPER, offset=len(MESH))
    assert (end["data"], end["size"]) == ("", len(MESH))


@pytest.mark.parametrize("suffix", assets.SUFFIXES)
async def test_models_and_pictures_are_given_however_their_names_are_written(
    bench: Bench, share, suffix
):
    name = f"With Space{suffix.upper()}"
    (share / name).write_bytes(b"model")
    answer = await fetched(bench, uri=f"package://arm/{name.replace(' ', '%20')}")
    assert base64.b64decode(answer["data"]) == b"model"


async def test_the_first_prefix_that_has_the_package_counts(bench: Bench, share, tmp_path):
    (tmp_path / "overlay/share/arm/meshes").mkdir(parents=True)
    (tmp_path / "overlay/share/arm/meshes/upper.stl").write_bytes(b"overlay")
    first = MESH[: 32 * 1024]
    assert base64.b64decode((await fetched(bench, uri=UPPER))["data"]) == first  # no package yet
    (tmp_path / "overlay/share/arm/package.xml").write_text("<package/>")
    assert base64.b64decode((await fetched(bench, uri=UPPER))["data"]) == b"overlay"
    below = await fetched(bench, uri=f"file://{share}/meshes/upper.stl")
    assert base64.b64decode(below["data"]) == first


async def test_a_link_in_the_package_is_followed_as_colcon_makes_them(bench, share, tmp_path):
    (tmp_path / "source.stl").write_bytes(b"source")
    (share / "linked.stl").symlink_to(tmp_path / "source.stl")
    assert base64.b64decode((await fetched(bench, uri="package://arm/linked.stl"))["data"]) == (
        b"source"
    )


async def test_a_file_uri_of_xacro_is_the_file_of_the_package(bench: Bench, share):
    answer = await fetched(bench, uri=f"file://{share}/meshes/upper.stl")
    assert base64.b64decode(answer["data"]) == MESH[: 32 * 1024]


@pytest.mark.parametrize("written", ["my ws", "my%20ws"])
async def test_a_file_address_may_be_quoted_or_as_xacro_writes_it(
    bench: Bench, tmp_path, monkeypatch, written
):
    share = tmp_path / "my ws/share/arm"
    share.mkdir(parents=True)
    (share / "package.xml").write_text("<package/>")
    (share / "100%25.stl").write_bytes(b"literal")
    (share / "100%.stl").write_bytes(b"unquoted")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "my ws"))
    answer = await fetched(bench, uri=f"file://{tmp_path}/{written}/share/arm/100%25.stl")
    expected = b"literal" if written == "my ws" else b"unquoted"
    assert base64.b64decode(answer["data"]) == expected


async def test_no_other_file_is_given(bench: Bench, share, tmp_path):
    (tmp_path / "secret.stl").write_bytes(b"secret")
    inside = f"file://{share}"
    for uri in (f"file://{tmp_path}/secret.stl", f"{inside}/../../../secret.stl", f"{inside}.stl"):
        assert (await refused(bench, uri=uri))[0] == "bad_name"


@pytest.mark.parametrize(
    "uri",
    [
        "",
        "upper.stl",
        "file:///etc/passwd.stl",
        "http://arm/upper.stl",
        "package://",
        "package://arm",
        "package:///meshes/upper.stl",
        "package://../arm/meshes/upper.stl",
        "package://%2e%2e/upper.stl",
        "package://arm/",
        "package://arm//etc/passwd.stl",
        "package://arm/../arm/meshes/upper.stl",
        "package://arm/meshes/%2e%2e/%2E%2E/arm/meshes/upper.stl",
        "package://arm/./meshes/upper.stl",
        "package://arm/package.xml",
        "package://arm/config/tokens.yaml",
        "package://arm/meshes/upper.stl/",
        "package://arm/meshes/upper.stl?x=1",
    ],
)
async def test_a_uri_of_another_kind_of_file_is_refused(bench: Bench, share, uri):
    code, text = await refused(bench, uri=uri)
    assert code == "bad_name"
    assert uri in text


@pytest.mark.parametrize(
    ("uri", "words"),
    [
        ("package://leg/upper.stl", "the gateway's machine has no package leg"),
        (f"package://{'a' * 255}/upper.stl", "has no package aaa"),
        ("package://arm/meshes/lower.stl", "no such file"),
        ("package://arm/meshes/folder.stl", "not a regular file"),
        ("package://arm/meshes/fifo.stl", "not a regular file"),
        ("package://arm/meshes/upper.stl/x.stl", "no such file"),
        ("package://arm/%00.stl", "no such file"),
        (f"package://arm/{'x' * 4000}.stl", "no such file"),
    ],
)
async def test_a_missing_file_is_refused_with_the_reason(bench: Bench, share, fifo, uri, words):
    (share / "meshes/folder.stl").mkdir()
    code, text = await refused(bench, uri=uri)
    assert code == "not_found"
    assert words in text
    assert len(text) < 500


async def test_an_offset_beyond_the_end_is_refused(bench: Bench, share):
    code, text = await refused(bench, uri=UPPER, offset=len(MESH) + 1)
    assert code == "invalid_value"
    assert f"at most {len(MESH)}" in text


@pytest.mark.parametrize(
    "members", [{}, {"uri": UPPER, "offset": -1}, {"uri": 7}, {"uri": "x" * 4097}]
)
async def test_an_invalid_request_is_refused(bench: Bench, share, members):
    assert (await refused(bench, **members))[0] == "bad_request"


async def test_a_file_that_is_too_large_is_refused(bench: Bench, share):
    with (share / "meshes/upper.stl").open("r+b") as mesh:
        mesh.truncate(64 * 1024 * 1024)
    assert (await fetched(bench, uri=UPPER))["size"] == 64 * 1024 * 1024
    with (share / "meshes/upper.stl").open("r+b") as mesh:
        mesh.truncate(64 * 1024 * 1024 + 1)
    code, text = await refused(bench, uri=UPPER)
    assert code == "limit_exceeded"
    assert "67108865 bytes, at most 67108864" in text


async def test_a_disk_that_does_not_answer_is_waited_for_no_longer_than_a_client_waits(
    bench: Bench, share, monkeypatch
):
    goes_on = threading.Event()
    monkeypatch.setattr(assets, "ANSWER_S", 0.1)
    monkeypatch.setattr(assets, "read", lambda *_: goes_on.wait())
    try:
        code, text = await refused(bench, uri=UPPER)
    finally:
        goes_on.set()
    assert code == "timeout"
    assert "the disk is slow" in text


async def test_a_client_hears_within_8_s_of_a_disk_that_does_not_answer(
    bench: Bench, share, monkeypatch
):
    goes_on = threading.Event()
    monkeypatch.setattr(assets, "read", lambda *_: goes_on.wait())
    client = bench.client()
    clock = StoppedClock(monkeypatch)
    client.send(op="fetch_asset", uri=UPPER)
    await clock.advance(0)
    await clock.advance(7.9)
    assert client.statuses == []
    await clock.advance(0.2)
    goes_on.set()
    assert [code for code, _ in client.statuses] == ["timeout"]


async def test_an_address_has_as_many_characters_as_a_path_at_most(bench: Bench, share):
    code, _ = await refused(bench, uri=UPPER.ljust(4096, "x"))
    assert code == "bad_name"
    code, _ = await refused(bench, uri=UPPER.ljust(4097, "x"))
    assert code == "bad_request"
