// SPDX-License-Identifier: Apache-2.0
import { say } from "../shared/language.js";
import { palette } from "./occupancy.js";

/** How a map is asked for: of a large one a picture is a tenth, or less. One that grows comes as a whole. */
export const MAP_OPTIONS = { compression: "cbor", throttle_rate: 1000, image: { format: "png" } };

/** Paints maps on another thread: one of 16 million cells takes longer than a command may be late. */
export class Painter {
  #worker = new Worker(new URL("./map_worker.js", import.meta.url), { type: "module" });

  /**
   * Paint a `nav_msgs/msg/OccupancyGrid`, with its cells or as a picture, in a colour for each octet. Call it again only when this one is done.
   * @param {any} map or null for the one before
   * @param {any[]} patches `map_msgs/msg/OccupancyGridUpdate`, the oldest first, which fit into the map
   * @returns {Promise<{bitmap: ImageBitmap, cells: number, values: Int8Array}>} the first row is at the bottom. How many cells of the map a
   *   pixel is wide. Of each pixel, from the first row of the map on, the most occupied of its cells, 0 to 100, or -1 if none is known
   */
  paint(map, patches = [], colours = palette()) {
    const { info: { width = 0, height = 0 } = {}, data = null, format = "" } = map ?? {};
    return new Promise((resolve, reject) => {
      this.#worker.onmessage = ({ data: { problem, cause, ...painted } }) => (problem ? reject(new Error(cause ? say(`map.wrong.${problem}`, cause) : problem)) : resolve(painted));
      this.#worker.onerror = ({ message }) => reject(new Error(message || say("worker.none")));
      this.#worker.postMessage({ map: map && { width, height, data, format }, patches, colours });
    });
  }

  close() {
    this.#worker.terminate();
  }
}
