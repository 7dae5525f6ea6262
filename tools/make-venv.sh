#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Make a virtual environment with pip in it: make-venv.sh DIRECTORY
# PYTHON=/path/to/python3.12 chooses the interpreter.
set -eu
directory=$1

# The rclpy wheels exist for CPython up to 3.14. The code needs 3.10.
fits() {
    "$1" -c 'import sys; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 14))' 2>/dev/null
}

python=${PYTHON:-}
if [ -z "$python" ]; then
    for candidate in python3 python3.12 python3.13 python3.11 python3.14 python3.10; do
        if fits "$candidate"; then
            python=$candidate
            break
        fi
    done
fi
if [ -z "$python" ] || ! fits "$python"; then
    echo "need Python 3.10 to 3.14, found ${python:-none}. On Debian or Ubuntu, run:" >&2
    echo "  sudo apt install python3 python3-venv" >&2
    exit 1
fi

# Debian and Ubuntu ship Python without the part that puts pip into a venv.
if "$python" -c 'import venv, ensurepip' 2>/dev/null; then
    "$python" -m venv "$directory"
elif command -v uv >/dev/null; then
    uv venv --quiet --seed --python "$python" "$directory"
elif command -v virtualenv >/dev/null; then
    virtualenv --quiet --python "$python" "$directory"
else
    echo "$python cannot make virtual environments. On Debian or Ubuntu, run:" >&2
    echo "  sudo apt install python3-venv" >&2
    exit 1
fi
