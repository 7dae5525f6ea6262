// SPDX-License-Identifier: Apache-2.0
// Meshes that a robot description or a marker names: read through the gateway, never from elsewhere.

import { say } from "../shared/language.js";
import { ColladaLoader, Color, DoubleSide, Group, LoadingManager, Mesh, MeshLambertMaterial, OBJLoader, STLLoader } from "../vendor/three.js";

const GREY = { r: 0.7, g: 0.72, b: 0.75, a: 1 };
const NOTHING = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mP8/x8AAwMCAO+ip1sAAAAASUVORK5CYII=";
const TYPES = { png: "image/png", jpg: "image/jpeg", jpeg: "image/jpeg" };
const TEXT = new TextDecoder();
const MOST_OCTETS = 64 * 1024 * 1024; // of a file, as the gateway has it
const MOST_KEPT_OCTETS = 4 * MOST_OCTETS; // of all files. One that was not used for the longest time is fetched again

/** The files of one connection. */
class Files {
  #files = new Map(); // uri -> {coming, octets}, the one that was used last at the end

  get(gateway, uri) {
    const file = this.#files.get(uri) ?? { coming: read(gateway, uri), octets: 0 };
    const isNew = !this.#files.delete(uri);
    this.#files.set(uri, file);
    if (isNew) file.coming.then(({ length }) => this.#keep(file, length), () => this.#files.delete(uri)); // it may be there next time
    return file.coming;
  }

  #keep(file, octets) {
    file.octets = octets;
    let sum = [...this.#files.values()].reduce((all, each) => all + each.octets, 0);
    for (const [uri, each] of this.#files) {
      if (sum <= MOST_KEPT_OCTETS) return;
      sum -= each.octets;
      if (each.octets) this.#files.delete(uri);
    }
  }
}

/** @type {WeakMap<object, Files>} by the graph, which all that use one connection share */
const kept = new WeakMap();

/** Return the octets of a file of an installed package. */
export function fetchAsset(gateway, uri) {
  if (!kept.has(gateway.graph)) kept.set(gateway.graph, new Files());
  return kept.get(gateway.graph).get(gateway, uri);
}

async function read(gateway, uri) {
  const pieces = [];
  for (let [offset, size] = [0, 1]; offset < size; ) {
    const piece = await gateway.ask({ op: "fetch_asset", uri, offset });
    const octets = Uint8Array.from(atob(piece.data), (each) => each.charCodeAt(0));
    if (!octets.length) break;
    pieces.push(octets);
    offset += octets.length;
    size = piece.size;
    if (size > MOST_OCTETS) throw new Error(say("asset.large", { uri, size, most: MOST_OCTETS }));
  }
  const whole = new Uint8Array(pieces.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const each of pieces) {
    whole.set(each, at);
    at += each.length;
  }
  return whole;
}

/**
 * Return the mesh of a file, with a new geometry for each call.
 * @param {import("../shared/gateway.js").Gateway} gateway
 * @param {string} uri
 * @param {{r: number, g: number, b: number, a: number}|null} colour of all of it, or null for those of the file
 */
export async function meshOf(gateway, uri, colour) {
  const octets = await fetchAsset(gateway, uri);
  const kind = uri.split(".").at(-1).toLowerCase();
  if (kind === "stl") return new Mesh(new STLLoader().parse(octets.buffer), painted(colour ?? GREY));
  if (kind === "obj") return recoloured(new OBJLoader().parse(TEXT.decode(octets)), colour ?? GREY);
  if (kind !== "dae") throw new Error(say("asset.type", { uri }));
  const made = await collada(gateway, uri, TEXT.decode(octets));
  return colour ? recoloured(made, colour) : made;
}

const painted = ({ r, g, b, a }) => new MeshLambertMaterial({ color: new Color(r, g, b), opacity: a, transparent: a < 1, side: DoubleSide });

function recoloured(object, colour) {
  object.traverse((each) => {
    if (!each.isMesh) return;
    for (const material of [each.material].flat()) material.dispose();
    each.material = painted(colour);
  });
  return object;
}

/** Return what a COLLADA file holds. Its textures are files next to it. */
async function collada(gateway, uri, text) {
  const folder = uri.slice(0, uri.lastIndexOf("/") + 1);
  // a browser reads no TGA, so it is left out. Three would turn a file whose z is up, although z is up in ROS
  const plain = text.replace(/\.tga\b/gi, ".png").replace("Z_UP", "Y_UP");
  const document = new DOMParser().parseFromString(plain, "text/xml");
  const names = [...document.querySelectorAll("image init_from")].map(({ textContent }) => textContent.trim());
  const urls = new Map();
  for (const name of names) urls.set(name, await picture(gateway, folder, name));
  const manager = new LoadingManager();
  const isLoaded = new Promise((resolve) => {
    manager.onLoad = resolve;
    if (!names.length) resolve();
  });
  manager.setURLModifier((url) => urls.get(url.slice(folder.length)) ?? urls.get(url) ?? NOTHING);
  const { scene } = new ColladaLoader(manager).parse(plain, folder);
  const made = new Group();
  made.add(scene);
  for (const light of found(made, ({ isLight, isCamera }) => isLight || isCamera)) light.removeFromParent();
  isLoaded.then(() => {
    for (const url of urls.values()) if (url.startsWith("blob:")) URL.revokeObjectURL(url);
  });
  return made;
}

async function picture(gateway, folder, name) {
  const type = TYPES[name.split(".").at(-1).toLowerCase()];
  if (!type) return NOTHING;
  try {
    return URL.createObjectURL(new Blob([await fetchAsset(gateway, folder + name)], { type }));
  } catch {
    return NOTHING; // the shape alone says much
  }
}

function found(object, isWanted) {
  const all = [];
  object.traverse((each) => isWanted(each) && all.push(each));
  return all;
}
