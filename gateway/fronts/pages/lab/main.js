// SPDX-License-Identifier: Apache-2.0
// The lab: a room with the robot's twin, its camera on a television, and screens. With a headset or without.

import { Vector3, WebGLRenderer } from "../vendor/three.js";
import { Aging } from "../shared/aging.js";
import * as bar from "../shared/bar.js";
import { CommandTopic } from "../shared/command_topic.js";
import { element, find } from "../shared/dom.js";
import { Gateway } from "../shared/gateway.js";
import { say } from "../shared/language.js";
import { watchKeys } from "../shared/keys.js";
import { Motion } from "../shared/motion.js";
import { namedCommand, tellWrong } from "../shared/named_topics.js";
import { isHeld } from "../shared/stop_held.js";
import { Cloud } from "./cloud.js";
import { Controllers } from "./controllers.js";
import { Drawing } from "./drawing.js";
import { entry, meet, toRos } from "./floor.js";
import { FloorMap } from "./floor_map.js";
import { connectHeadset } from "./headset.js";
import { Navigation } from "./navigation.js";
import { Pilot } from "./pilot.js";
import { HIGH_M } from "./raised.js";
import { HALF_M, Room, mark } from "./room.js";
import { Screen } from "./screens.js";
import { Sight } from "./sight.js";
import { Sources } from "./sources.js";
import { teleport } from "./teleport.js";
import { Television } from "./television.js";
import { Twin } from "./twin.js";
import { Viewer } from "./walk.js";

const BEYOND = say("lab.beyond", { metres: HALF_M });
const DRIVING = { ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowLeft: [0, 1], ArrowRight: [0, -1] };

const gateway = new Gateway({ say });
bar.connect(gateway, "lab", { keys: [["← ↑ ↓ →", say("keys.drive")], ["Space", say("keys.stop")]] });
tellWrong(gateway, bar.tell);

const room = new Room();
const viewer = new Viewer();
const twin = new Twin(room);
const map = new FloorMap(bar, room.material("edge"));
const cloud = new Cloud(gateway);
const motion = new Motion();
const television = new Television(bar.tell);
const screens = {
  state: new Screen(say("screen.robot")), topic: new Screen(say("screen.topic")), commands: new Screen(say("screen.commands")), log: new Screen(say("screen.log")),
};
const hung = [television.mesh, ...Object.values(screens).map(({ mesh }) => mesh)];
const sight = new Sight(() => [...hung, ...room.walls], (ray, end) => map.hides(entry(ray, HIGH_M), toRos(end)));
const sources = new Sources(gateway, bar.tell, { twin, map, cloud });
const age = new Aging(find("view"));
const target = room.marker("warning", 0.15);
const place = new Vector3();
const head = new Vector3();
let isConnected = false;
let drawing; // of the renderer, if there is one
let topic = ""; // that the screen shows
let endTopic = () => {};

/** The parts, for tests. */
export const lab = { room, viewer, twin, map, cloud, television, screens, work, render };

const pilot = new Pilot(publish, (words) => {
  find("approach").textContent = words;
  showState();
});
lab.pilot = pilot;
pilot.navigation = new Navigation(gateway, (words) => pilot.navigated(words));
gateway.on("state", ({ state }) => {
  isConnected = state === "open";
  letGoOfAll(say("end.connection"));
  if (isConnected) pilot.forbid(gateway.hello.role === "viewer" ? say("lab.viewer") : ""); // of other roles a refusal tells
});
gateway.on("status", ({ code, request, msg }) => code === "forbidden" && request === "publish" && pilot.forbid(msg));
const command = new CommandTopic(gateway, told, namedCommand()); // after that: what is lost first is the connection
const letGo = watchKeys(DRIVING, (linear, angular) => pilot.hold(linear, angular));
furnish();
room.scene.add(viewer.rig, map.world, cloud.world);
room.scene.updateMatrixWorld(); // or a ray that comes before the first frame would find all things in the middle
const renderer = begin();
const controllers = renderer && new Controllers(renderer.xr, viewer.rig, room, {
  target: point,
  refuse: (why) => pilot.stop(why),
  stop: pressStop,
  gone: () => letGoOfAll(say("end.controller")),
  stand,
  teleport: go,
});
lab.renderer = renderer;

/** Hang television and screens on the walls. */
function furnish() {
  const hang = (mesh, x, y, z, turn = 0) => {
    mesh.position.set(x, y, z);
    mesh.rotation.y = turn;
    room.scene.add(mesh);
  };
  hang(television.mesh, 0, 2.15, -4.4);
  hang(screens.state.mesh, -2.9, 1.9, -2, 0.4);
  hang(screens.topic.mesh, 2.9, 1.9, -2, -0.4);
  hang(screens.log.mesh, -4.3, 1.9, 0, 1.1);
  hang(screens.commands.mesh, 4.3, 1.9, 0, -1.1);
}

/** Return what draws, or null where there is no WebGL. */
function begin() {
  const label = say("lab.label");
  const canvas = element("canvas", { tabIndex: 0, role: "application", aria: { label } });
  let made;
  try {
    made = new WebGLRenderer({ canvas, antialias: devicePixelRatio < 2 });
  } catch (error) {
    find("view").prepend(element("p", {}, say("lab.webgl", { why: error.message })));
    return null;
  }
  find("view").prepend(canvas);
  drawing = new Drawing(canvas, () => {
    letGoOfAll(say("end.undrawn"));
    made.xr.getSession()?.end(); // which shows nothing either, and does not come back
  });
  made.setPixelRatio(Math.min(devicePixelRatio, 2));
  made.xr.enabled = true;
  viewer.listen(canvas, point);
  new ResizeObserver(([{ contentRect: { width, height } }]) => {
    if (made.xr.isPresenting || !width || !height) return;
    made.setSize(width, height, false);
    viewer.camera.aspect = width / height;
    viewer.camera.updateProjectionMatrix();
  }).observe(find("view"));
  let before = 0;
  made.setAnimationLoop((now, frame) => {
    work(now, (now - before) / 1000, frame);
    before = now;
    render();
  });
  connectHeadset(made.xr, find("vr"), find("vr-note"), {
    began: () => {
      letGoOfAll(say("end.vr.began"));
      viewer.isWorn = true;
    },
    unseen: () => letGoOfAll(say("end.unseen")),
    ended: () => {
      letGoOfAll(say("end.vr.left"));
      viewer.isWorn = false;
      viewer.goHome(); // the headset may have gone anywhere
    },
  });
  return made;
}

/** The page's own part of a frame. It allocates nothing. */
function work(now, seconds, frame) {
  viewer.bounds.set(map.reach, twin.pose);
  if (frame) {
    const pose = frame.getViewerPose(renderer.xr.getReferenceSpace())?.transform.position;
    if (pose) viewer.rig.localToWorld(head.set(pose.x, pose.y, pose.z));
    controllers.step();
  } else {
    viewer.step(seconds);
  }
  target.visible &&= pilot.isActive;
  room.open(map.reach);
  for (const name in screens) if (screens[name].step(now)) break; // one a frame
}

function render() {
  renderer.render(room.scene, viewer.camera);
}

/** Send the robot to where a ray meets the floor. If it meets the screen of any topic, show the next one there. */
function point(raycaster) {
  if (drawing.refusal) return pilot.stop(drawing.refusal);
  if (isHeld()) return pilot.stop(say("stop.held"));
  const thing = sight.thing(raycaster);
  if (thing === screens.topic.mesh) return next();
  const refusal = refusalOf(raycaster.ray, thing);
  if (refusal) pilot.stop(refusal); // a user who points means another target than the one before
  else if (pilot.aim(toRos(place), goal())) mark(target, place);
}

/** Return the target for the navigation: on the map, if there is one, and as the robot comes there. */
function goal() {
  const { x, y } = toRos(place);
  const yaw = Math.atan2(y - twin.pose.y, x - twin.pose.x);
  return map.world.visible ? map.goal({ x, y, yaw }) : { x, y, yaw, frame: sources.frame };
}

/** Put into `place` where a ray meets the floor, unless it meets a thing first. Return why the robot cannot be sent there, or "". */
function refusalOf(ray, thing) {
  if (room.walls.includes(thing)) return BEYOND;
  if (thing || !meet(ray, place)) return say("lab.floorless");
  if (map.world.visible) return map.refusal(toRos(place), entry(ray, HIGH_M));
  return Math.max(Math.abs(place.x), Math.abs(place.z)) < HALF_M ? "" : BEYOND;
}

/** Put into a place where a ray meets the floor, or the nearest one where the user may stand. Return whether there is a floor. */
function stand(raycaster, where) {
  if (!sight.floor(raycaster, where)) return false;
  viewer.bounds.keep(where);
  return true;
}

function go(where) {
  teleport(viewer.rig, head, where);
}

/** Stop as the button does: robot and approach. */
function pressStop() {
  find("stop").click();
}

function letGoOfAll(why) {
  letGo();
  controllers?.letGo();
  pilot.end(why);
}

function publish(linear, angular) {
  const isSent = command.publish(linear, angular);
  motion.command(linear, angular, isSent && command.isDriving);
  if (!isSent) return;
  screens.commands.add(`${command.name}  ${linear.toFixed(2)} m/s  ${angular.toFixed(2)} rad/s`);
}

function told() {
  find("take").hidden = command.isForbidden || command.state?.holder !== "other";
  bar.review(command);
  if (!command.isFree) letGo();
  pilot.told(command.state);
  showState();
}

/** The present motion of the robot, in words that fit those about the approach. */
function doing() {
  const { state, guard } = command.state ?? {};
  if (pilot.isActive && guard === "ready" && state !== "moving") return say("lab.about");
  return (command.isDriving && motion.words) || command.words;
}

function showState() {
  const words = doing();
  write("control", words);
  write("missing", sources.missing);
  age.write({ camera: sources.arrivals("camera"), odometry: sources.arrivals("odometry"), scan: sources.arrivals("scan") }, isConnected);
  const { x, y, yaw } = twin.pose;
  const heading = Math.round((yaw * 180) / Math.PI);
  const where = sources.arrivals("odometry") ? say("lab.place", { x: x.toFixed(2), y: y.toFixed(2), heading }) : say("lab.unknown");
  const lines = [find("state").textContent, words, pilot.words, age.words, where, sources.missing];
  screens.state.show(say("screen.robot"), lines.join("\n"));
}

/** Write words where they are read out: only when they have changed. */
function write(id, words) {
  if (find(id).textContent !== words) find(id).textContent = words;
}

function listTopics() {
  const names = sources.readable;
  if (topic && !names.includes(topic)) names.unshift(topic);
  find("topic").replaceChildren(...names.map((name) => element("option", { value: name }, name)));
  find("topic").value = topic;
}

function read(name) {
  endTopic();
  topic = name;
  endTopic = sources.read(name, screens.topic);
  listTopics();
}

function next() {
  const names = sources.readable;
  if (names.length) read(names[(names.indexOf(topic) + 1) % names.length]);
}

gateway.on("graph", () => {
  const isThere = Boolean(pilot.navigation.action);
  find("ways").hidden = !isThere && !pilot.isNavigating; // only the user chooses blind driving
  if (!isThere && pilot.navigation.isActive) pilot.end(say("end.nav2"));
  sources.watch({ pilot, motion, television, log: screens.log, logged: (line) => motion.log(line, command.name) });
  if (!topic && sources.favourite) read(sources.favourite);
  else listTopics();
});

find("home").onclick = () => {
  if (!viewer.isWorn) viewer.goHome();
  renderer?.domElement.focus();
};
/** Let this page or Nav2 drive to the targets. */
function choose(way) {
  pilot.end(say("end.way"));
  pilot.isNavigating = way === "nav2";
  find("way").value = way;
}

find("way").onchange = () => choose(find("way").value);
find("topic").onchange = () => read(find("topic").value); // which keeps the focus: the next arrow key is not for the robot
gateway.on("stopping", () => letGoOfAll(say("end.stop")));
find("take").onclick = async () => {
  try {
    await command.acquire();
    pilot.ready();
  } catch (error) {
    bar.tell(error.message);
  }
};
bar.stopBySpace({ isMoving: () => pilot.isActive || command.state?.state === "moving" });
addEventListener("blur", () => letGoOfAll(say("end.focus")));
addEventListener("pagehide", () => letGoOfAll(say("end.left")));
document.addEventListener("visibilitychange", () => document.hidden && letGoOfAll(say("end.hidden")));
addEventListener("themechange", () => {
  room.paint();
  map.paint();
  for (const name in screens) screens[name].dirty();
});
setInterval(showState, 500);

gateway.connect();
if (document.activeElement === document.body) renderer?.domElement.focus({ preventScroll: true }); // Enter is for it from the first moment
