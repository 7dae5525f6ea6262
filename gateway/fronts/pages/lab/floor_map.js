// SPDX-License-Identifier: Apache-2.0
// The robot's map on the floor of the room, as far as ROS says where it is to the odometry.

import { say } from "../shared/language.js";
import { Group, Mesh, MeshBasicMaterial, NearestFilter, PlaneGeometry, SRGBColorSpace, Texture } from "../vendor/three.js";
import { LiveMap } from "../views/live_map.js";
import { insist, yawOf } from "../views/plan.js";
import { asRos } from "./floor.js";
import { Raised, meets } from "./raised.js";

const OCCUPIED = 65; // percent and more: what Nav2's map server takes for occupied

/** A `nav_msgs/msg/OccupancyGrid` in the room. */
export class FloorMap {
  /** The pose of the map's frame in the odometry's, or null while it is unknown. Then the map is hidden. */
  pose = null;
  /** How far it reaches from where the odometry began, in metres along its axes. 0 while it is hidden. */
  reach = 0;
  world = asRos(new Group());
  #frame = new Group(); // the map's frame
  #grid = new Group(); // its lower left corner
  #sheet = new Mesh(new PlaneGeometry(1, 1), new MeshBasicMaterial());
  #raised;
  #live;
  #message = null; // the one that is shown
  #cells = 1; // of the map that a pixel is wide
  /** @type {Int8Array} */
  #values = new Int8Array(); // of the pixels

  /**
   * @param {{tell: (words: string) => void, untell: (words: string) => void}} card says why a map cannot be shown. Then the one before stays
   * @param {any} [material] of its walls and obstacles
   */
  constructor(card, material = new MeshBasicMaterial()) {
    this.#raised = new Raised(material);
    this.#live = new LiveMap(card, { check, show: (message, painted) => this.#lay(message, painted) });
    this.world.position.y = -0.01; // between the floor and the lines on it
    this.world.visible = false;
    this.#grid.add(this.#sheet, this.#raised.mesh);
    this.#frame.add(this.#grid);
    this.world.add(this.#frame);
  }

  /** Take a map, with its cells or as a picture. It is shown once it is painted. */
  take(message) {
    return this.#live.take(message);
  }

  /** Also take the updates of the topic of the map. */
  follow(gateway, topic) {
    this.#live.follow(gateway, topic);
  }

  /** Take where the map is to the odometry: a `translation` and a `rotation`, or null when nobody knows. */
  place(transform) {
    this.pose = transform && { x: transform.translation.x, y: transform.translation.y, yaw: yawOf(transform.rotation) };
    this.#show();
  }

  /** Draw it again in the colours of the page. */
  paint() {
    this.#live.repaint();
  }

  /** Return a pose of the odometry's frame as one of the map's. Only while it is shown. */
  goal({ x, y, yaw }) {
    return { ...seen(this.pose, { x, y }), yaw: yaw - this.pose.yaw, frame: this.#message.header.frame_id };
  }

  /** How wide and high it is, in cells. 0 before there is one. */
  get size() {
    const { width = 0, height = 0 } = this.#message?.info ?? {};
    return { width, height };
  }

  /** How many blocks stand on it. */
  get blocks() {
    return this.#raised.count;
  }

  /** Return whether a block stands on the way between two places of the odometry's frame, before the cell of the second. */
  hides(from, to) {
    if (!this.world.visible) return false;
    const metres = this.#message.info.resolution * this.#cells;
    const columns = Math.ceil(this.#message.info.width / this.#cells);
    const [start, end] = [from, to].map((each) => this.#cornerOf(each)).map(({ x, y }) => ({ x: x / metres, y: y / metres }));
    const last = [Math.floor(end.x), Math.floor(end.y)];
    const isOccupied = (column, row) => column >= 0 && column < columns && (column !== last[0] || row !== last[1]) && this.#values[row * columns + column] >= OCCUPIED;
    return meets(isOccupied, start, end);
  }

  /**
   * Return why a robot cannot be sent to a place of the odometry's frame, as far as the map knows, or "".
   * @param {{x: number, y: number}} place
   * @param {{x: number, y: number}} [from] the place below which a ray to it comes down to the height of the blocks
   */
  refusal(place, from = place) {
    const { resolution, width, height } = this.#message.info;
    const { x, y } = this.#cornerOf(place);
    const [column, row] = [Math.floor(x / resolution), Math.floor(y / resolution)];
    if (column < 0 || row < 0 || column >= width || row >= height) return say("floor.end");
    const [cells, columns] = [this.#cells, Math.ceil(width / this.#cells)];
    const value = this.#values[Math.floor(row / cells) * columns + Math.floor(column / cells)];
    if (value >= OCCUPIED) return say("floor.obstacle");
    if (this.hides(from, place)) return say("floor.hidden");
    return value < 0 ? say("floor.unknown") : "";
  }

  #lay(message, { bitmap, cells, values }) {
    const { resolution, origin: { position, orientation } } = message.info;
    [this.#message, this.#cells, this.#values] = [message, cells, values];
    this.#raised.build(values, bitmap.width, cells * resolution, OCCUPIED);
    this.#paper(bitmap);
    const [wide, high] = [bitmap.width, bitmap.height].map((pixels) => pixels * cells * resolution);
    this.#grid.position.set(position.x, position.y, 0);
    this.#grid.rotation.z = yawOf(orientation);
    this.#sheet.scale.set(wide, high, 1);
    this.#sheet.position.set(wide / 2, high / 2, 0);
    this.#show();
  }

  #show() {
    this.world.visible = Boolean(this.#message && this.pose);
    this.reach = 0;
    if (!this.world.visible) return;
    this.#frame.position.set(this.pose.x, this.pose.y, 0);
    this.#frame.rotation.z = this.pose.yaw;
    const { resolution, width, height } = this.#message.info;
    for (const [column, row] of [[0, 0], [width, 0], [0, height], [width, height]]) {
      const { x, y } = this.#placeOf(column * resolution, row * resolution);
      this.reach = Math.max(this.reach, Math.abs(x), Math.abs(y));
    }
  }

  /** Put a picture on the sheet. */
  #paper(bitmap) {
    const { material } = this.#sheet;
    material.map?.dispose(); // its storage has a fixed size
    material.map?.image.close();
    const texture = new Texture(bitmap);
    Object.assign(texture, { colorSpace: SRGBColorSpace, generateMipmaps: false, minFilter: NearestFilter, magFilter: NearestFilter });
    texture.repeat.y = -1; // a texture begins at the bottom, and WebGL turns no bitmap
    texture.offset.y = 1;
    texture.needsUpdate = true;
    material.map = texture;
    material.needsUpdate = true;
  }

  /** Return a place of the odometry's frame for one that is so far from the map's corner, along its rows and columns. */
  #placeOf(right, up) {
    const { position, orientation } = this.#message.info.origin;
    return moved(this.pose, moved({ x: position.x, y: position.y, yaw: yawOf(orientation) }, { x: right, y: up }));
  }

  /** Return how far a place of the odometry's frame is from the map's corner, along its rows and columns. */
  #cornerOf(place) {
    const { position, orientation } = this.#message.info.origin;
    return seen({ x: position.x, y: position.y, yaw: yawOf(orientation) }, seen(this.pose, place));
  }
}

/** Return a place of a frame that has a pose, in what the pose is given in. */
const moved = ({ x, y, yaw }, place) => ({
  x: x + Math.cos(yaw) * place.x - Math.sin(yaw) * place.y, y: y + Math.sin(yaw) * place.x + Math.cos(yaw) * place.y,
});

/** Return a place in a frame that has a pose. */
const seen = ({ x, y, yaw }, place) => {
  const [right, up] = [place.x - x, place.y - y];
  return { x: Math.cos(yaw) * right + Math.sin(yaw) * up, y: Math.cos(yaw) * up - Math.sin(yaw) * right };
};

function check({ info: { resolution, width, height, origin: { position, orientation } } }) {
  if (!(resolution > 0)) throw new RangeError(say("map.cells", { metres: resolution }));
  insist(position.x, position.y, yawOf(orientation), width * resolution, height * resolution);
}
