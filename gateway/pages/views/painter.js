// SPDX-License-Identifier: Apache-2.0
import { palette } from "./occupancy.js";

/** Paints maps beside the page's own thread: one of 16 million cells takes longer than a command may be late. */
export class Painter {
  #worker = new Worker(new URL("./map_worker.js", import.meta.url), { type: "module" });

  /**
   * Paint a `nav_msgs/msg/OccupancyGrid`, with its cells or as a picture; call it again only when this one is done.
   * @returns {Promise<{bitmap: ImageBitmap, cells: number}>} the first row is at the bottom; how many cells of the map a pixel is wide
   */
  paint({ info: { width, height }, data, format }) {
    return new Promise((resolve, reject) => {
      this.#worker.onmessage = ({ data: { problem, ...painted } }) => (problem ? reject(new Error(problem)) : resolve(painted));
      this.#worker.onerror = ({ message }) => reject(new Error(message || "its worker does not start"));
      this.#worker.postMessage({ width, height, data, format, colours: palette() });
    });
  }

  close() {
    this.#worker.terminate();
  }
}
