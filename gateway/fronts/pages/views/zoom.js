// SPDX-License-Identifier: Apache-2.0

const MOST = 16; // times as large
const STEP = 1.25;
const MOVE = 40; // pixels, by an arrow key

/** Makes a picture larger within its place, by wheel, two fingers, and the keys + and -. A drag and the arrow keys move it, 0 shows all. */
export class Zoom {
  #place;
  #picture;
  #times = 1;
  #x = 0; // pixels from the middle
  #y = 0;
  #fingers = new Map(); // id -> where it is

  /** @param {HTMLElement} place that cuts it off @param {HTMLElement} picture */
  constructor(place, picture) {
    this.#place = place;
    this.#picture = picture;
    const keys = {
      "+": () => this.#by(STEP), "=": () => this.#by(STEP), "-": () => this.#by(1 / STEP), 0: () => this.reset(),
      ArrowLeft: () => this.#move(MOVE, 0), ArrowRight: () => this.#move(-MOVE, 0), ArrowUp: () => this.#move(0, MOVE), ArrowDown: () => this.#move(0, -MOVE),
    };
    this.#hear({
      wheel: (event) => {
        event.preventDefault();
        this.#by(event.deltaY < 0 ? STEP : 1 / STEP, event.clientX, event.clientY);
      },
      dblclick: () => this.reset(),
      pointerdown: (event) => {
        this.#fingers.set(event.pointerId, event);
        place.setPointerCapture(event.pointerId);
      },
      pointermove: (event) => this.#drag(event),
      pointerup: ({ pointerId }) => this.#fingers.delete(pointerId),
      pointercancel: ({ pointerId }) => this.#fingers.delete(pointerId),
      keydown: (event) => {
        if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
        event.preventDefault();
        event.stopPropagation();
        keys[event.key]();
      },
    });
  }

  /** Whether it takes what the user does. */
  isOn = false;

  /** Show all of the picture. */
  reset() {
    [this.#times, this.#x, this.#y] = [1, 0, 0];
    this.#write();
  }

  #hear(takes) {
    for (const [name, take] of Object.entries(takes)) this.#place.addEventListener(name, (event) => this.isOn && take(event), { passive: false });
  }

  #drag(event) {
    const before = this.#fingers.get(event.pointerId);
    if (!before) return;
    const other = [...this.#fingers.values()].find(({ pointerId }) => pointerId !== event.pointerId);
    if (other) this.#by(apart(event, other) / apart(before, other), other.clientX, other.clientY);
    else this.#move(event.clientX - before.clientX, event.clientY - before.clientY);
    this.#fingers.set(event.pointerId, event);
  }

  /** Make it larger so that what is at a place of the screen stays there. By default that is the middle. */
  #by(factor, clientX = NaN, clientY = NaN) {
    const { left, top, width, height } = this.#place.getBoundingClientRect();
    const times = Math.max(1, Math.min(MOST, this.#times * factor));
    const [x, y] = Number.isNaN(clientX) ? [0, 0] : [clientX - left - width / 2, clientY - top - height / 2];
    this.#x = x - ((x - this.#x) * times) / this.#times;
    this.#y = y - ((y - this.#y) * times) / this.#times;
    this.#times = times;
    this.#move(0, 0);
  }

  #move(right, down) {
    const { clientWidth: width, clientHeight: height } = this.#place;
    const within = (value, size) => Math.max(-1, Math.min(1, value / (((this.#times - 1) * size) / 2 || 1))) * (((this.#times - 1) * size) / 2);
    this.#x = within(this.#x + right, width);
    this.#y = within(this.#y + down, height);
    this.#write();
  }

  #write() {
    this.#picture.style.transform = this.#times === 1 ? "" : `translate(${this.#x}px, ${this.#y}px) scale(${this.#times})`;
    this.#picture.style.imageRendering = this.#times > 4 ? "pixelated" : "";
  }
}

const apart = (one, other) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY) || 1;
