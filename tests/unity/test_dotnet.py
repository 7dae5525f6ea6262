# SPDX-License-Identifier: Apache-2.0
"""The client outside Unity: the page's programs compile against the project files, and run."""

import asyncio
import re
import signal
from asyncio.subprocess import PIPE, STDOUT

import pytest

from gateway.cli.certificate import make_certificate
from tests.gateway_process import gateway_process
from tests.unity import compiler, dotnet, mono, package
from tests.unity.compiler import Framework

pytestmark = [
    pytest.mark.skipif(bool(mono.missing()), reason=mono.missing()),
    pytest.mark.timeout(600),
]

TIMEOUT_S = 120
PAGE = package.CLIENT / "Documentation~/outside-unity.md"
PROGRAMS = re.findall(r"^```csharp\n(.*?)^```$", PAGE.read_text(), re.DOTALL | re.MULTILINE)
FRAMEWORKS = {"mono": Framework.of_mono, "net": Framework.of_net}


def program(number, runtime, directory):
    """Compile a program of the page, and put it into a directory. Return its command."""
    framework = FRAMEWORKS[runtime]()
    source = directory / "Program.cs"
    source.write_text(PROGRAMS[number])
    libraries = [dotnet.library(path, framework) for path in dotnet.PROJECTS.glob("*/*.csproj")]
    binary = mono.compile_assembly(
        "Program.exe", [source], references=libraries, framework=framework
    )
    dotnet.put(binary, directory)
    path = directory / "Program.exe"
    return compiler.net_command(path) if runtime == "net" else ["mono", str(path)]


async def said(command, words, env=None):
    """Run a program until it prints some words, then end it by Ctrl-C. Return what it printed."""
    process = await asyncio.create_subprocess_exec(
        *command, env={**compiler.net_environment(), **(env or {})}, stdout=PIPE, stderr=STDOUT
    )
    lines = []
    try:
        async with asyncio.timeout(TIMEOUT_S):
            while not any(re.fullmatch(words, line) for line in lines):
                line = (await process.stdout.readline()).decode()
                assert line, "".join(lines)
                lines.append(line.rstrip())
            process.send_signal(signal.SIGINT)
            # without a terminal Mono does not raise CancelKeyPress, and ends by the signal
            ends = -signal.SIGINT if command[0] == "mono" else 0
            assert await process.wait() == ends
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()
    return lines


@pytest.mark.parametrize("runtime", FRAMEWORKS)
@pytest.mark.parametrize("number", range(len(PROGRAMS)))
def test_each_program_compiles(number, runtime, tmp_path):
    assert program(number, runtime, tmp_path)


@pytest.mark.parametrize("runtime", FRAMEWORKS)
async def test_the_first_program_prints_the_place_of_the_robot_until_ctrl_c(
    runtime, tmp_path, gateway
):
    lines = await said([*program(0, runtime, tmp_path), gateway.url], r"-?\d+(\.\d+)?(E-?\d+)?")
    assert lines[0] == f"info: connected to {gateway.url}"


async def test_it_trusts_the_certificate_of_the_gateway_as_the_page_says(tmp_path):
    pytest.importorskip("cryptography")
    make_certificate(tmp_path, [])
    certificate, key = str(tmp_path / "cert.pem"), str(tmp_path / "key.pem")
    command = program(0, "net", tmp_path)
    async with gateway_process("serve", "--tls-cert", certificate, "--tls-key", key) as gateway:
        url = gateway.url.replace("127.0.0.1", "localhost")
        assert url.startswith("wss:")
        await said([*command, url], "error: .*certificate is invalid.*")
        await said([*command, url], "info: connected to .*", {"SSL_CERT_FILE": certificate})
