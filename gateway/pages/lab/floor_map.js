// SPDX-License-Identifier: Apache-2.0
// The robot's map on the floor of the room, as far as ROS says where it is to the odometry.

import { CanvasTexture, Group, Mesh, MeshBasicMaterial, NearestFilter, PlaneGeometry, SRGBColorSpace } from "../vendor/three.js";
import { draw } from "../views/occupancy.js";
import { yawOf } from "../views/plan.js";
import { asRos } from "./floor.js";

const MOST_PIXELS = 1024 * 1024; // 51 x 51 m at 5 cm; drawing more would cost a headset some frames
const OCCUPIED = 65; // percent and more: what Nav2's map server takes for occupied

/** A `nav_msgs/msg/OccupancyGrid` in the room. */
export class FloorMap {
  /** Where the map's frame is to the odometry's, or null while nobody says so; then the map is hidden. */
  pose = null;
  /** How far it reaches from where the odometry began, in metres along its axes; 0 while it is hidden. */
  reach = 0;
  world = asRos(new Group());
  #frame = new Group(); // the map's frame
  #grid = new Group(); // its lower left corner
  #sheet = new Mesh(new PlaneGeometry(1, 1), new MeshBasicMaterial());
  #message = null;

  constructor() {
    this.world.position.y = -0.01; // between the floor and the lines on it
    this.world.visible = false;
    this.#grid.add(this.#sheet);
    this.#frame.add(this.#grid);
    this.world.add(this.#frame);
  }

  /**
   * Take a map.
   * @throws {RangeError} if its numbers contradict each other; then the map before stays
   */
  take(message) {
    const { canvas, cells } = draw(message, MOST_PIXELS);
    const { resolution, origin: { position, orientation } } = message.info;
    const yaw = yawOf(orientation);
    const size = resolution * cells; // of a pixel, in metres
    if (!(resolution > 0 && Number.isFinite(resolution + position.x + position.y + yaw))) throw new RangeError(`its cells are ${resolution} m wide`);
    this.#message = message;
    this.#paper(canvas);
    this.#grid.position.set(position.x, position.y, 0);
    this.#grid.rotation.z = yaw;
    this.#sheet.scale.set(canvas.width * size, canvas.height * size, 1);
    this.#sheet.position.set((canvas.width * size) / 2, (canvas.height * size) / 2, 0);
    this.#show();
  }

  /** Take where the map is to the odometry: a `translation` and a `rotation`, or null when nobody knows. */
  place(transform) {
    this.pose = transform && { x: transform.translation.x, y: transform.translation.y, yaw: yawOf(transform.rotation) };
    this.#show();
  }

  /** Draw it in the colours of the page anew. */
  paint() {
    if (this.#message) this.#paper(draw(this.#message, MOST_PIXELS).canvas);
  }

  /** How wide and high it is, in cells; 0 before there is one. */
  get size() {
    const { width = 0, height = 0 } = this.#message?.info ?? {};
    return { width, height };
  }

  /** Return why a robot cannot be sent to a place of the odometry's frame, as far as the map knows, or "". */
  refusal(place) {
    const { resolution, width, height } = this.#message.info;
    const { x, y } = this.#cornerOf(place);
    const [column, row] = [Math.floor(x / resolution), Math.floor(y / resolution)];
    if (column < 0 || row < 0 || column >= width || row >= height) return "The map ends before that place: point at a free one of the map.";
    const value = this.#message.data[row * width + column];
    if (value < 0 || value > 100) return "The map does not know that place: point at a free one.";
    return value >= OCCUPIED ? "Something stands there, by the map: point at a free place." : "";
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
  #paper(canvas) {
    const { material } = this.#sheet;
    material.map?.dispose(); // its storage has a fixed size
    const texture = new CanvasTexture(canvas);
    Object.assign(texture, { colorSpace: SRGBColorSpace, generateMipmaps: false, minFilter: NearestFilter, magFilter: NearestFilter });
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
