// SPDX-License-Identifier: Apache-2.0
// A map that is painted again when a part of it changes: `map_msgs/msg/OccupancyGridUpdate` on its topic with `_updates` behind it.

import { say } from "../shared/language.js";
import { Newest } from "./newest.js";
import { palette } from "./occupancy.js";
import { Painter } from "./painter.js";

const UPDATE = "map_msgs/msg/OccupancyGridUpdate";
const MOST_RECENT = 4 * 1024 * 1024; // cells of updates, as a map is at most a second older than the updates before it

/** Maps of one topic, of which the newest is painted, with all its updates. */
export class LiveMap {
  #painter = new Painter();
  #newest;
  #colours;
  #check;
  #show;
  #message = null; // that the painter has, or gets next
  #waits = false; // whether it has to get it yet
  #patches = []; // for it
  #recent = []; // updates, the newest last
  #cells = 0; // in them
  #end = () => {};

  /**
   * @param {{tell: (words: string) => void, untell: (words: string) => void}} card says what cannot be shown
   * @param {{check: (message: any) => void, show: (message: any, painted: {bitmap: ImageBitmap, cells: number, values: Int8Array}) => void,
   *   colours?: () => Uint32Array}} does
   *   `check` throws an error if a map cannot be shown, and `show` gets each painted one
   */
  constructor(card, { check, show, colours = palette }) {
    this.#newest = new Newest(card, (_, why) => say("map.unshown", { why }), (message) => this.#paint(message));
    [this.#check, this.#show, this.#colours] = [check, show, colours];
  }

  /** Take a map, with its cells or as a picture. It may come later than updates of it. */
  take(message) {
    this.#message = message;
    this.#waits = true;
    this.#patches = this.#recent.filter((each) => isNewer(each, message));
    return this.#newest.take(message);
  }

  /** Take the newest values of a part of the map. */
  update(patch) {
    this.#recent.push(patch);
    this.#cells += patch.data.length;
    while (this.#cells > MOST_RECENT) this.#cells -= this.#recent.shift().data.length;
    this.#patches.push(patch);
    return this.repaint();
  }

  /** Paint the map again, in the colours of now. */
  async repaint() {
    if (this.#message) await this.#newest.take(this.#message);
    else this.#patches = [];
  }

  /** Follow the updates of a topic, once a node publishes them. */
  follow(gateway, topic) {
    this.#end();
    const name = `${topic}_updates`;
    let end = null;
    const look = () => {
      if (!end && gateway.graph.typeOf(name) === UPDATE) end = gateway.subscribe(name, { compression: "cbor" }, (each) => this.update(each), () => {});
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

  async #paint(message) {
    const [waits, patches] = [this.#waits, this.#patches];
    [this.#waits, this.#patches] = [false, []];
    try {
      if (waits) this.#check(message);
      this.#show(message, await this.#painter.paint(waits ? message : null, patches, this.#colours()));
    } catch (error) {
      if (waits && message === this.#message) this.#message = null; // the painter has another one, or none
      throw error;
    }
  }
}

/** Return whether an update is newer than a map. */
function isNewer({ header: { stamp } }, { header }) {
  return (stamp.sec - header.stamp.sec || stamp.nanosec - header.stamp.nanosec) > 0;
}
