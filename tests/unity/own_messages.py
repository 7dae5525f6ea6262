# SPDX-License-Identifier: Apache-2.0
"""Messages of other packages, as a project generates them: files, and an assembly of them."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from schemas.folders import SHIPPED
from schemas.generate.csharp_clients import files
from schemas.installed import InstalledDefinitions
from tests.schemas.generate.client_code import request_of, write_texts
from tests.unity import mono, package
from tests.unity.mono import Binary
from tests.unity.package import AssemblyDefinition, Target

PACKAGES: Final = ("control_msgs", "nav2_msgs", "tf2_msgs", "vision_msgs")
NAME: Final = "Robot.Messages"


def generated() -> list[Path]:
    """Write what a project gets, into a folder that stays. Return the sources."""
    definitions = InstalledDefinitions(folders=[SHIPPED])
    names = [name for name in definitions.all_names() if name.split("/")[0] in PACKAGES]
    texts = files(request_of(*names, definitions=definitions, asmdef=NAME))
    folder = mono.CACHE / "own_messages"
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(dir=mono.CACHE) as own:
        # other processes do the same now: each sees whole files
        return [path.replace(folder / path.name) for path in write_texts(Path(own), texts)]


def assembly(target: Target) -> Binary:
    """Compile it as its assembly definition says."""
    definitions, sources = [], []
    for path in generated():
        (definitions if path.suffix == ".asmdef" else sources).append(path)
    (definition,) = map(AssemblyDefinition.read, definitions)
    assert definition.name == NAME
    return package.compiled_definition(definition, target, sources)
