# SPDX-License-Identifier: Apache-2.0
"""The C# of `ros2-gateway generate`, compiled as a Unity project would, and asked for messages."""

import pytest

from gateway.codec.json import dumps, loads
from gateway.codec.types import Types
from schemas.folders import SHIPPED
from schemas.generate.csharp_clients import files, text
from schemas.generate.csharp_table import table_source
from schemas.installed import InstalledDefinitions, installed_prefixes
from tests.messages import RandomMessages, to_json
from tests.schemas.generate.client_code import (
    names_of_messages,
    request_of_everything,
    write_awkward,
    write_texts,
)
from tests.unity import mono, package
from tests.unity.probe import Probe, Refusal

pytestmark = pytest.mark.skipif(mono.missing() != "", reason=mono.missing())

RUNTIME = package.CLIENT / "Runtime"
CATALOGUE = RUNTIME / "Messages/MessageCatalogue.cs"
NOW_NS = 1_700_000_000_123_456_789


@pytest.fixture(scope="module")
def definitions(tmp_path_factory):
    """Return the awkward, all that is installed, and all that comes with the gateway."""
    prefix = tmp_path_factory.mktemp("definitions")
    write_awkward(prefix)
    return InstalledDefinitions([prefix, *installed_prefixes()], [SHIPPED])


def runtime():
    """Return the sources that messages need next to themselves."""
    return sorted((RUNTIME / "Json").glob("*.cs"))


@pytest.mark.parametrize("write", [files, lambda request: {"All.cs": text(request)}])
def test_all_types_compile_next_to_the_package(definitions, tmp_path, write):
    messages = package.compiled("Ros2Gateway.Messages", package.EDITOR)
    sources = write_texts(tmp_path, write(request_of_everything(definitions)))
    assert mono.compile_assembly("Mine", sources, references=list(messages.closure())).path.exists()


@pytest.fixture(scope="module")
def probe(definitions, tmp_path_factory):
    """Return the classes of all types without those of the package, and what makes them by name."""
    request = request_of_everything(definitions, complete=True)
    table = {"MessageTable.cs": table_source(request.catalogue, ())}
    made = write_texts(tmp_path_factory.mktemp("all"), files(request) | table)
    probe = Probe(mono.compile_assembly("Mine", sorted([*runtime(), CATALOGUE, *made])))
    yield probe
    probe.close()


def test_a_message_of_every_type_comes_back_as_it_went(definitions, probe):
    types = Types(definitions)
    names = names_of_messages(definitions)
    sent = []
    for name in names:
        values = to_json(RandomMessages(definitions, 1, longest=2).message(name))
        sent.append(types.get(name).encode(values, now_ns=NOW_NS))
    asked = [(f"read:{n}", dumps(types.get(n).decode(c))) for n, c in zip(names, sent, strict=True)]
    for name, cdr, answer in zip(names, sent, probe.ask_all(asked), strict=True):
        assert not isinstance(answer, Refusal), (name, answer)
        assert types.get(name).encode(loads(answer), now_ns=0) == cdr


def test_one_text_of_all_types_compiles_without_those_of_the_package(definitions, tmp_path):
    request = request_of_everything(definitions, complete=True)
    made = write_texts(tmp_path, {"All.cs": text(request)})
    assert mono.compile_assembly("Mine", sorted([*runtime(), *made])).path.exists()
