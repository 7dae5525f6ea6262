// SPDX-License-Identifier: Apache-2.0
// Which views there are, and which fits a type best.

import { BatteryView } from "./battery.js";
import { ImageView } from "./image.js";
import { LogView } from "./log.js";
import { MapView } from "./map.js";
import { PlotView } from "./plot.js";
import { RawView } from "./raw.js";
import { ScanView } from "./scan.js";
import { TrailView } from "./trail.js";
import { TreeView } from "./tree.js";

const POSES = ["nav_msgs/msg/Odometry", "nav_msgs/msg/Path", "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped"];

/**
 * A way to show the messages of one topic. `element` is what is seen, `options` are members of
 * `subscribe`. `show` gets the newest message before the next frame of the screen, `keep` every one.
 * `rest` is the least number of milliseconds between two calls of `show`.
 * `draw` is called before each frame of the screen, `close` at the end.
 */
const VIEWS = {
  image: { name: "Image", make: ImageView, types: ["sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"] },
  scan: { name: "Scan", make: ScanView, types: ["sensor_msgs/msg/LaserScan"] },
  map: { name: "Map", make: MapView, types: ["nav_msgs/msg/OccupancyGrid"] },
  battery: { name: "Battery", make: BatteryView, types: ["sensor_msgs/msg/BatteryState"] },
  log: { name: "Log", make: LogView, types: ["rcl_interfaces/msg/Log"] },
  trail: { name: "Trail", make: TrailView, types: POSES },
  tree: { name: "Fields", make: TreeView },
  plot: { name: "Plot", make: PlotView },
  raw: { name: "Frames", make: RawView },
};

/** Return the keys of the views that can show a type, the best first. */
export function viewsFor(type) {
  return Object.keys(VIEWS).filter((key) => VIEWS[key].types?.includes(type) ?? true);
}

/** Return why a view cannot show a type, in words, or "". */
export function misfit(key, type) {
  const { name, types } = VIEWS[key];
  if (!type || !types || types.includes(type)) return "";
  return `The view ${name} shows ${types.map((each) => each.split("/").at(-1)).join(", ")}, not ${type.split("/").at(-1)}: choose another view.`;
}

/** Return the name of a view, as people read it. */
export const nameOf = (key) => VIEWS[key].name;

/** Return whether there is a view of this key. An old address may have others. */
export const isView = (key) => Object.hasOwn(VIEWS, key);

/** Make a view of a card. */
export const makeView = (key, card) => new VIEWS[key].make(card);
