# SPDX-License-Identifier: Apache-2.0
"""The pages' modules, read by TypeScript: an undefined name is found without a browser."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.clients.driver import INSTALLED

ROOT = Path(__file__).parents[2]
PAGES = ROOT / "gateway/fronts/pages"
COMPILER = INSTALLED / "typescript-5.9.3/node_modules/typescript/bin/tsc"
STRICTNESS = (
    *("--allowJs", "--checkJs", "--noEmit", "--target", "es2022", "--module", "esnext"),
    *("--moduleResolution", "bundler", "--lib", "dom,dom.iterable,es2022", "--pretty", "false"),
)
# a strict program that uses the module
STRANGER = """
import { Gateway, type Status } from "SHARED/gateway.js";
const gateway = new Gateway({ address: "ws://robot:9090", token: "" });
const end: () => void = gateway.on("state", ({ state, reason }) => console.log(state, reason));
gateway.on("status", ({ msg, code }: Status) => console.log(msg, code));
gateway.subscribe("/odom", { throttle_rate: 100 }, (message, size: number) => message.pose);
const type: string = gateway.graph.typeOf("/odom");
const { topics }: { topics: string[] } = await gateway.stop();
gateway.close();
// @ts-expect-error
gateway.on("nothing", () => {});
// @ts-expect-error
gateway.subscribe("/odom");
// @ts-expect-error
new Gateway({ url: "" });
export { end, type, topics };
"""

pytestmark = pytest.mark.skipif(
    not COMPILER.exists(), reason="no TypeScript: sh tools/make-clients.sh VENV"
)


def compiled(*arguments: str) -> list[str]:
    """Return what TypeScript finds."""
    command = ["node", str(COMPILER), *STRICTNESS, *arguments]
    finished = subprocess.run(command, capture_output=True, text=True, cwd=PAGES, check=False)
    return finished.stdout.splitlines()


def test_every_module_uses_what_there_is():
    modules = [each for each in PAGES.rglob("*.js") if each.parent.name != "vendor"]
    assert len(modules) > 30
    # errors in a library are not ours. An indented line continues the line before
    found = [each for each in compiled(*map(str, modules)) if not each.startswith(("vendor/", " "))]
    assert found == []


def test_the_types_of_the_module_are_those_of_its_comments(tmp_path: Path):
    script = ["sh", str(ROOT / "tools/page-types.sh"), sys.prefix, str(tmp_path)]
    subprocess.run(script, check=True, timeout=120)
    written = sorted(tmp_path.iterdir())
    assert [path.name for path in written] == ["arrivals.d.ts", "gateway.d.ts", "graph.d.ts"]
    for path in written:
        kept = PAGES / "shared" / path.name
        assert kept.read_text() == path.read_text(), "run tools/page-types.sh"


def test_a_strict_program_compiles_with_the_types(tmp_path: Path):
    program = tmp_path / "stranger.ts"
    program.write_text(STRANGER.replace("SHARED", str(PAGES / "shared")))
    assert compiled("--strict", str(program)) == []
