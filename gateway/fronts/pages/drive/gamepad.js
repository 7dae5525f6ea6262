// SPDX-License-Identifier: Apache-2.0
// A gamepad drives while its dead-man button is held. Buttons and axes are numbered as in the standard mapping.

import { whenUnseen } from "../shared/keys.js";

const DEAD_MAN = [4, 5]; // both shoulder buttons
const STOP = 1; // B or circle
const READ_MS = 20; // no event says that a button is let go. A timer goes on while nothing is painted
const DEAD_ZONE = 0.12; // so far a stick that nobody touches may be off its middle

/** Reads gamepads. */
export class Gamepads {
  #push;
  #tell;
  #stop;
  #timer = 0;
  #holder = null; // the index of the gamepad whose dead-man button is held
  #isSpent = new Set(); // the indices of gamepads whose dead-man button has to be let go of first
  #isStopping = false;

  /**
   * @param {(linear: number, angular: number) => boolean} push takes shares, -1 to 1, and returns whether they count
   * @param {{stop: () => void, changed: (isThere: boolean) => void}} to `changed`: whether there is a gamepad
   */
  constructor(push, { stop, changed }) {
    this.#push = push;
    this.#stop = stop;
    this.#tell = changed;
    addEventListener("gamepadconnected", ({ gamepad }) => {
      this.#spend([gamepad]);
      this.#look();
    });
    addEventListener("gamepaddisconnected", () => {
      this.letGo();
      this.#look();
    });
    whenUnseen(() => this.letGo(), { where: window, signal: undefined });
    this.#spend(pads());
    this.#look();
  }

  /** Drive no more, until the dead-man button is pressed again. */
  letGo() {
    this.#spend(pads());
    this.#end();
  }

  /** Shake what is held, if it can. */
  shake(ms) {
    for (const pad of pads()) {
      pad.vibrationActuator?.playEffect?.("dual-rumble", { duration: ms, strongMagnitude: 1, weakMagnitude: 1 })?.catch?.(() => {});
    }
  }

  /** Have what is held let go of first. */
  #spend(all) {
    for (const pad of all) if (isHeld(pad)) this.#isSpent.add(pad.index);
  }

  #look() {
    const isThere = pads().length > 0;
    clearInterval(this.#timer);
    if (isThere) this.#timer = setInterval(() => this.#read(), READ_MS);
    this.#tell(isThere);
  }

  #read() {
    const there = pads();
    const wasStopping = this.#isStopping;
    this.#isStopping = there.some(({ buttons }) => buttons[STOP]?.pressed);
    if (this.#isStopping && !wasStopping) this.#stop();
    if (this.#isStopping || document.hidden || !document.hasFocus()) return this.letGo();
    for (const pad of there) if (!isHeld(pad)) this.#isSpent.delete(pad.index);
    const holder = there.find((pad) => isHeld(pad) && !this.#isSpent.has(pad.index));
    if (!holder) return this.#end();
    this.#holder = holder.index;
    if (!this.#push(share(holder.axes[1]), share(holder.axes[0]))) this.letGo();
  }

  #end() {
    if (this.#holder === null) return;
    this.#holder = null;
    this.#push(0, 0);
  }
}

/** Return the gamepads whose buttons are known. */
const pads = () => [...navigator.getGamepads()].filter((each) => each?.connected && each.mapping === "standard");

const isHeld = ({ buttons }) => DEAD_MAN.some((each) => buttons[each]?.pressed);

/** Return how far an axis is pushed, ahead or left being positive. */
function share(axis = 0) {
  const rest = Math.abs(axis) - DEAD_ZONE;
  return rest > 0 ? (-Math.sign(axis) * rest) / (1 - DEAD_ZONE) : 0; // no -0
}
