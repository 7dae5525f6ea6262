// SPDX-License-Identifier: Apache-2.0
// The 3D scene as the large picture of the drive page. Its code comes when it is chosen: it is larger than the rest of the page.

import { Aging } from "../shared/aging.js";
import { element } from "../shared/dom.js";
import { isTaken } from "../shared/keys.js";
import { say } from "../shared/language.js";

const KEY = "ros2-gateway.drive-scene"; // of the storage of the browser: whether it is shown, and the texts of the scene
const SHOWN = "shown";
const FIRST = "follow";
const TURNS = { KeyQ: 1, KeyE: -1 }; // next to the keys that drive
const NUMBER = "input[type=number]";
const TAKES_KEYS = `select, ${NUMBER}`;

/** The scene, while it is chosen. */
export class Scenery {
  #gateway;
  #home;
  #button;
  #aging;
  /** @type {import("../scene/scene.js").SceneView|null} */
  #scene = null;
  #texts;
  #isShown;
  #problem = element("p", { className: "problem", role: "status", hidden: true });
  #isByPointer = false; // the last action
  #failed = ""; // the part that fails

  /**
   * @param {import("../shared/gateway.js").Gateway} gateway
   * @param {HTMLElement} home that holds it
   * @param {HTMLElement} button that chooses it
   * @param {Object<string, number>} lateMs as for `Aging`
   */
  constructor(gateway, home, button, lateMs) {
    this.#gateway = gateway;
    this.#home = home;
    this.#button = button;
    this.#aging = new Aging(home, lateMs);
    const [shown, ...texts] = (localStorage.getItem(KEY) ?? `- ${FIRST}`).split(" ");
    this.#isShown = shown === SHOWN;
    this.#texts = texts;
    button.onclick = () => {
      this.#isShown = !this.#isShown;
      button.blur(); // or the space bar would press it, and not STOP
      this.#keep();
      this.#turn();
    };
    this.#leaveKeys();
    this.#turn();
  }

  draw() {
    this.#attempt("drawing", () => this.#scene?.draw());
  }

  /** Write what changes with time, and how old it is. */
  write(sources, isConnected) {
    this.#aging.write(sources, isConnected);
    this.#attempt("writing", () => this.#scene?.tick());
  }

  #keep() {
    localStorage.setItem(KEY, [this.#isShown ? SHOWN : "-", ...this.#texts].join(" "));
  }

  #turn() {
    this.#button.setAttribute("aria-pressed", String(this.#isShown));
    this.#home.hidden = !this.#isShown;
    this.#say("");
    if (this.#isShown) this.#load();
    else this.#end();
  }

  async #load() {
    this.#home.replaceChildren(element("p", {}, say("scene.loading")));
    try {
      const { SceneView } = await import("../scene/scene.js");
      if (!this.#isShown || this.#scene) return; // another picture was chosen in that time
      const keep = () => {
        this.#texts = this.#scene.kept;
        this.#keep();
      };
      this.#scene = new SceneView(this.#gateway, this.#texts, keep, null);
      this.#home.replaceChildren(this.#scene.element, this.#problem);
    } catch (error) {
      this.#home.replaceChildren();
      this.#say(say("scene.failed", { why: error.message }));
    }
  }

  #end() {
    this.#scene?.close();
    this.#scene = null;
  }

  /** Say what cannot be shown, until it can be, and go on: the page has to drive, and to stop. */
  #attempt(what, action) {
    try {
      action();
      if (this.#failed !== what) return;
      this.#failed = "";
      this.#say("");
    } catch (error) {
      this.#failed = what;
      this.#say(say("drive.failed", { why: error.message }));
    }
  }

  #say(words) {
    if (this.#problem.textContent === words) return; // it is read out
    this.#problem.textContent = words;
    this.#problem.hidden = !words;
    this.#home.append(this.#problem);
  }

  /** Leave the keys to driving: what a pointer has pressed here keeps none. And take those that turn the scene. */
  #leaveKeys() {
    const home = this.#home;
    const leave = () => {
      const { activeElement: held } = document;
      if (this.#isByPointer && home.contains(held) && !held.matches(TAKES_KEYS)) /** @type {HTMLElement} */ (held).blur();
    };
    home.addEventListener("pointerdown", () => (this.#isByPointer = true));
    home.addEventListener("keydown", ({ target, key }) => {
      this.#isByPointer = false;
      const field = /** @type {HTMLElement} */ (target);
      if (["Enter", "Escape"].includes(key) && field.matches(NUMBER)) field.blur();
    });
    home.addEventListener("click", leave);
    home.addEventListener("change", ({ target }) => {
      const field = /** @type {HTMLElement} */ (target);
      if (this.#isByPointer || field.matches("select")) field.blur(); // as the list of cameras
    });
    addEventListener("keydown", (event) => this.#key(event));
  }

  #key(event) {
    const { code, key, ctrlKey, metaKey, altKey } = event;
    const isZoom = ["+", "=", "-"].includes(key);
    if (!this.#scene || ctrlKey || metaKey || altKey || isTaken(event) || !(code in TURNS || isZoom)) return;
    if (isZoom) this.#scene.zoom(key !== "-");
    else this.#scene.turn(TURNS[code]);
  }
}
