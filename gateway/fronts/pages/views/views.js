// SPDX-License-Identifier: Apache-2.0
// Which views there are, and which fits a type best. To add one, see docs/contributing/adding-a-view.md.

import { say } from "../shared/language.js";
import { BatteryView } from "./battery.js";
import { DiagnosticsView } from "./diagnostics.js";
import { FixView } from "./fix.js";
import { FramesView } from "./frames.js";
import { GaugeView } from "./gauge.js";
import { ImageView } from "./image.js";
import { ImuView } from "./imu.js";
import { JointsView } from "./joints.js";
import { JoyView } from "./joy.js";
import { LampView } from "./lamp.js";
import { LogView } from "./log.js";
import { MapView } from "./map.js";
import { PlotView } from "./plot.js";
import { PosesView } from "./poses.js";
import { RangeView } from "./range.js";
import { RawView } from "./raw.js";
import { ScanView } from "./scan.js";
import { TrailView } from "./trail.js";
import { TreeView } from "./tree.js";
import { ValueView } from "./value.js";
import { WorldView } from "./world.js";

/**
 * A way to show the messages of one topic.
 *
 * `element` is what is seen, `options` are members of
 * `subscribe`. `show` gets the newest message before the next frame of the screen, `keep` every one.
 * `rest` is the least number of milliseconds between two calls of `show`.
 *
 * `hold` is called when the card stands still, and when it goes on. `recolour` is called when the page has other colours: a view without it
 * gets the message that it shows by `show` again.
 * `wake` is called when its card has received nothing for a while, because nobody saw it.
 * `draw` is called before each frame of the screen, `close` at the end.
 * Its class has a `title` for people, and the `types` that it shows best: all, if it names none. `isForAll`: it also shows others.
 *
 * The keys stand in addresses that people keep. The first view of a type is what it opens in.
 */
const VIEWS = {
  image: ImageView,
  scan: ScanView,
  map: MapView,
  battery: BatteryView,
  log: LogView,
  trail: TrailView,
  diagnostics: DiagnosticsView,
  imu: ImuView,
  joints: JointsView,
  fix: FixView,
  range: RangeView,
  joy: JoyView,
  poses: PosesView,
  frames: FramesView,
  lamp: LampView,
  world: WorldView,
  tree: TreeView,
  plot: PlotView,
  value: ValueView,
  gauge: GaugeView,
  raw: RawView,
};

/** Return the keys of the views that can show a type, the best first. */
export function viewsFor(type) {
  const keys = Object.keys(VIEWS);
  const best = keys.filter((key) => VIEWS[key].types?.includes(type));
  return [...best, ...keys.filter((key) => !best.includes(key) && isForAll(VIEWS[key]))];
}

/** Return why a view cannot show a type, in words, or "". */
export function misfit(key, type) {
  const { title, types } = VIEWS[key];
  if (!type || isForAll(VIEWS[key]) || types.includes(type)) return "";
  return say("view.misfit", { title, types: types.map(nameOfType).join(", "), type: nameOfType(type) });
}

/** Return the name of a view, as people read it. */
export const nameOf = (key) => VIEWS[key].title;

/** Return whether there is a view of this key. An old address may have others. */
export const isView = (key) => Object.hasOwn(VIEWS, key);

/** Make a view of a card. */
export const makeView = (key, card) => new VIEWS[key](card);

const nameOfType = (type) => type.split("/").at(-1);

const isForAll = ({ types, isForAll: also = false }) => also || !types;
