#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Write the types of gateway.js next to it, from its JSDoc comments. A test compares them.
# Usage: sh tools/page-types.sh [VENV [DIRECTORY]]
set -eu
cd "$(dirname "$0")/.."
from=gateway/fronts/pages/shared
target=${2:-$from}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
node "${1:-.venv}/clients/typescript-5.9.3/node_modules/typescript/bin/tsc" \
    --allowJs --checkJs --declaration --emitDeclarationOnly --target es2022 --module esnext \
    --moduleResolution bundler --lib dom,dom.iterable,es2022 --outDir "$work" \
    "$from/gateway.js" "$from/graph.js" "$from/arrivals.js"
for name in gateway graph arrivals; do
    { echo '// SPDX-License-Identifier: Apache-2.0'; echo '// by tools/page-types.sh'; cat "$work/shared/$name.d.ts"; } >"$target/$name.d.ts"
done
