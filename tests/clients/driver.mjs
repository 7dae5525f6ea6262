// SPDX-License-Identifier: Apache-2.0
/**
 * Drives roslib, 1.x or 2.x: commands as JSON lines on stdin, answers and events on stdout.
 *
 *     node driver.mjs DIRECTORY    of a package.json with roslib installed
 *
 * A command is `{"n": 1, "do": "subscribe", "connection": "a", ...}`. Its answer has the same `n`
 * and a `result` or a `failure`. An event is `{"event": ..., "connection": ..., "name":
 * ..., "value": ...}`. A warning of roslib is the event `warning`.
 */

import { readFileSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";

const RETRY_MS = 100;

const home = join(process.argv[2], "node_modules/roslib");
const about = JSON.parse(readFileSync(join(home, "package.json"), "utf8"));
const imported = await import(pathToFileURL(join(home, about.module ?? about.main)).href);
const ROSLIB = imported.default ?? imported;

/** @param {string} _ @param {unknown} value */
function plain(_, value) {
  if (typeof value === "bigint") {
    return value.toString();
  }
  if (ArrayBuffer.isView(value)) {
    return { array: value.constructor.name, values: Array.from(value, (each) => plain("", each)) };
  }
  return value;
}

/** @param {object} line */
function say(line) {
  process.stdout.write(`${JSON.stringify(line, plain)}\n`);
}

console.error = console.warn = (...words) => {
  say({ event: "warning", connection: "", name: "", value: words.map(String).join(" ") });
};

/** One connection, and what was made on it, each by its name. */
class Connection {
  constructor(name) {
    this.name = name;
    this.made = new Map();
  }

  tell(event, name, value) {
    say({ event, connection: this.name, name, value });
  }

  /** Return what was made under a name, making it now if it was not. */
  one(kind, name, make) {
    const key = `${kind} ${name}`;
    if (!this.made.has(key)) {
      this.made.set(key, make());
    }
    return this.made.get(key);
  }

  // An encoding keeps roslib 1 from complaining about the lack of one. roslib 2 has no such option.
  connect({ url, again = false, token = null }) {
    this.again = again;
    this.ros = new ROSLIB.Ros({ encoding: "utf8" });
    if (token !== null) {
      // the first listener sends before all others, also when the connection has come again
      this.ros.on("connection", () => this.ros.callOnConnection({ op: "auth", token }));
    }
    this.ros.on("error", (error) => {
      if (!this.again) {
        this.tell("warning", "", String(error?.message ?? error));
      }
    });
    this.ros.on("close", () => {
      this.tell("closed", "", null);
      if (this.again) {
        setTimeout(() => this.ros.connect(url), RETRY_MS);
      }
    });
    this.ros.on("connection", () => this.tell("connected", "", null));
    // Every status is emitted under a name made of its id, which nobody can know beforehand.
    const { emit } = this.ros;
    this.ros.emit = (event, ...values) => {
      if (event.startsWith("status")) {
        this.tell("warning", "", values[0]);
      }
      return emit.call(this.ros, event, ...values);
    };
    this.ros.connect(url);
    return new Promise((resolve) => this.ros.once("connection", () => resolve(null)));
  }

  close() {
    this.again = false;
    return new Promise((resolve) => {
      this.ros.once("close", () => resolve(null));
      this.ros.close();
    });
  }

  topic({ topic, type_name, options = {} }) {
    const make = () =>
      new ROSLIB.Topic({ ros: this.ros, name: topic, messageType: type_name, ...options });
    return this.one("topic", topic, make);
  }

  subscribe(command) {
    this.topic(command).subscribe((message) => this.tell("message", command.topic, message));
  }

  unsubscribe(command) {
    this.topic(command).unsubscribe();
  }

  advertise(command) {
    this.topic(command).advertise();
  }

  unadvertise(command) {
    this.topic(command).unadvertise();
  }

  publish(command) {
    this.topic(command).publish(command.message);
  }

  service({ service, type_name }) {
    const make = () => new ROSLIB.Service({ ros: this.ros, name: service, serviceType: type_name });
    return this.one("service", service, make);
  }

  call_service(command) {
    return new Promise((resolve, reject) => {
      this.service(command).callService(command.args, resolve, reject, command.timeout);
    });
  }

  advertise_service(command) {
    return this.service(command).advertise((request, response) => {
      this.tell("request", command.service, request);
      Object.assign(response, command.values);
      return command.result;
    });
  }

  /** Answer each request only when told to, which is never. */
  advertise_silent_service(command) {
    return this.service(command).advertiseAsync((request) => {
      this.tell("request", command.service, request);
      return new Promise(() => {});
    });
  }

  unadvertise_service(command) {
    return this.service(command).unadvertise();
  }

  action({ action, type_name }) {
    const make = () => new ROSLIB.Action({ ros: this.ros, name: action, actionType: type_name });
    return this.one("action", action, make);
  }

  send_goal(command) {
    const id = this.action(command).sendGoal(
      command.goal,
      (values) => this.tell("result", id, values),
      (values) => this.tell("feedback", id, values),
      (reason) => this.tell("failure", id, reason),
    );
    return id;
  }

  cancel_goal(command) {
    this.action(command).cancelGoal(command.goal_id);
  }

  cancel_all_goals(command) {
    this.action(command).cancelAllGoals();
  }

  advertise_action(command) {
    this.action(command).advertise(
      (goal, id) => this.tell("goal", command.action, { id, goal }),
      (id) => this.tell("cancel", command.action, id),
    );
  }

  unadvertise_action(command) {
    this.action(command).unadvertise();
  }

  send_feedback(command) {
    this.action(command).sendFeedback(command.goal_id, command.values);
  }

  succeed(command) {
    this.action(command).setSucceeded(command.goal_id, command.values);
  }

  end_as_canceled(command) {
    this.action(command).setCanceled(command.goal_id, command.values);
  }

  fail(command) {
    this.action(command).setFailed(command.goal_id);
  }

  /** Follow a frame by a client of transforms, which asks a service if *service* is true. */
  follow({ kind, options, frame, service }) {
    const make = () => new ROSLIB[kind]({ ros: this.ros, ...options });
    this.ros.groovyCompatibility = !service; // which roslib 2 has no more
    this.one("tf", kind, make).subscribe(frame, (transform) => {
      this.tell("transform", frame, transform);
    });
  }

  dispose({ kind }) {
    this.one("tf", kind).dispose();
  }

  param({ name }) {
    return new ROSLIB.Param({ ros: this.ros, name });
  }

  get_param(command) {
    return new Promise((resolve, reject) => this.param(command).get(resolve, reject));
  }

  set_param(command) {
    return new Promise((resolve, reject) => {
      this.param(command).set(command.value, () => resolve(null), reject);
    });
  }

  delete_param(command) {
    return new Promise((resolve, reject) => {
      this.param(command).delete(() => resolve(null), reject);
    });
  }

  /** Call one of the questions of Ros, such as getTopics, named as in Python. */
  ask({ question, args }) {
    const method = question.replace(/_(.)/g, (_, letter) => letter.toUpperCase());
    return new Promise((resolve, reject) => {
      const answer = (...answers) => {
        const [subscribing, publishing, services] = answers;
        // roslib 1 spreads the details of a node over arguments
        resolve(answers.length === 3 ? { subscribing, publishing, services } : answers[0]);
      };
      this.ros[method](...args, answer, reject);
    });
  }

  decode_type_defs({ typedefs }) {
    return this.ros.decodeTypeDefs(typedefs);
  }

  publishers(command) {
    return new Promise((resolve, reject) => this.topic(command).getPublishers(resolve, reject));
  }

  /** Send an operation that no method of roslib's sends. */
  send({ operation }) {
    this.ros.callOnConnection(operation);
  }

  /** Report the messages of a topic to every subscriber. */
  listen({ topic }) {
    this.ros.on(topic, (frame) => this.tell("message", topic, frame.msg));
  }

  set_status_level({ level }) {
    this.ros.setStatusLevel(level);
  }
}

const connections = new Map();

async function carryOut(command) {
  const { n, connection: name } = command;
  if (!connections.has(name)) {
    connections.set(name, new Connection(name));
  }
  try {
    say({ n, result: (await connections.get(name)[command.do](command)) ?? null });
  } catch (error) {
    say({ n, failure: error instanceof Error ? `${error.stack}` : error });
  }
}

createInterface({ input: process.stdin })
  .on("line", (line) => carryOut(JSON.parse(line)))
  .on("close", () => process.exit(0));
