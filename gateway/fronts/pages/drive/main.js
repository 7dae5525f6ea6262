// SPDX-License-Identifier: Apache-2.0
// The drive page: camera, the robot from above, and a robot that moves while something is held.

import * as bar from "../shared/bar.js";
import { CommandTopic } from "../shared/command_topic.js";
import { find } from "../shared/dom.js";
import { Driver } from "../shared/driver.js";
import { Gateway } from "../shared/gateway.js";
import { say } from "../shared/language.js";
import { watch } from "../shared/held.js";
import { Motion } from "../shared/motion.js";
import { namedCommand, published, tellWrong } from "../shared/named_topics.js";
import { Picture } from "../views/picture.js";
import { MapView } from "../views/map.js";
import { ScanView } from "../views/scan.js";
import { wakeLock } from "./awake.js";
import { listCameras } from "./cameras.js";
import { Gamepads } from "./gamepad.js";
import { Footprint, Trail } from "./overlays.js";
import { Place } from "./place.js";
import { Readout } from "./readout.js";
import { Scenery } from "./scenery.js";

const TICK_MS = 200;
// After how long these are old. A map arrives now and then, its place once per second.
const LATE_MS = { map: 10_000, place: 2000 };
// How long a phone and a gamepad shake: when the robot begins to move, and when something else than the driver has stopped it.
const BEGIN_MS = 30;
const STOPPED_MS = 250;

const gateway = new Gateway({ say });
const camera = new Place(find("camera"), gateway);
const world = new Place(find("world"), gateway, LATE_MS);
const scenery = new Scenery(gateway, find("scene"), find("choose-scene"), LATE_MS);
const motion = new Motion();
const readout = new Readout(gateway, find("readout"));
const trail = new Trail();
const footprint = new Footprint(gateway, () => world.view?.redraw?.());
const stayAwake = wakeLock();
let wasDriving = false;
const heard = { odometry: "", scan: "", map: "" }; // topics. A robot that is gone takes them out of the graph
let isConnected = false;
gateway.on("state", ({ state }) => {
  isConnected = state === "open";
  letGo(); // a key that was held before belongs to another connection
});
const command = new CommandTopic(gateway, told, namedCommand());

bar.connect(gateway, "drive", { keys: [["← ↑ ↓ →", say("keys.drive")], ["Space", say("keys.stop")], ["Q E", say("keys.turn")], ["+ -", say("keys.zoom")]] });
tellWrong(gateway, bar.tell, "scan", "odometry");
gateway.on("status", ({ code, request }) => code === "forbidden" && request === "publish" && command.forbid()); // roles may be of any name
const driver = new Driver((shares) => {
  const [linear, angular] = [shares.linear * find("linear").valueAsNumber, shares.angular * find("angular").valueAsNumber];
  motion.command(linear, angular, command.publish(linear, angular) && command.isDriving);
  if (linear || angular) stayAwake();
});
const held = watch(find("stick"), find("knob"), (linear, angular) => driver.hold(linear, angular), window, find("pad"));
const gamepads = new Gamepads(held.push, {
  stop: () => find("stop").click(),
  changed: (isThere) => {
    find("hint").textContent = isThere ? say("drive.hint.gamepad") : say("drive.hint.keys");
    find("hint").classList.toggle("always", isThere);
  },
});

function letGo() {
  held.letGo();
  gamepads.letGo();
}

function draw() {
  requestAnimationFrame(draw); // first: whatever fails here, the next frame comes
  camera.draw();
  world.draw();
  scenery.draw();
}

/** Write what changes with time. */
function tick() {
  const of = (topic) => gateway.arrivals.get(topic);
  camera.write({ camera: camera.arrivals }, isConnected);
  readout.write();
  const sources = { odometry: of(heard.odometry), scan: of(heard.scan), map: of(heard.map), place: world.view?.place };
  world.write(sources, isConnected);
  scenery.write({ ...sources, place: of("/tf") }, isConnected);
  const words = (command.isDriving && motion.words) || command.words;
  if (find("control").textContent !== words) find("control").textContent = words; // it is read out
}

/** Subscribe to the odometry, once there is one. */
function hear() {
  heard.scan ||= published(gateway.graph, "scan");
  heard.map ||= published(gateway.graph, "map");
  readout.look();
  footprint.look();
  if (heard.odometry) return;
  heard.odometry = published(gateway.graph, "odometry");
  if (heard.odometry) gateway.subscribe(heard.odometry, { throttle_rate: 100 }, (message) => {
    motion.odometry(message);
    readout.odometry(message);
  }, () => {});
}

/** Shake what is held, where it can: a person who drives looks at the robot. */
function shake(ms) {
  gamepads.shake(ms);
  if (navigator.userActivation?.hasBeenActive) navigator.vibrate?.(ms); // or else the browser complains
}

function feel() {
  if (command.isDriving && !wasDriving) shake(BEGIN_MS);
  if (!command.isDriving && wasDriving && command.state?.cause !== "zero") shake(STOPPED_MS);
  wasDriving = command.isDriving;
}

function told() {
  tick();
  find("stick").setAttribute("aria-disabled", String(command.isForbidden || !command.state)); // as it moves nothing
  for (const name of ["linear", "angular"]) find(name).disabled = command.isForbidden;
  find("take").hidden = command.isForbidden || command.state?.holder !== "other";
  bar.review(command);
  feel();
  if (!command.isFree) letGo(); // it has to be pressed again
}

const showCamera = () => camera.show(say("drive.no.camera"), [Picture, "camera"]);

function showWorld() {
  world.show(say("drive.no.world"), [MapView, "map"], [ScanView, "scan"]);
  if (!(world.view instanceof MapView) || world.view.overlays.length) return;
  world.view.overlays.push((plan, frame, robot) => trail.draw(plan, frame, robot), (plan, frame) => footprint.draw(plan, frame));
}

gateway.on("graph", () => {
  showCamera();
  showWorld();
  hear();
});
listCameras(find("cameras"), gateway, showCamera);
gateway.subscribe("/rosout", {}, (line) => motion.log(line, command.name), () => {}); // without it the page knows less, and drives

bar.stopBySpace();
gateway.on("stopping", letGo);
find("take").onclick = async () => {
  try {
    await command.acquire();
    driver.ready();
  } catch (error) {
    bar.tell(error.message);
  }
};
for (const [name, unit] of [["linear", "m/s"], ["angular", "rad/s"]]) {
  const write = () => {
    const text = `${find(name).valueAsNumber.toFixed(2)} ${unit}`;
    find(`${name}-text`).textContent = text;
    find(name).setAttribute("aria-valuetext", text);
  };
  find(name).oninput = write;
  find(name).onpointerup = () => find(name).blur(); // or the arrow keys would go on moving it, and not the robot
  write();
}

gateway.connect();
draw();
setInterval(tick, TICK_MS);
