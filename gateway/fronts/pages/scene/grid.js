// SPDX-License-Identifier: Apache-2.0
import { DoubleSide, Group, Mesh, MeshBasicMaterial, NearestFilter, PlaneGeometry, SRGBColorSpace, Texture } from "../vendor/three.js";
import { say } from "../shared/language.js";
import { LiveMap } from "../views/live_map.js";
import { palette } from "../views/occupancy.js";
import { MAP_OPTIONS } from "../views/painter.js";
import { insist } from "../views/plan.js";
import { Display, put } from "./display.js";

/** A `nav_msgs/msg/OccupancyGrid` on the floor. A costmap is a veil in one colour. */
export class GridDisplay extends Display {
  options = MAP_OPTIONS;
  #said = ""; // by what paints it
  #live = new LiveMap({ tell: (words) => (this.problem = this.#said = words), untell: (words) => words === this.#said && (this.problem = this.#said = "") }, {
    check: ({ info }) => check(info),
    colours: () => (this.look.mode === "costmap" ? veil(this.look.colour) : palette()),
    show: ({ info }, painted) => this.#lay(info, painted),
  });
  #grid = new Group();
  #sheet = new Mesh(new PlaneGeometry(1, 1), new MeshBasicMaterial({ side: DoubleSide, transparent: true, depthWrite: false }));

  constructor(context, topic, look) {
    super(context, topic, look);
    this.#sheet.renderOrder = look.mode === "costmap" ? -1 : -2; // below all else, whatever lies on it
    this.#sheet.visible = false;
    this.#grid.add(this.#sheet);
    this.object.add(this.#grid);
  }

  open() {
    super.open();
    this.#live.follow(this.context.gateway, this.topic);
  }

  show(message) {
    this.#live.take(message);
    return this.#said;
  }

  restyle() {
    this.#live.repaint();
  }

  close() {
    this.#live.close();
    super.close();
  }

  #lay({ resolution, origin }, { bitmap, cells }) {
    const { material } = this.#sheet;
    material.map?.dispose();
    material.map?.image.close();
    const texture = new Texture(bitmap);
    Object.assign(texture, { colorSpace: SRGBColorSpace, generateMipmaps: false, minFilter: NearestFilter, magFilter: NearestFilter, premultiplyAlpha: false });
    texture.repeat.y = -1; // a texture begins at the bottom, and WebGL turns no bitmap
    texture.offset.y = 1;
    texture.needsUpdate = true;
    material.map = texture;
    material.opacity = this.look.size;
    material.needsUpdate = true;
    put(this.#grid, origin);
    const [wide, high] = [bitmap.width, bitmap.height].map((pixels) => pixels * cells * resolution);
    this.#sheet.scale.set(wide, high, 1);
    this.#sheet.position.set(wide / 2, high / 2, 0);
    this.#sheet.visible = true;
    this.context.changed();
  }
}

function check({ resolution, width, height, origin: { position } }) {
  if (!(resolution > 0)) throw new RangeError(say("map.cells", { metres: resolution }));
  insist(position.x, position.y, width * resolution, height * resolution);
}

/** Return a colour for each octet of a cell: nothing where it is free or unknown. */
function veil(colour) {
  const [red, green, blue] = [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16));
  const colours = new Uint32Array(256);
  for (let value = 1; value <= 100; value += 1) colours[value] = ((Math.round(value * 2.4) << 24) | (blue << 16) | (green << 8) | red) >>> 0;
  return colours;
}
