#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Write the libraries of the pages again, minified, from npm. Run it to raise a version.
# They are committed: a robot's network reaches no registry, and installing needs no node.
set -eu
uplot=1.6.32
three=0.187.0
esbuild=0.28.2
target=$(cd "$(dirname "$0")/.." && pwd)/gateway/fronts/pages/vendor
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
npm install --silent --no-save "uplot@$uplot" "three@$three" "esbuild@$esbuild"
from=node_modules/uplot
npx esbuild "$from/dist/uPlot.esm.js" --minify "--banner:js=/* uPlot $uplot, MIT: uplot.LICENSE */" --outfile="$target/uplot.js" --log-level=warning
cp "$from/dist/uPlot.min.css" "$target/uplot.css"
cp "$from/LICENSE" "$target/uplot.LICENSE"

# of three what the lab and the scene import, and no more
names='
  AxesHelper BoxGeometry BufferAttribute BufferGeometry CanvasTexture Color ConeGeometry CylinderGeometry DirectionalLight DoubleSide
  DynamicDrawUsage Euler GridHelper Group HemisphereLight InstancedMesh Line LineBasicMaterial LineSegments LinearFilter LoadingManager
  Matrix4 Mesh MeshBasicMaterial MeshLambertMaterial NearestFilter PerspectiveCamera PlaneGeometry Points PointsMaterial Quaternion Raycaster
  RingGeometry SRGBColorSpace Scene SphereGeometry Spherical Sprite SpriteMaterial Texture Vector2 Vector3 WebGLRenderer
'
addons='controls/OrbitControls loaders/ColladaLoader loaders/OBJLoader loaders/STLLoader'
{
    for name in $names; do echo "export { $name } from 'three';"; done
    for addon in $addons; do echo "export { ${addon#*/} } from 'three/addons/$addon.js';"; done
} >three.js
npx esbuild three.js --bundle --format=esm --minify --pure:console.debug --legal-comments=none "--banner:js=/* three $three, MIT: three.LICENSE */" --outfile="$target/three.js" --log-level=warning
# TypeScript, which reads the pages in the tests, guesses wrongly at what is minified
{
    echo '// by tools/vendor-pages.sh'
    for name in $names $addons; do echo "export const ${name#*/}: any;"; done
    for name in Group Mesh Object3D Ray Raycaster Texture Vector3 WebXRManager; do echo "export type $name = any;"; done
} >"$target/three.d.ts"
cp node_modules/three/LICENSE "$target/three.LICENSE"
(cd "$target" && sha256sum three.js uplot.css uplot.js >SHA256SUMS)
