#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Write the libraries of the pages anew, minified, from npm; for who raises a version.
# They are committed: a robot's network reaches no registry, and installing needs no node.
set -eu
uplot=1.6.32
esbuild=0.28.2
target=$(cd "$(dirname "$0")/.." && pwd)/gateway/pages/vendor
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-save "uplot@$uplot" "esbuild@$esbuild"
from=node_modules/uplot
npx esbuild "$from/dist/uPlot.esm.js" --minify "--banner:js=/* uPlot $uplot, MIT: uplot.LICENSE */" --outfile="$target/uplot.js" --log-level=warning
cp "$from/dist/uPlot.min.css" "$target/uplot.css"
cp "$from/LICENSE" "$target/uplot.LICENSE"
