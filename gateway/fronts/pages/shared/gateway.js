// SPDX-License-Identifier: Apache-2.0
// The connection of a page to a gateway. It comes back by itself, and asks for what was subscribed again.
// Other pages than those of the gateway also use this module: docs/how-to/javascript-module.md. `tools/page-types.sh` writes its types.

import en from "../words/en.js";
import { Arrivals } from "./arrivals.js";
import { BASE } from "./base.js";
import { decode } from "./cbor.js";
import { Drops } from "./drops.js";
import { Graph } from "./graph.js";
import { json, parse } from "./json.js";
import { Pulse } from "./pulse.js";
import * as tokens from "./token.js";
import { worded } from "./worded.js";

const FIRST_RETRY_MS = 500;
const LAST_RETRY_MS = 2000; // a person waits, and stands in a hall with holes in its radio
const WRONG_TOKEN = 4401;
// The codes of warnings about a topic, not about one request for it.
const OF_TOPIC = [
  "type_conflict", "qos_incompatible", "deadline_missed", "liveliness_lost", "messages_lost", "publisher_gone", "not_found", "stale", "fresh",
];

/**
 * Return the address of the WebSocket of the gateway that served this page, or else this module.
 * @returns {string}
 */
export function address() {
  const served = document.querySelector('meta[name="websocket-path"]');
  const { protocol, host } = served ? location : new URL(import.meta.url);
  return `${protocol === "https:" ? "wss" : "ws"}://${host}${served?.getAttribute("content") ?? `${BASE}/`}?status=warning`;
}

/**
 * How to connect.
 * @typedef {object} Options
 * @property {string} [address] of the WebSocket, such as `ws://robot:9090?status=warning`. By default that of the gateway that served this module
 * @property {string} [token] By default the one behind `#token=` in the address of the page, which is kept until its tab is closed
 * @property {(key: string, values?: Record<string, string|number>) => string} [say] returns the words for a key of words/en.js. By default in English
 */

/**
 * The words of the gateway about a request or a topic. docs/reference/errors.md has the codes.
 * @typedef {object} Status
 * @property {"error"|"warning"|"info"|"none"} level
 * @property {string} msg the event, and what to do
 * @property {string} [code] such as `forbidden`
 * @property {string} [request] the operation that it answers
 * @property {string} [id] of that operation
 */

/**
 * The events, each with what its listener gets.
 * @typedef {object} Events
 * @property {{state: "connecting"|"open"|"closed"|"token", reason: string}} state of the connection. `token`: the gateway needs one, or another one
 * @property {number} silence the seconds for which nothing came although an answer is due. 0 when it is over
 * @property {Status} status about nothing that hears it elsewhere
 * @property {any} graph a frame with what has changed in `graph`
 * @property {any} control a frame with the state of a command topic, after the operation `control` with `watch`
 * @property {null} stopping `stop` was called: let go of all that is held
 */

/**
 * One subscription of a page. Several may be to the same topic.
 * @typedef {object} Subscription
 * @property {string} id
 * @property {string} topic
 * @property {object} options
 * @property {OnMessage} onMessage
 * @property {(status: Status) => void} onStatus
 * @property {boolean} isRefused whether the gateway does not have it
 */

/**
 * Gets each message of a topic, its size on the network, the frame as it arrived, and how many messages were dropped before it.
 * @callback OnMessage
 * @param {any} message
 * @param {number} size
 * @param {string|ArrayBuffer} data
 * @param {number} dropped
 * @returns {void}
 */

/**
 * A connection to a gateway. `on` hears its events. A frame that answers nothing is an event with the name of its operation.
 */
export class Gateway extends EventTarget {
  #socket = null;
  #subscriptions = new Map();
  #lookups = new Map(); // id -> a repeated lookup of a transform
  #listeners = new Map(); // id -> what hears its frames
  #pending = new Map();
  #nextId = 1;
  #retryMs = FIRST_RETRY_MS;
  #address;
  #token;
  #say;
  #keep = tokens.keep;
  #pulse = new Pulse(() => this.#ping(), (seconds) => this.#tellOfSilence(seconds), (seconds) => this.#giveUp(seconds));
  #throttles = new Map(); // topic -> milliseconds
  #drops = new Map(); // topic -> Drops
  #settling = new Set(); // topics without a throttle, which the gateway may not have read yet
  #isRefused = false;
  #retry; // the timer of the next attempt
  #clockErrorMs = Infinity;

  /**
   * Frames and bytes so far, messages that were dropped for this page, and the last round trip in milliseconds.
   * @type {{frames: number, bytes: number, dropped: number, roundTripMs: number|null}}
   */
  counts = { frames: 0, bytes: 0, dropped: 0, roundTripMs: null };
  /** The answer to `hello`, such as the role, or null before the first connection. @type {any} */
  hello = null;
  /** The ROS graph. The event `graph` follows each change. */
  graph = new Graph();
  /** The arrivals of each topic, in bytes as they are in ROS. @type {Map<string, Arrivals>} */
  arrivals = new Map();

  /** @param {Options} [options] */
  constructor({ address: wanted, token, say = (key, values) => worded(en, key, values) } = {}) {
    super();
    this.#say = say;
    this.#address = wanted ?? address();
    this.#token = token === undefined ? tokens.take() : tokens.cleaned(token);
    if (token !== undefined) this.#keep = () => {};
  }

  /**
   * Hear an event until the function that this returns is called.
   * @template {keyof Events} Name
   * @param {Name} name
   * @param {(detail: Events[Name]) => void} take
   * @returns {() => void}
   */
  on(name, take) {
    const hear = (event) => take(event.detail);
    this.addEventListener(name, hear);
    return () => this.removeEventListener(name, hear);
  }

  /** Connect, and again whenever the connection is lost, until `close`. */
  connect() {
    clearTimeout(this.#retry);
    if (this.#token && !tokens.isToken(this.#token)) {
      this.#refuse(this.#say("token.invalid"));
      return;
    }
    this.#announce("connecting");
    const protocols = this.#token ? ["ros2-gateway", `bearer.${this.#token}`] : [];
    const socket = new WebSocket(this.#address, protocols);
    this.#socket = socket;
    socket.binaryType = "arraybuffer";
    const ifCurrent = (action) => (event) => socket === this.#socket && action(event);
    socket.onopen = ifCurrent(() => this.#open());
    socket.onmessage = ifCurrent(({ data }) => this.#receive(data));
    socket.onclose = ifCurrent((event) => this.#close(event));
    this.#pulse.begin();
  }

  /** End the connection. The gateway stops what this page drives. `connect` begins again. */
  close() {
    const socket = this.#socket;
    this.#close({ code: 0, reason: "" });
    clearTimeout(this.#retry);
    socket?.close();
  }

  /** Whether operations can be sent. */
  get isOpen() {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  /**
   * Connect with a token from now on.
   * @param {string} token
   */
  useToken(token) {
    this.#token = tokens.cleaned(token);
    this.#isRefused = false;
    this.connect();
  }

  /**
   * Send an operation of docs/reference/protocol. Return whether there is a connection to send it by.
   * @param {{op: string, [field: string]: any}} operation
   * @param {Object<string, string>} [json] further members, as JSON: their integers may be larger than a number here
   */
  send(operation, json = {}) {
    if (!this.isOpen) return false;
    const members = Object.entries(json).map(([name, text]) => `,${JSON.stringify(name)}:${text}`);
    this.#socket.send(`${JSON.stringify(operation).slice(0, -1)}${members.join("")}}`);
    return true;
  }

  /**
   * Send an operation and return its answer. Rejects with the gateway's words, and its `code`, as an error.
   * @param {{op: string, [field: string]: any}} operation
   * @param {Object<string, string>} [json] as for `send`
   * @returns {Promise<any>}
   */
  ask(operation, json = {}) {
    const id = `page:${this.#nextId++}`;
    return new Promise((resolve, reject) => {
      this.#pending.set(id, { resolve, reject });
      if (!this.send({ ...operation, id }, json)) this.#settle(id, null, this.#say("unconnected"));
    });
  }

  /**
   * Stop the robot, even if another client drives. First let go of everything: the gateway sees this page's STOP as this client's own stop,
   * and what is still held would drive on.
   * @returns {Promise<{topics: string[]}>} what it stopped
   */
  stop() {
    this.dispatchEvent(new CustomEvent("stopping"));
    return this.ask({ op: "stop" });
  }

  /**
   * Hear all frames that name an id, for operations that have no answer, or several.
   * @param {(frame: any) => void} onFrame
   * @returns {{id: string, end: () => void}}
   */
  listen(onFrame) {
    const id = `page:${this.#nextId++}`;
    this.#listeners.set(id, onFrame);
    return { id, end: () => this.#listeners.delete(id) };
  }

  /**
   * Subscribe until the function that this returns is called.
   * @param {string} topic
   * @param {object} options further members of the operation `subscribe`, such as `throttle_rate` or `fields`
   * @param {OnMessage} onMessage
   * @param {(status: Status) => void} [onStatus] By default these are events
   * @returns {() => void}
   */
  subscribe(topic, options, onMessage, onStatus = (status) => this.#tell(status)) {
    const id = `page:${this.#nextId++}`;
    const subscription = { id, topic, options, onMessage, onStatus, isRefused: false };
    const before = this.throttleOf(topic);
    this.#subscriptions.set(id, subscription);
    this.#send(subscription);
    if (before && this.throttleOf(topic) === 0) this.#settleDrops(topic);
    return () => {
      const throttle = this.throttleOf(topic);
      if (this.#subscriptions.delete(id)) this.send({ op: "unsubscribe", id, topic });
      const isHeard = this.#merge(topic);
      if (throttle && !this.throttleOf(topic)) this.#settleDrops(topic); // the next subscription may still hear messages under way
      if (isHeard) return;
      this.arrivals.delete(topic);
      this.#drops.delete(topic);
    };
  }

  /**
   * Return the least number of milliseconds between two messages of a topic, as this page has asked for it. 0 for all messages.
   * @param {string} topic
   * @returns {number|undefined}
   */
  throttleOf(topic) {
    return this.#throttles.get(topic);
  }

  /** Note the throttle of a topic, because the gateway makes one subscription of all. Return whether there is any. */
  #merge(topic) {
    const throttles = this.#heard(topic).map(({ options }) => options.throttle_rate ?? 0);
    if (throttles.length) this.#throttles.set(topic, Math.min(...throttles));
    else this.#throttles.delete(topic);
    return throttles.length > 0;
  }

  /**
   * Report where a frame is, when that is known and when it has changed, until the function that this returns is called.
   * @param {string} target
   * @param {string} source the frame whose pose in *target* is reported
   * @param {number} rate at most so many a second
   * @param {(transform: any) => void} onTransform gets `translation` and `rotation`
   * @returns {() => void}
   */
  followTransform(target, source, rate, onTransform) {
    const id = `page:${this.#nextId++}`;
    const request = { op: "lookup_transform", id, target_frame: target, source_frame: source, rate };
    this.#lookups.set(id, { request, onTransform });
    this.send(request);
    return () => {
      if (this.#lookups.delete(id)) this.send({ op: "cancel_transform", id });
    };
  }

  #send(subscription) {
    const { id, topic, options } = subscription;
    subscription.isRefused = false;
    this.#merge(topic);
    this.send({ op: "subscribe", id, topic, meta: true, nonfinite: "string", ...options });
  }

  async #open() {
    try {
      this.hello = await this.ask({ op: "hello" });
    } catch (error) {
      if (error.code === "forbidden") this.#refuse();
      return;
    }
    this.#keep(this.#token);
    this.#retryMs = FIRST_RETRY_MS;
    this.#clockErrorMs = Infinity; // the gateway may be another one
    for (const drops of this.#drops.values()) drops.restart();
    this.#announce("open");
    this.send({ op: "graph", watch: true });
    for (const subscription of this.#subscriptions.values()) this.#send(subscription);
    for (const { request } of this.#lookups.values()) this.send(request);
    this.#pulse.ask();
  }

  async #ping() {
    const began = performance.now();
    try {
      const { gateway_time: { sec, nanosec } } = await this.ask({ op: "ping" });
      const roundTripMs = performance.now() - began;
      this.counts.roundTripMs = roundTripMs;
      this.#clockErrorMs *= 1.1; // clocks drift and are set, so an old ping counts less and less
      if (roundTripMs >= this.#clockErrorMs) return;
      this.#clockErrorMs = roundTripMs; // of the last pings the fastest counts, as in NTP
      this.send({ op: "ping", clock_offset_ms: sec * 1000 + nanosec / 1e6 - (Date.now() - roundTripMs / 2) });
    } catch {
      this.counts.roundTripMs = null; // the end of the connection says more
    }
  }

  #tellOfSilence(seconds) {
    this.dispatchEvent(new CustomEvent("silence", { detail: seconds }));
  }

  /** Replace a silent connection by a new one: its orderly end would also wait for the other side. */
  #giveUp(seconds) {
    const socket = this.#socket;
    this.#close({ code: 0, reason: this.#say("state.silent", { seconds }) });
    socket.close();
  }

  #receive(data) {
    this.#pulse.heard();
    const isText = typeof data === "string";
    const size = isText ? data.length : data.byteLength;
    this.counts.frames += 1;
    this.counts.bytes += size;
    let frame;
    try {
      frame = isText ? parse(data) : decode(data);
    } catch (error) {
      this.#tell({ level: "error", msg: this.#say("frame.invalid", { format: isText ? "JSON" : "CBOR", message: error.message }) });
      return;
    }
    if (typeof frame?.op !== "string" || (frame.op === "publish" && !(frame.msg instanceof Object))) {
      this.#tell({ level: "error", msg: this.#say("frame.unknown", { frame: json(frame)?.slice(0, 80) ?? "" }) });
      return;
    }
    if (this.#listeners.has(frame.id)) {
      this.#listeners.get(frame.id)(frame);
    } else if (frame.op === "publish") {
      const heard = this.#heard(frame.topic);
      if (!heard.length) return; // it was on its way when its subscription ended
      const dropped = this.#dropped(frame);
      this.counts.dropped += dropped;
      for (const each of heard) tell(each.onMessage, frame.msg, size, data, dropped);
      this.#arrived(frame.topic).add(frame.size ?? size, dropped, frame.seq);
    } else if (frame.op === "graph") {
      this.graph.update(frame);
      this.dispatchEvent(new CustomEvent("graph", { detail: frame }));
    } else if (frame.op === "lookup_transform") {
      this.#lookups.get(frame.id)?.onTransform(frame.transform.transform);
    } else if (frame.op === "status") {
      this.#status(frame);
    } else if (!this.#settle(frame.id, frame)) {
      this.dispatchEvent(new CustomEvent(frame.op, { detail: frame }));
    }
  }

  /** Return how many messages of a topic were dropped since the last one. */
  #dropped(frame) {
    const { topic } = frame;
    if (!this.#drops.has(topic)) this.#drops.set(topic, new Drops());
    const isPicture = this.#heard(topic).some(({ options }) => options.image);
    return this.#drops.get(topic).since(frame, isPicture || this.throttleOf(topic) !== 0 || this.#settling.has(topic));
  }

  /** Count no drops of a topic until the gateway has read that it is not throttled, or not any more. */
  async #settleDrops(topic) {
    this.#settling.add(topic);
    await this.ask({ op: "ping" }).catch(() => {}); // a new connection begins without a throttle
    this.#settling.delete(topic);
  }

  /** Return the subscriptions that get a topic's messages. */
  #heard(topic) {
    return [...this.#subscriptions.values()].filter((each) => each.topic === topic && !each.isRefused);
  }

  #arrived(topic) {
    if (!this.arrivals.has(topic)) this.arrivals.set(topic, new Arrivals());
    return this.arrivals.get(topic);
  }

  #status(frame) {
    const subscription = this.#subscriptions.get(frame.id);
    if (subscription && frame.level === "error" && frame.request === "subscribe") {
      subscription.isRefused = true;
      this.#merge(subscription.topic); // its request was refused
    }
    if (subscription && frame.level !== "error" && OF_TOPIC.includes(frame.code)) {
      // the gateway tells a connection once, by the newest id
      for (const each of this.#subscriptions.values()) if (each.topic === subscription.topic) tell(each.onStatus, frame);
    } else if (subscription) subscription.onStatus(frame);
    else if (isLookup(frame)) return; // the frame may come yet. Until then nothing is shown
    else if (frame.request === "unsubscribe" && frame.code === "not_found") return; // it was refused
    else if (!this.#settle(frame.id, null, frame.msg, frame.code)) {
      this.#tell(frame);
    }
  }

  #settle(id, frame, problem, code, isLost = false) {
    const asked = this.#pending.get(id);
    if (!asked) return false;
    this.#pending.delete(id);
    if (frame) asked.resolve(frame);
    else asked.reject(Object.assign(new Error(problem), { code, isLost }));
    return true;
  }

  #close(event) {
    this.#socket = null;
    this.#pulse.end();
    this.counts.roundTripMs = null;
    for (const id of [...this.#pending.keys()]) this.#settle(id, null, this.#say("end.connection"), "", true);
    if (event.code === WRONG_TOKEN) this.#refuse(this.#say("token.unknown"));
    if (this.#isRefused) return;
    this.#announce("closed", event.reason);
    this.#retry = setTimeout(() => this.connect(), this.#retryMs);
    this.#retryMs = Math.min(2 * this.#retryMs, LAST_RETRY_MS);
  }

  #refuse(reason = "") {
    if (this.#isRefused) return;
    this.#isRefused = true; // trying again without a token does not help
    this.#keep(null);
    this.#socket?.close();
    this.#announce("token", reason);
  }

  #announce(state, reason = "") {
    this.dispatchEvent(new CustomEvent("state", { detail: { state, reason } }));
  }

  #tell(status) {
    this.dispatchEvent(new CustomEvent("status", { detail: status }));
  }
}

/** Return whether a status is about a repeated lookup: that its frame is not known yet, or that it does not exist. */
const isLookup = ({ request }) => request === "lookup_transform" || request === "cancel_transform";

/** Tell one of several listeners. If it throws, the others still hear of it, and the page gets the error as one that nobody caught. */
function tell(listener, ...said) {
  try {
    listener(...said);
  } catch (error) {
    reportError(error);
  }
}
