// SPDX-License-Identifier: Apache-2.0
// A scene: what ROS says of the world, in one picture that can be turned. Any page may have some.

import { Color, DirectionalLight, GridHelper, HemisphereLight, Quaternion, Scene, Vector3, WebGLRenderer } from "../vendor/three.js";
import { element, token } from "../shared/dom.js";
import { say } from "../shared/language.js";
import { dispose } from "./display.js";
import { Frames } from "./frames.js";
import * as texts from "./kept.js";
import { Layers } from "./layers.js";
import { Navigation, pickedRobot } from "./navigation.js";
import { GoalLine, POSE_TOOLS, Tools } from "./navigation_bar.js";
import { Measure, poseArrow } from "./pointers.js";
import { PoseDrag } from "./pose_drag.js";
import { RobotDisplay } from "./robot.js";
import { View3d } from "./view3d.js";

const TOOLS = [...POSE_TOOLS, "measure", "pick"];
const FLOOR_M = 20;
const FEW_POINTS = 10_000; // 60 kB: the network of a driver has something else to do
const WIDE_PX = 640; // a narrower one would be half covered by its list
const BASES = ["base_footprint", "base_link"];
const FLAT = { x: 0, y: 0, z: 0 };

/** A scene in an element. Call `draw` before each frame of the screen, `tick` some times a second, and `close` at its end. */
export class SceneView {
  navigation;
  frames;
  layers;
  world = new Scene();
  /** @type {any} */ renderer = null;
  #gateway;
  #changed;
  #kept;
  #canvas = element("canvas");
  #fixed = element("select", { title: say("scene.fixed.about"), aria: { label: say("scene.fixed") } });
  #follow = element("button", { type: "button", title: say("follow.about") }, say("follow"));
  #top = element("button", { type: "button", title: say("scene.top.about") }, say("scene.top"));
  #list = element("button", { type: "button", title: say("layers.about"), aria: { expanded: "true" } }, say("layers"));
  #missing = element("p", { className: "missing", role: "status", hidden: true });
  #tools = new Tools(TOOLS, () => this.#choose());
  #goalLine;
  #view;
  #drag;
  #measure = new Measure();
  #arrows = { go: poseArrow("go"), place: poseArrow("place") };
  #floor = null;
  #isDirty = true;
  #isMeasured = false; // its size, which says at first whether there is room for the list
  #isLost = false; // its graphics memory
  #before = null; // the followed robot, as it was
  #isCockpit; // the view is that of a driver
  #ends = new AbortController();
  #sizes;
  #looks;
  #forget;

  /**
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {string[]} kept texts of the scene as it was
   * @param {() => void} changed is called when a user has changed something that is kept
   * @param {{fill: () => void, onFull: (take: (isFull: boolean) => void) => () => void}|null} card fills the page with it. Without one it is
   *   for a page that drives: it turns with the robot, has few buttons, and takes no keys
   */
  constructor(gateway, kept, changed, card) {
    this.#gateway = gateway;
    this.#changed = changed;
    this.#kept = texts.read(kept);
    this.#isCockpit = !card;
    this.frames = new Frames(gateway);
    this.navigation = new Navigation(gateway, () => this.#dirty(), () => [pickedRobot(), this.#base]);
    this.#goalLine = new GoalLine(this.navigation);
    this.#view = new View3d(this.#canvas, () => this.#dirty());
    this.#drag = new PoseDrag(() => ({ yaw: this.#heading, frame: this.frames.fixed }), () => this.#dirty(), (pose) => this.#given(pose));
    this.layers = new Layers({ gateway, frames: this.frames, changed: () => this.#dirty(), mostPoints: card ? 50_000 : FEW_POINTS }, this.#kept.layers, changed);
    this.element = this.#build(card);
    this.#light();
    this.#begin();
    this.#listen();
    this.#sizes = new ResizeObserver(() => this.#resize());
    this.#sizes.observe(this.#canvas);
    this.#looks = new MutationObserver(() => this.#paint());
    this.#looks.observe(document.documentElement, { attributes: true });
    matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => this.#paint(), { signal: this.#ends.signal });
    const forgets = [
      gateway.on("graph", () => this.layers.learn()),
      gateway.on("state", ({ state }) => state === "open" && this.layers.displays.forEach((each) => each.restart())),
    ];
    this.#forget = () => forgets.forEach((forget) => forget());
    this.layers.learn();
    this.#view.top(this.#kept.isTop, this.#ahead);
    this.#press();
  }

  /** The scene as texts without spaces. */
  get kept() {
    return texts.write({ frame: this.#kept.frame, isTop: this.#view.isTop, follows: this.#kept.follows, layers: this.layers.kept });
  }

  /** Draw it if anything has changed. */
  draw() {
    if (!this.#isMeasured && this.element.clientWidth) {
      this.#isMeasured = true;
      this.#fold(this.element.clientWidth < WIDE_PX);
    }
    if (this.frames.step()) this.#isDirty = true;
    if (!this.#isDirty) return;
    this.#isDirty = false;
    this.#followRobot();
    this.#point();
    this.renderer?.render(this.world, this.#view.camera);
  }

  /** Write what changes with time. */
  tick() {
    this.layers.tick();
    this.#offerFrames();
    const missing = [this.#isLost && say("scene.lost"), this.frames.problem, this.frames.leftOut, this.frames.missing].filter(Boolean).join(" ");
    if (this.#missing.textContent !== missing) this.#missing.textContent = missing; // it is read out
    this.#missing.hidden = !missing;
    this.#goalLine.write(this.#words);
  }

  /** Go on after nothing has come for a while. */
  wake() {
    for (const each of this.layers.displays) each.wake();
    this.#dirty();
  }

  /** Turn the view by steps to the left. */
  turn(steps) {
    this.#view.turn(steps);
  }

  /** Zoom in, or out. */
  zoom(isIn) {
    this.#view.key({ key: isIn ? "+" : "-" });
  }

  close() {
    this.#ends.abort();
    this.#sizes.disconnect();
    this.#looks.disconnect();
    this.#forget();
    this.navigation.close();
    this.layers.close();
    this.frames.close();
    this.#view.close();
    dispose(this.world);
    this.renderer?.dispose();
    this.renderer?.forceContextLoss(); // a browser has only some contexts
    this.element.remove();
  }

  #dirty() {
    this.#isDirty = true;
  }

  #build(card) {
    const home = element("button", { type: "button", title: say("scene.home.about") }, say("scene.home"));
    home.onclick = () => this.#goHome();
    this.#top.onclick = () => {
      this.#view.top(!this.#view.isTop, this.#ahead);
      this.#press();
      this.#changed();
    };
    this.#follow.onclick = () => {
      this.#kept.follows = !this.#kept.follows;
      if (this.#kept.follows) this.#goHome();
      this.#press();
      this.#changed();
    };
    this.#list.onclick = () => this.#fold(!this.layers.element.hidden);
    const drawn = element("div", { className: "drawn" }, this.#canvas, this.#missing);
    const bar = element("div", { className: "scene-bar" }, home, this.#top, this.#follow, this.#list);
    const scene = element("div", { className: "scene" }, bar, drawn, this.layers.element);
    if (!card) {
      Object.assign(this.#canvas, { role: "img", ariaLabel: say("scene") });
      this.#isMeasured = true;
      this.#fold(true);
      return scene;
    }
    Object.assign(this.#canvas, { tabIndex: 0, role: "application", ariaLabel: say("scene.label") });
    const full = element("button", { type: "button", title: say("scene.full.about"), aria: { pressed: "false" } }, say("full"));
    full.onclick = () => card.fill();
    this.#ends.signal.addEventListener("abort", card.onFull((isFull) => full.setAttribute("aria-pressed", String(isFull))));
    this.#fixed.onchange = () => {
      this.#kept.frame = this.#fixed.value;
      this.#fix();
      this.#changed();
    };
    bar.prepend(element("label", {}, `${say("scene.frame")} `, this.#fixed));
    this.#list.before(this.#tools.element);
    bar.append(full);
    scene.append(this.#goalLine.element);
    return scene;
  }

  /** Show the list of layers, or not. */
  #fold(isFolded) {
    this.layers.element.hidden = isFolded;
    this.#list.setAttribute("aria-expanded", String(!isFolded));
  }

  #press() {
    this.#top.setAttribute("aria-pressed", String(this.#view.isTop));
    this.#follow.setAttribute("aria-pressed", String(this.#kept.follows));
  }

  #light() {
    const sun = new DirectionalLight(0xffffff, 1.5);
    sun.position.set(-2, -3, 6);
    this.world.add(new HemisphereLight(0xffffff, 0x667788, 1.8), sun, this.frames.root, this.#measure.object, ...Object.values(this.#arrows));
    this.#paint();
  }

  /** Take the colours of the page. */
  #paint() {
    this.world.background = new Color(token("surface"));
    if (this.#floor) dispose(this.#floor);
    this.#floor?.removeFromParent();
    this.#floor = new GridHelper(FLOOR_M, FLOOR_M, token("edge"), token("line"));
    this.#floor.rotation.x = Math.PI / 2; // z is up
    this.#floor.position.z = -0.01;
    this.world.add(this.#floor);
    for (const each of this.layers.displays) each.restyle();
    this.#dirty();
  }

  #begin() {
    try {
      this.renderer = new WebGLRenderer({ canvas: this.#canvas, antialias: devicePixelRatio < 2 });
      this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    } catch (error) {
      this.#canvas.replaceWith(element("p", {}, say("scene.webgl", { why: error.message })));
    }
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (!width || !height) return;
    this.renderer?.setSize(width, height, false);
    this.#view.resize(width, height);
    this.#dirty();
  }

  #listen() {
    const { signal } = this.#ends;
    const canvas = this.#canvas;
    canvas.addEventListener("pointerdown", (event) => {
      if (!this.#tools.tool || event.button !== 0 || !event.isPrimary) return;
      this.#down(event);
    }, { signal });
    canvas.addEventListener("pointermove", (event) => {
      const floor = this.#drag.pose && event.isPrimary && this.#view.floor(event);
      if (floor) this.#drag.move(floor);
    }, { signal });
    canvas.addEventListener("pointerup", ({ isPrimary }) => isPrimary && this.#drag.up(), { signal });
    canvas.addEventListener("pointercancel", () => this.#drag.drop(), { signal });
    if (!this.#isCockpit) canvas.addEventListener("keydown", (event) => this.#key(event), { signal });
    canvas.addEventListener("webglcontextlost", () => this.#lose(true), { signal });
    canvas.addEventListener("webglcontextrestored", () => this.#lose(false), { signal }); // three has made all of it again
    this.#drag.watch(this.#gateway, canvas, signal);
  }

  #lose(isLost) {
    this.#isLost = isLost;
    this.#dirty();
    this.tick();
  }

  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { tool } = this.#tools;
    const isPose = POSE_TOOLS.includes(tool);
    let isTaken = isPose && this.#drag.key(event, () => this.#view.floor());
    if (!isTaken && tool && !isPose && event.key === "Enter") isTaken = this.#mark(this.#view.pick(this.frames.root));
    if (!isTaken && tool && event.key === "Escape") {
      this.#tools.choose("");
      isTaken = true;
    }
    if (isTaken || this.#view.key(event)) event.preventDefault();
  }

  #down(event) {
    if (!POSE_TOOLS.includes(this.#tools.tool)) {
      this.#mark(this.#view.pick(this.frames.root, event));
      return;
    }
    const floor = this.#view.floor(event);
    if (!floor) return;
    this.#canvas.setPointerCapture(event.pointerId);
    this.#drag.down(floor);
  }

  #mark(place) {
    if (place) this.#measure.add(place, this.#tools.tool === "measure" ? 2 : 1);
    this.#dirty();
    this.#goalLine.write(this.#words);
    return true;
  }

  #choose() {
    const { tool } = this.#tools;
    this.#drag.drop();
    this.#measure.clear();
    this.#view.looksAround(!tool);
    if (POSE_TOOLS.includes(tool)) this.navigation.prepare(tool === "place");
    this.#dirty();
    this.tick();
    if (tool) this.#canvas.focus({ preventScroll: true });
  }

  #given(pose) {
    const { tool } = this.#tools;
    this.#tools.choose("");
    if (tool === "go") this.navigation.go(pose, pose.frame);
    else this.navigation.place(pose, pose.frame);
    this.#goalLine.write(this.#words);
  }

  get #words() {
    return this.#measure.words || this.navigation.wordsOf(this.#tools);
  }

  /** Show the pose that is being given, or else the goal. */
  #point() {
    const { pose } = this.#drag;
    const { tool } = this.#tools;
    const { target } = this.navigation;
    for (const [kind, arrow] of Object.entries(this.#arrows)) {
      const about = pose ? tool === kind && pose : kind === "go" && target;
      const shown = about && about.frame === this.frames.fixed && about;
      arrow.visible = Boolean(shown);
      if (!shown) continue;
      arrow.position.set(shown.x, shown.y, 0.02);
      arrow.rotation.z = shown.yaw;
    }
  }

  /** The frame of the robot, or "". */
  get #base() {
    const robot = this.layers.displays.find((each) => each instanceof RobotDisplay);
    if (robot?.frame) return robot.frame;
    const { names } = this.frames;
    return BASES.find((each) => names.has(each)) ?? [...names].find((each) => BASES.includes(each.split("/").at(-1))) ?? "";
  }

  /** The place and the turn of the robot in the fixed frame, or null. */
  get robot() {
    const [place, turn] = [new Vector3(), new Quaternion()];
    return this.frames.find(this.#base, place, turn) ? { place, turn } : null;
  }

  get #heading() {
    const { x, y, z, w } = this.robot?.turn ?? { ...FLAT, w: 1 };
    return Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  }

  /** The heading that a driver looks along, or null. */
  get #ahead() {
    return this.#isCockpit ? this.#heading : null;
  }

  #followRobot() {
    if (!this.#kept.follows) {
      this.#before = null;
      return;
    }
    const place = this.robot?.place;
    if (!place) return;
    const yaw = this.#ahead;
    if (this.#before) this.#view.follow(this.#before.place, place, yaw - this.#before.yaw);
    else this.#view.home(place, yaw);
    this.#before = { place, yaw };
  }

  #goHome() {
    this.#before = null;
    this.#view.home(this.robot?.place ?? new Vector3(), this.#ahead);
    this.#dirty();
  }

  /** Offer the frames that there are. The first choice is what shows the most. */
  #offerFrames() {
    this.#fix();
    const names = ["", ...[...this.frames.names].sort()];
    if (this.#kept.frame && !names.includes(this.#kept.frame)) names.push(this.#kept.frame);
    const known = [...this.#fixed.options].map(({ value }) => value);
    if (String(known) === String(names)) return; // a list that is open would close
    this.#fixed.replaceChildren(...names.map((each) => new Option(each || say("scene.fixed.none"), each, false, each === this.#kept.frame)));
  }

  #fix() {
    const frame = this.#kept.frame || this.frames.main;
    if (frame === this.frames.fixed) return;
    this.frames.fix(frame);
    this.#before = null;
    this.#dirty();
  }
}
