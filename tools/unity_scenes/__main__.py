# SPDX-License-Identifier: Apache-2.0
"""Write the Unity packages' prefabs and scenes: ``python -m tools.unity_scenes``.

With ``--check`` it compares. Their metas are written by ``python -m tools.unity_metas``, which
comes after it.
"""

import argparse
import sys
from pathlib import Path

from tools.unity_metas import HOME
from tools.unity_scenes.prefabs import prefabs
from tools.unity_scenes.scenes import scenes


def main(arguments: list[str] | None = None) -> int:
    """Write what differs and remove what is no longer made, or with ``--check`` report it."""
    parser = argparse.ArgumentParser(description="Write the Unity packages' prefabs and scenes.")
    parser.add_argument("--check", action="store_true", help="change nothing, exit 1 if needed")
    check = parser.parse_args(arguments).check
    wanted = files()
    stale = set(HOME.rglob("*.prefab")) - set(wanted)
    changed = [path for path in wanted if not path.exists() or path.read_text() != wanted[path]]
    for path in sorted([*changed, *stale]):
        print(("differs: " if check else "wrote ") + str(path.relative_to(HOME)))  # noqa: T201
    if check:
        return 1 if changed or stale else 0
    for path in changed:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(wanted[path])
    for path in stale:
        path.unlink()
    return 0


def files() -> dict[Path, str]:
    """Return every file that is generated, and its text."""
    return {**dict(prefabs()), **dict(scenes())}


if __name__ == "__main__":
    sys.exit(main())
