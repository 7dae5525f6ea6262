// SPDX-License-Identifier: Apache-2.0
// A map that is painted again when a part of it changes: `map_msgs/msg/OccupancyGridUpdate` on its topic with `_updates` behind it.

import { say } from "../shared/language.js";
import { lasting } from "../shared/passing.js";
import { Newest } from "./newest.js";
import { palette, patch, UNCHANGED } from "./occupancy.js";
import { Painter } from "./painter.js";

const UPDATE = "map_msgs/msg/OccupancyGridUpdate";
const MOST_RECENT = 4 * 1024 * 1024; // octets of updates, as a map is at most a second older than the updates before it
const MOST_WAITING = 4 * 1024 * 1024; // likewise, of updates that come while a map is painted. Then they become one
const EACH = 500; // octets of an update next to its cells

/** Maps of one topic, of which the newest is painted, with all its updates. */
export class LiveMap {
  #painter = new Painter();
  #card;
  #newest;
  #colours;
  #check;
  #show;
  #message = null; // that the painter has, or gets next
  #waits = false; // whether it has to get it yet
  #patches = []; // for it, which fit into it
  #waiting = 0; // octets of them
  #misfit = null; // an update that does not
  #recent = []; // updates, the newest last
  #kept = 0; // octets of them
  #wrong = ""; // the words about updates
  #end = () => {};

  /**
   * @param {{tell: (words: string) => void, untell: (words: string) => void}} card says what cannot be shown
   * @param {{check: (message: any) => void, show: (message: any, painted: {bitmap: ImageBitmap, cells: number, values: Int8Array}) => void,
   *   colours?: () => Uint32Array}} does
   *   `check` throws an error if a map cannot be shown, and `show` gets each painted one
   */
  constructor(card, { check, show, colours = palette }) {
    this.#card = card;
    this.#newest = new Newest(card, (_, why) => say("map.unshown", { why }), (message) => this.#paint(message));
    [this.#check, this.#show, this.#colours] = [check, show, colours];
  }

  /** Take a map, with its cells or as a picture. It may come later than updates of it. */
  take(message) {
    this.#message = message;
    this.#waits = true;
    this.#forget();
    for (const each of this.#recent) if (isNewer(each, message)) this.#wait(each);
    return this.#newest.take(message);
  }

  /** Take the newest values of a part of the map. */
  update(part) {
    if (this.#wrong) this.#card.untell(this.#wrong);
    this.#wrong = "";
    this.#recent.push(part);
    this.#kept += sizeOf(part);
    while (this.#kept > MOST_RECENT) this.#kept -= sizeOf(this.#recent.shift());
    if (this.#message) this.#wait(part);
    return this.repaint();
  }

  /** Paint the map again, in the colours of now. */
  async repaint() {
    if (this.#message) await this.#newest.take(this.#message);
  }

  /** Follow the updates of a topic, once a node publishes them. */
  follow(gateway, topic) {
    this.#end();
    const name = `${topic}_updates`;
    let end = null;
    const wrong = lasting((words) => this.#card.tell((this.#wrong = words)));
    const tell = (status) => status.code === "not_found" || wrong(status); // a map needs no updates
    const look = () => {
      if (!end && gateway.graph.typeOf(name) === UPDATE) end = gateway.subscribe(name, { compression: "cbor" }, (each) => this.update(each), tell);
    };
    const forget = gateway.on("graph", look);
    look();
    this.#end = () => {
      forget();
      end?.();
    };
  }

  close() {
    this.#end();
    this.#painter.close();
  }

  #forget() {
    [this.#patches, this.#waiting, this.#misfit] = [[], 0, null];
  }

  /** Keep an update until the map is painted. Of many one is made, or they would need ever more room. */
  #wait(part) {
    const { width, height } = this.#message.info;
    if (!fits(part, width, height)) {
      this.#misfit = { ...part, count: part.data.length, wide: width, high: height };
      return;
    }
    this.#patches.push(part);
    this.#waiting += sizeOf(part);
    if (this.#waiting <= MOST_WAITING) return;
    const all = { x: 0, y: 0, width, data: new Int16Array(width * height).fill(UNCHANGED) };
    for (const each of this.#patches) patch(all.data, width, each);
    [this.#patches, this.#waiting] = [[all], 0];
  }

  async #paint(message) {
    const [waits, patches, misfit] = [this.#waits, this.#patches, this.#misfit];
    this.#waits = false;
    this.#forget();
    try {
      if (waits) this.#check(message);
      this.#show(message, await this.#painter.paint(waits ? message : null, patches, this.#colours()));
    } catch (error) {
      if (waits && message === this.#message) this.#message = null; // the painter has another one, or none
      throw error;
    }
    if (misfit) throw new RangeError(say("map.wrong.update", misfit));
  }
}

const sizeOf = ({ data }) => data.length + EACH;

/** Return whether an update lies in a map of so many cells, and has a value for each of its cells. */
const fits = ({ x, y, width, height, data }, wide, high) => x >= 0 && y >= 0 && x + width <= wide && y + height <= high && data.length === width * height;

/** Return whether an update is newer than a map. */
function isNewer({ header: { stamp } }, { header }) {
  return (stamp.sec - header.stamp.sec || stamp.nanosec - header.stamp.nanosec) > 0;
}
