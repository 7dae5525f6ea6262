// SPDX-License-Identifier: Apache-2.0
// The kinds of layers: by the type of a topic the display, and its first look. To add a kind, write its display and a line here.

import { say } from "../shared/language.js";
import { AxesDisplay } from "./axes.js";
import { CloudDisplay } from "./cloud.js";
import { FrustumDisplay } from "./frustum.js";
import { GridDisplay } from "./grid.js";
import { MarkersDisplay } from "./markers.js";
import { PathDisplay } from "./path.js";
import { PosesDisplay } from "./poses.js";
import { RangeDisplay } from "./range.js";
import { RobotDisplay } from "./robot.js";
import { ScanDisplay } from "./scan.js";

/** The pseudo topic of the axes of all frames. */
export const FRAMES = "/tf";

/**
 * A kind of layer. `size` says what its number means, with the limits. Without it the layer has none.
 * @typedef {{name: string, Display: any, colour?: string, size?: {name: string, value: number, most: number, step: number}, mode?: string, isOff?: boolean, isThinned?: boolean}} Kind
 */

const metres = (name, value, most) => ({ name: say(`size.${name}`), value, most, step: most / 100 });
const OPACITY = { name: say("size.opacity"), value: 1, most: 1, step: 0.05 };
/** @type {Record<string, Kind>} */
const KINDS = {
  "nav_msgs/msg/OccupancyGrid": { name: say("layer.map"), Display: GridDisplay, size: OPACITY },
  "sensor_msgs/msg/LaserScan": { name: say("layer.scan"), Display: ScanDisplay, colour: "#e05adf", size: metres("points", 0.05, 0.3) },
  "sensor_msgs/msg/PointCloud2": { name: say("layer.cloud"), Display: CloudDisplay, colour: "#4cc9b8", size: metres("points", 0.03, 0.3), mode: "height", isThinned: true },
  "nav_msgs/msg/Path": { name: say("layer.path"), Display: PathDisplay, colour: "#3fb950" },
  "geometry_msgs/msg/PolygonStamped": { name: say("layer.polygon"), Display: PathDisplay, colour: "#f2b84b" },
  "geometry_msgs/msg/PoseArray": { name: say("layer.poses"), Display: PosesDisplay, colour: "#ff8f8f", size: metres("arrows", 0.3, 2) },
  "geometry_msgs/msg/PoseStamped": { name: say("layer.pose"), Display: PosesDisplay, colour: "#f2b84b", size: metres("arrow", 0.5, 2) },
  "geometry_msgs/msg/PoseWithCovarianceStamped": { name: say("layer.pose"), Display: PosesDisplay, colour: "#8fb3ff", size: metres("arrow", 0.5, 2) },
  "nav_msgs/msg/Odometry": { name: say("layer.odometry"), Display: PosesDisplay, colour: "#f2b84b", size: metres("arrow", 0.4, 2), isOff: true },
  "visualization_msgs/msg/Marker": { name: say("layer.marker"), Display: MarkersDisplay },
  "visualization_msgs/msg/MarkerArray": { name: say("layer.markers"), Display: MarkersDisplay },
  "sensor_msgs/msg/Range": { name: say("layer.range"), Display: RangeDisplay, colour: "#8fb3ff" },
  "sensor_msgs/msg/CameraInfo": { name: say("layer.camera"), Display: FrustumDisplay, colour: "#f2b84b", size: metres("depth", 1, 5), isOff: true },
};
const ROBOT = { name: say("layer.robot"), Display: RobotDisplay };
const COSTMAP = { name: say("layer.costmap"), Display: GridDisplay, colour: "#d92d3a", size: { ...OPACITY, value: 0.7 }, mode: "costmap", isOff: true };
const AXES = { name: say("layer.frames"), Display: AxesDisplay, size: metres("axes", 0.2, 2), isOff: true };

/**
 * Return the kind of layer for a topic, or null.
 * @param {string} topic
 * @param {string} type
 * @returns {Kind|null}
 */
export function kindOf(topic, type) {
  if (topic === FRAMES) return AXES;
  if (type === "std_msgs/msg/String") return topic.endsWith("/robot_description") ? ROBOT : null;
  if (type === "nav_msgs/msg/OccupancyGrid" && topic.includes("costmap")) return COSTMAP;
  return Object.hasOwn(KINDS, type) ? KINDS[type] : null;
}

/** Return whether a topic has a place in a scene. */
export const isShowable = (topic, type) => kindOf(topic, type) !== null;
