# SPDX-License-Identifier: Apache-2.0
"""Carry out docker/Dockerfile.wheels without Docker: `python -m tools.try_image FOLDER`, as root.

A tree of debootstrap stands in for `debian:bookworm-slim`. The steps of the Dockerfile run in it by
chroot. Then a simulated robot runs as its user, on a root file system that
is read-only, until the health check succeeds. FOLDER keeps the tree of debootstrap.
"""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

ROOT = Path(__file__).parents[1]
MAX_MB = 400
HEALTHY_S = 120
# Files that the slim images of Debian leave out, also of packages that are installed later.
NOT_SLIM = ("usr/share/doc", "usr/share/man", "usr/share/locale", "usr/share/info")
# Parts of this machine that a build sees, read-only: the scripts of packages write into such paths.
SEEN = {
    "/etc/resolv.conf": "/etc/resolv.conf",
    "/etc/pip.conf": "/etc/pip.conf",
    "/etc/ssl/certs/ca-certificates.crt": "/mnt/ca.crt",
    "/opt/pypi": "/opt/pypi",
    "/opt/pypi-more": "/opt/pypi-more",
}
DEVICES = ("full", "null", "random", "urandom", "zero")
PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
OF_PIP = re.compile(r"PIP_\w+|https?_proxy|HTTPS?_PROXY")


@dataclass
class Stage:
    """A stage of a Dockerfile, and what its image says about the program that it starts."""

    base: str
    name: str
    steps: list[tuple[str, str]] = field(default_factory=list)
    environment: dict[str, str] = field(default_factory=lambda: {"PATH": PATH, "HOME": "/root"})
    user: str = "0"
    folder: str = "/"
    health: list[str] = field(default_factory=list)
    command: list[str] = field(default_factory=list)

    def note(self, keyword: str, rest: str) -> None:
        """Note a step that changes no file."""
        match keyword:
            case "ENV":
                name, _, value = rest.partition("=")
                self.environment[name] = value.replace("$PATH", PATH)
            case "USER":
                self.user = rest
            case "WORKDIR":
                self.folder = rest
            case "HEALTHCHECK":
                self.health = json.loads(rest.partition("CMD ")[2])
            case "CMD":
                self.command = json.loads(rest)
            case "EXPOSE":
                pass
            case _:
                raise SystemExit(f"unknown step {keyword}: add it to tools/try_image.py")


def stages(dockerfile: str) -> list[Stage]:
    """Return the stages of a Dockerfile."""
    lines = (line for line in dockerfile.splitlines() if not line.lstrip().startswith("#"))
    found: list[Stage] = []
    for line in "\n".join(lines).replace("\\\n", " ").splitlines():
        keyword, _, rest = line.strip().partition(" ")
        if keyword == "FROM":
            base, _, name = rest.partition(" AS ")
            found.append(Stage(base, name))
        elif keyword:
            found[-1].steps.append((keyword, rest.strip()))
    return found


def carry_out(stage: Stage, tree: Path, trees: Mapping[str, Path]) -> None:
    """Carry out the steps of a stage in a tree. *trees* are those of the stages before."""
    for keyword, rest in stage.steps:
        print(f"{keyword} {rest}", flush=True)
        if keyword == "RUN":
            of_pip = {key: text for key, text in os.environ.items() if OF_PIP.fullmatch(key)}
            of_pip["PIP_CERT"] = SEEN["/etc/ssl/certs/ca-certificates.crt"]
            here = replace(stage, environment={**stage.environment, **of_pip})
            seen = [each for pair in SEEN.items() for each in shown(*pair, tree)]
            subprocess.run(chrooted(tree, rest, here, seen), check=True)
        elif keyword == "COPY":
            copy(shlex.split(rest), tree, trees)
        else:
            stage.note(keyword, rest)


def copy(words: Sequence[str], tree: Path, trees: Mapping[str, Path]) -> None:
    """Copy from the source tree or from another stage."""
    origin = ROOT
    if words[0].startswith("--from="):
        origin = trees[words[0].partition("=")[2]]
        words = words[1:]
    *sources, target = words
    for source in sources:
        path = origin / source.lstrip("/")
        to = tree / target.lstrip("/")
        if target.endswith("/"):
            to /= path.name
        to.parent.mkdir(parents=True, exist_ok=True)
        if path.is_dir():
            ignored = shutil.ignore_patterns("__pycache__") if origin == ROOT else None
            shutil.copytree(path, to, symlinks=True, ignore=ignored)
        else:
            shutil.copy(path, to)


def chrooted(tree: Path, script: str, stage: Stage, mounts: Sequence[str]) -> list[str]:
    """Return a command that runs a script in a tree, with its *mounts*."""
    mounts = [
        f"mount --bind {tree} {tree}",
        f"mount -t proc -o ro proc {tree}/proc",
        f"mount -t tmpfs tmpfs {tree}/dev",
        *(each for name in DEVICES for each in shown(f"/dev/{name}", f"/dev/{name}", tree)),
        f"mkdir -m 1777 {tree}/dev/shm",  # noqa: S108
        *mounts,
    ]
    given = [f"{name}={value}" for name, value in stage.environment.items()]
    inside = ["chroot", f"--userspec={stage.user}:{stage.user}", str(tree), "env", "-i", *given]
    inside += ["sh", "-ec", f"cd {stage.folder}; {script}"]
    all_of_it = f"{' && '.join(mounts)} && exec {shlex.join(inside)}"
    return ["unshare", "--mount", "--pid", "--fork", "--kill-child", "sh", "-c", all_of_it]


def shown(path: str, target: str, tree: Path) -> Iterator[str]:
    """Yield commands that show a path of this machine in a tree, read-only."""
    here = tree / target.lstrip("/")
    if Path(path).exists():
        yield f"mkdir -p {here}" if Path(path).is_dir() else f"touch {here}"
        yield f"mount --bind {path} {here} && mount -o remount,bind,ro {here}"


def base_tree(folder: Path) -> Path:
    """Return the tree that stands in for the base image."""
    base = folder / "base"
    if (base / "slim").exists():
        return base
    print("debootstrap, some minutes ...", flush=True)
    command = ["debootstrap", "--variant=minbase", "bookworm", str(base)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    for path in (*NOT_SLIM, "var/lib/apt/lists", "var/cache/apt/archives"):
        shutil.rmtree(base / path)
        (base / path).mkdir()
    excluded = "".join(f"path-exclude /{path}/*\n" for path in NOT_SLIM)
    (base / "etc/dpkg/dpkg.cfg.d/slim").write_text(excluded, encoding="utf-8")
    clean = 'DPkg::Post-Invoke { "rm -f /var/cache/apt/archives/*.deb /var/cache/apt/*.bin"; };\n'
    (base / "etc/apt/apt.conf.d/clean").write_text(clean, encoding="utf-8")
    (base / "slim").touch()
    return base


def megabytes(tree: Path) -> float:
    """Return the size of an image as Docker shows it: the bytes of its files."""
    command = ["du", "-sx", "--apparent-size", "--block-size=1", str(tree)]
    return int(subprocess.check_output(command, text=True).split()[0]) / 1e6


def run(stage: Stage, tree: Path) -> None:
    """Run a simulated robot on a read-only root, without a network, until it is healthy."""
    stage.environment |= {"HOME": stage.folder, "ROS_LOG_DIR": "/tmp"}  # noqa: S108
    stage.environment["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    health = shlex.join(stage.health)
    script = (
        f"{stage.command[0]} demo & until {health} 2>/dev/null; do sleep 1; done; kill $!; wait"
    )
    mounts = ["ip link set lo up", f"mount -o remount,bind,ro {tree}"]
    mounts += [f"mount -t tmpfs tmpfs {tree}/tmp"]  # noqa: S108
    command = ["unshare", "--net", *chrooted(tree, script, stage, mounts)]
    subprocess.run(command, check=True, timeout=HEALTHY_S)


def main(folder: Path) -> None:
    """Carry out the Dockerfile, print the size of its image, and try it."""
    base = base_tree(folder)
    trees: dict[str, Path] = {}
    for stage in stages((ROOT / "docker/Dockerfile.wheels").read_text(encoding="utf-8")):
        tree = folder / f"stage-{stage.name or 'last'}"
        shutil.rmtree(tree, ignore_errors=True)
        subprocess.run(["cp", "-a", trees.get(stage.base, base), tree], check=True)
        carry_out(stage, tree, trees)
        trees[stage.name] = tree
    size = megabytes(tree)
    print(f"{size:.0f} MB, at most {MAX_MB}, of which the base has {megabytes(base):.0f} MB")
    run(stage, tree)
    print("healthy, on a read-only root")
    if size > MAX_MB:
        raise SystemExit(1)


if __name__ == "__main__":
    main(Path(sys.argv[1]).absolute())
