// SPDX-License-Identifier: Apache-2.0
// The tools of a map in a card: zoom, move, follow, and send the robot to a place.

import { element } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { Navigation, pickedRobot } from "../scene/navigation.js";
import { GoalLine, POSE_TOOLS, Tools } from "../scene/navigation_bar.js";
import { PoseDrag } from "../scene/pose_drag.js";

const PATH = "nav_msgs/msg/Path";
const MOST_ZOOM = 50;
const STEP = 1.25; // of a button or a key
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** The frame of a map, and the robot in it. @typedef {{frame: string, robot: {x: number, y: number, yaw: number}|null}} About */

/** The tools, with what they draw. */
export class MapTools {
  #plan;
  #about;
  #changed;
  #zoom = 1;
  #shift = { x: 0, y: 0 }; // of the middle, in metres
  #follows = false;
  #reach = 1;
  #pointers = new Map(); // that are down, by their id
  #path = null;
  #endPath = () => {};
  #pathTopic = "";
  #gateway;
  #navigation;
  #ends = new AbortController();
  #line;
  #drag;
  #tools;
  #follow = element("button", { type: "button", title: say("follow.about"), aria: { pressed: "false" } }, say("follow"));

  /**
   * @param {import("./plan.js").Plan} plan
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {() => About} about
   * @param {() => void} changed is called when there is something else to draw
   * @param {string} topic of the map
   */
  constructor(plan, gateway, about, changed, topic) {
    this.#plan = plan;
    this.#gateway = gateway;
    this.#about = about;
    this.#changed = changed;
    this.#navigation = new Navigation(gateway, () => {
      this.#write();
      changed();
    }, () => [topic, pickedRobot()]);
    this.#line = new GoalLine(this.#navigation);
    this.#drag = new PoseDrag(() => ({ yaw: about().robot?.yaw ?? 0, frame: about().frame }), changed, (pose) => this.#given(pose));
    this.#tools = new Tools(POSE_TOOLS, () => this.#choose());
    this.element = element("div", { className: "map-tools" }, this.#buttons(), this.#line.element);
    this.#listen();
  }

  /** Return the part of the world to show, of one that shows all. */
  part({ x, y }, reach) {
    const { robot } = this.#about();
    this.#reach = reach / this.#zoom;
    const middle = this.#follows && robot ? robot : { x: x + this.#shift.x, y: y + this.#shift.y };
    return { middle, reach: this.#reach };
  }

  /** Draw the path, the goal, and the pose that is being given. */
  draw() {
    this.#findPath();
    const { frame } = this.#about();
    if (this.#path?.frame === frame) this.#plan.line(this.#path.places, "series-3");
    const { target } = this.#navigation;
    if (target?.frame === frame) this.#plan.arrow(target, "accent");
    if (this.#drag.pose?.frame === frame) this.#plan.arrow(this.#drag.pose, "accent");
  }

  close() {
    this.#ends.abort();
    this.#endPath();
    this.#navigation.close();
  }

  #buttons() {
    const button = (label, title, act) => element("button", { type: "button", title, aria: { label: title }, onclick: act }, label);
    this.#follow.onclick = () => {
      this.#follows = !this.#follows;
      this.#follow.setAttribute("aria-pressed", String(this.#follows));
      this.#changed();
    };
    this.#tools.element.append(
      button("+", say("zoom.in"), () => this.#zoomTo(this.#zoom * STEP)), button("−", say("zoom.out"), () => this.#zoomTo(this.#zoom / STEP)),
      button(say("zoom.fit"), say("zoom.fit.about"), () => this.#fit()), this.#follow,
    );
    return this.#tools.element;
  }

  #listen() {
    const canvas = this.#plan.element;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.addEventListener("pointerdown", (event) => this.#down(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => this.#up(event, end === "pointerup"));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.#zoomTo(this.#zoom * STEP ** (-event.deltaY / 100), this.#plan.placeOf(event));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      if (!event.ctrlKey && !event.metaKey && !event.altKey && this.#key(event)) event.preventDefault();
    });
    this.#drag.watch(this.#gateway, canvas, this.#ends.signal);
    this.#touch();
  }

  /** Leave a finger to the page, which scrolls, unless it has something to move here. */
  #touch() {
    this.#plan.element.style.touchAction = this.#tools.tool || this.#zoom > 1 ? "none" : "pan-y";
  }

  #down(event) {
    if (event.button !== 0) return;
    this.#plan.element.setPointerCapture(event.pointerId);
    this.#pointers.set(event.pointerId, this.#plan.placeOf(event));
    if (this.#tools.tool && this.#pointers.size === 1) this.#drag.down(this.#plan.placeOf(event));
    else this.#drag.drop(); // two fingers zoom
  }

  #move(event) {
    const before = this.#pointers.get(event.pointerId);
    if (!before) return;
    const place = this.#plan.placeOf(event);
    if (this.#drag.pose) this.#drag.move(place);
    else if (this.#pointers.size === 2) this.#pinch(event.pointerId, before, place);
    else this.#pan(before.x - place.x, before.y - place.y);
    if (this.#drag.pose) this.#pointers.set(event.pointerId, place);
  }

  #up({ pointerId }, isDone) {
    this.#pointers.delete(pointerId);
    if (!this.#drag.pose) return;
    if (isDone) this.#drag.up();
    else this.#drag.drop();
  }

  #pinch(id, before, place) {
    const [[, other]] = [...this.#pointers].filter(([each]) => each !== id);
    const apart = (each) => Math.hypot(each.x - other.x, each.y - other.y);
    if (apart(before) > 0) this.#zoomTo((this.#zoom * apart(place)) / apart(before), other);
  }

  #pan(x, y) {
    if (this.#follows) this.#follow.click();
    this.#shift.x += x;
    this.#shift.y += y;
    this.#changed();
  }

  /** Zoom around a place, which stays where it is. */
  #zoomTo(zoom, place = null) {
    const before = this.#zoom;
    this.#zoom = Math.min(MOST_ZOOM, Math.max(0.5, zoom));
    if (place && !this.#follows) {
      const share = 1 - before / this.#zoom;
      const { x, y } = this.#plan.middle;
      this.#shift.x += (place.x - x) * share;
      this.#shift.y += (place.y - y) * share;
    }
    this.#touch();
    this.#changed();
  }

  #fit() {
    this.#shift = { x: 0, y: 0 };
    if (this.#follows) this.#follow.click();
    this.#zoomTo(1);
  }

  #key(event) {
    const { key } = event;
    if (this.#tools.tool && this.#drag.key(event, () => this.#plan.middle)) return true;
    if (this.#tools.tool && key === "Escape") this.#tools.choose("");
    else if (key in KEYS) this.#pan(...KEYS[key].map((each) => each * this.#reach * 0.2));
    else if (key === "+" || key === "=") this.#zoomTo(this.#zoom * STEP);
    else if (key === "-") this.#zoomTo(this.#zoom / STEP);
    else return false;
    return true;
  }

  #choose() {
    const { tool } = this.#tools;
    this.#drag.drop();
    if (tool) this.#navigation.prepare(tool === "place");
    this.#touch();
    this.#write();
    if (tool) this.#plan.element.focus({ preventScroll: true });
  }

  #given(pose) {
    const { tool } = this.#tools;
    this.#tools.choose("");
    if (tool === "go") this.#navigation.go(pose, pose.frame);
    else this.#navigation.place(pose, pose.frame);
  }

  #write() {
    this.#line.write(this.#navigation.wordsOf(this.#tools));
  }

  /** Follow the first path that a node publishes. */
  #findPath() {
    const topic = this.#gateway.graph.published(PATH)?.name ?? "";
    if (topic === this.#pathTopic) return;
    this.#endPath();
    this.#endPath = () => {};
    [this.#pathTopic, this.#path] = [topic, null];
    if (!topic) return;
    this.#endPath = this.#gateway.subscribe(topic, { compression: "cbor", throttle_rate: 200 }, ({ header, poses }) => {
      this.#path = { frame: header.frame_id, places: poses.map(({ pose }) => pose.position) };
      this.#changed();
    }, () => {});
  }
}
