// SPDX-License-Identifier: Apache-2.0
import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { LiveMap } from "./live_map.js";
import { MapTools } from "./map_tools.js";
import { MAP_OPTIONS } from "./painter.js";
import { insist, Plan, yawOf } from "./plan.js";
import { Whereabouts } from "./whereabouts.js";

/** A map with the robot and the first laser scan in it, as far as ROS knows where they are. */
export class MapView {
  static title = say("view.map");
  static types = ["nav_msgs/msg/OccupancyGrid"];

  options = MAP_OPTIONS;
  #card;
  #plan;
  #live;
  #map = null; // {bitmap, origin, resolution, middle, reach}
  #frame = "";
  #whereabouts = null;
  #missing = element("p", { className: "missing", role: "status", hidden: true });
  #isOld = false; // the robot's place, or its scan
  #isDirty = false;
  #tools = null; // of a card: other pages have a map to look at
  /** Further things to draw below the robot: each gets the plan, its frame, and the pose of the robot or null. @type {((plan: Plan, frame: string, robot: any) => void)[]} */
  overlays = [];

  constructor(card) {
    this.#card = card;
    this.#plan = new Plan(say("map.label", { topic: card.topic }));
    const show = (message, painted) => this.#lay(message, painted);
    this.#live = new LiveMap(card, { check: ({ info }) => shapeOf(info), show });
    this.#live.follow(card.gateway, card.topic);
    const drawn = element("div", { className: "overlaid" }, this.#plan.element, this.#missing);
    this.element = drawn;
    if (!card.actions) return;
    const about = () => ({ frame: this.#frame, robot: this.#whereabouts?.robot ?? null });
    this.#tools = new MapTools(this.#plan, card.gateway, about, () => (this.#isDirty = true), card.topic);
    this.element = element("div", {}, drawn, this.#tools.element);
  }

  /** The arrivals of the transforms that place the robot, or undefined. */
  get place() {
    return this.#whereabouts?.arrivals;
  }

  show(message) {
    this.#live.take(message);
  }

  /** Paint it in other colours, also while it stands still. */
  async recolour() {
    await this.#live.repaint();
    this.redraw();
    this.draw();
  }

  /** Draw what has changed. */
  draw() {
    if (!this.#map) return;
    const { robot, laser, scan, isLate, missing } = this.#whereabouts;
    this.#tell(missing);
    this.#isDirty ||= isLate !== this.#isOld;
    this.#isOld = isLate;
    if (!this.#isDirty) return;
    this.#isDirty = false;
    const { bitmap, origin, resolution } = this.#map;
    const { middle, reach } = this.#tools?.part(this.#map.middle, this.#map.reach) ?? this.#map;
    this.#plan.begin(middle, reach);
    this.#plan.image(bitmap, origin, resolution);
    this.#plan.grid();
    const old = isLate ? "quiet" : undefined;
    for (const overlay of this.overlays) overlay(this.#plan, this.#frame, robot);
    if (scan && laser) this.#plan.scan(scan, laser, old);
    if (robot) this.#plan.robot(robot, old);
    this.#tools?.draw();
  }

  /** Draw again before the next frame. */
  redraw() {
    this.#isDirty = true;
  }

  close() {
    this.#tools?.close();
    this.#whereabouts?.close();
    this.#live.close();
  }

  #lay(message, { bitmap, cells }) {
    this.#map?.bitmap.close();
    this.#map = { bitmap, ...placed(shapeOf(message.info), cells) };
    this.#isDirty = true;
    const frame = message.header.frame_id;
    if (this.#whereabouts && frame === this.#frame) return;
    this.#whereabouts?.close();
    this.#frame = frame;
    this.#whereabouts = new Whereabouts(this.#card.gateway, frame, () => (this.#isDirty = true));
  }

  /** Say what is missing, or nothing. */
  #tell(words) {
    if (this.#missing.textContent === words) return; // it is read out
    this.#missing.textContent = words;
    this.#missing.hidden = !words;
  }
}

/** Return the size and the origin of a map, which can be drawn. */
function shapeOf({ resolution, width, height, origin }) {
  const { x, y } = origin.position;
  const [wide, high] = [width * resolution, height * resolution];
  if (!(resolution > 0 && Number.isFinite(wide + high + x + y))) throw new RangeError(say("map.cells", { metres: resolution }));
  insist(x, y, wide, high);
  return { resolution, height, wide, high, x, y, yaw: yawOf(origin.orientation) };
}

/** Return where to draw a map of so many cells in a pixel, and which part of the world it covers. */
function placed({ resolution, height, wide, high, x, y, yaw }, cells) {
  const turned = (right, up) => ({ x: x + Math.cos(yaw) * right - Math.sin(yaw) * up, y: y + Math.sin(yaw) * right + Math.cos(yaw) * up });
  const lift = (Math.ceil(height / cells) * cells - height) * resolution; // of rows that are drawn in part
  return {
    origin: { ...turned(0, 0), yaw },
    resolution: resolution * cells,
    middle: turned(wide / 2, high / 2 + lift / 2),
    reach: Math.max(wide, high) / 2 * (Math.abs(Math.cos(yaw)) + Math.abs(Math.sin(yaw))),
  };
}
