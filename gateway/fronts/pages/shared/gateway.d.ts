// SPDX-License-Identifier: Apache-2.0
// by tools/page-types.sh
/**
 * Return the address of the WebSocket of the gateway that served this page, or else this module.
 * @returns {string}
 */
export function address(): string;
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
    /** @param {Options} [options] */
    constructor({ address: wanted, token, say }?: Options);
    /**
     * Frames and bytes so far, messages that were dropped for this page, and the last round trip in milliseconds.
     * @type {{frames: number, bytes: number, dropped: number, roundTripMs: number|null}}
     */
    counts: {
        frames: number;
        bytes: number;
        dropped: number;
        roundTripMs: number | null;
    };
    /** The answer to `hello`, such as the role, or null before the first connection. @type {any} */
    hello: any;
    /** The ROS graph. The event `graph` follows each change. */
    graph: Graph;
    /** The arrivals of each topic, in bytes as they are in ROS. @type {Map<string, Arrivals>} */
    arrivals: Map<string, Arrivals>;
    /**
     * Hear an event until the function that this returns is called.
     * @template {keyof Events} Name
     * @param {Name} name
     * @param {(detail: Events[Name]) => void} take
     * @returns {() => void}
     */
    on<Name extends keyof Events>(name: Name, take: (detail: Events[Name]) => void): () => void;
    /** Connect, and again whenever the connection is lost, until `close`. */
    connect(): void;
    /** End the connection. The gateway stops what this page drives. `connect` begins again. */
    close(): void;
    /** Whether operations can be sent. */
    get isOpen(): boolean;
    /**
     * Connect with a token from now on.
     * @param {string} token
     */
    useToken(token: string): void;
    /**
     * Send an operation of docs/reference/protocol. Return whether there is a connection to send it by.
     * @param {{op: string, [field: string]: any}} operation
     * @param {Object<string, string>} [json] further members, as JSON: their integers may be larger than a number here
     */
    send(operation: {
        op: string;
        [field: string]: any;
    }, json?: {
        [x: string]: string;
    }): boolean;
    /**
     * Send an operation and return its answer. Rejects with the gateway's words, and its `code`, as an error.
     * @param {{op: string, [field: string]: any}} operation
     * @param {Object<string, string>} [json] as for `send`
     * @returns {Promise<any>}
     */
    ask(operation: {
        op: string;
        [field: string]: any;
    }, json?: {
        [x: string]: string;
    }): Promise<any>;
    /**
     * Stop the robot, even if another client drives. First let go of everything: the gateway sees this page's STOP as this client's own stop,
     * and what is still held would drive on.
     * @returns {Promise<{topics: string[]}>} what it stopped
     */
    stop(): Promise<{
        topics: string[];
    }>;
    /**
     * Hear all frames that name an id, for operations that have no answer, or several.
     * @param {(frame: any) => void} onFrame
     * @returns {{id: string, end: () => void}}
     */
    listen(onFrame: (frame: any) => void): {
        id: string;
        end: () => void;
    };
    /**
     * Subscribe until the function that this returns is called.
     * @param {string} topic
     * @param {object} options further members of the operation `subscribe`, such as `throttle_rate` or `fields`
     * @param {OnMessage} onMessage
     * @param {(status: Status) => void} [onStatus] By default these are events
     * @returns {() => void}
     */
    subscribe(topic: string, options: object, onMessage: OnMessage, onStatus?: (status: Status) => void): () => void;
    /**
     * Return the least number of milliseconds between two messages of a topic, as this page has asked for it. 0 for all messages.
     * @param {string} topic
     * @returns {number|undefined}
     */
    throttleOf(topic: string): number | undefined;
    /**
     * Report where a frame is, when that is known and when it has changed, until the function that this returns is called.
     * @param {string} target
     * @param {string} source the frame whose pose in *target* is reported
     * @param {number} rate at most so many a second
     * @param {(transform: any) => void} onTransform gets `translation` and `rotation`
     * @returns {() => void}
     */
    followTransform(target: string, source: string, rate: number, onTransform: (transform: any) => void): () => void;
    #private;
}
/**
 * How to connect.
 */
export type Options = {
    /**
     * of the WebSocket, such as `ws://robot:9090?status=warning`. By default that of the gateway that served this module
     */
    address?: string;
    /**
     * By default the one behind `#token=` in the address of the page, which is kept until its tab is closed
     */
    token?: string;
    /**
     * returns the words for a key of words/en.js. By default in English
     */
    say?: (key: string, values?: Record<string, string | number>) => string;
};
/**
 * The words of the gateway about a request or a topic. docs/reference/errors.md has the codes.
 */
export type Status = {
    level: "error" | "warning" | "info" | "none";
    /**
     * the event, and what to do
     */
    msg: string;
    /**
     * such as `forbidden`
     */
    code?: string;
    /**
     * the operation that it answers
     */
    request?: string;
    /**
     * of that operation
     */
    id?: string;
};
/**
 * The events, each with what its listener gets.
 */
export type Events = {
    /**
     * of the connection. `token`: the gateway needs one, or another one
     */
    state: {
        state: "connecting" | "open" | "closed" | "token";
        reason: string;
    };
    /**
     * the seconds for which nothing came although an answer is due. 0 when it is over
     */
    silence: number;
    /**
     * about nothing that hears it elsewhere
     */
    status: Status;
    /**
     * a frame with what has changed in `graph`
     */
    graph: any;
    /**
     * a frame with the state of a command topic, after the operation `control` with `watch`
     */
    control: any;
    /**
     * `stop` was called: let go of all that is held
     */
    stopping: null;
};
/**
 * One subscription of a page. Several may be to the same topic.
 */
export type Subscription = {
    id: string;
    topic: string;
    options: object;
    onMessage: OnMessage;
    onStatus: (status: Status) => void;
    /**
     * whether the gateway does not have it
     */
    isRefused: boolean;
};
/**
 * Gets each message of a topic, its size on the network, the frame as it arrived, and how many messages were dropped before it.
 */
export type OnMessage = (message: any, size: number, data: string | ArrayBuffer, dropped: number) => void;
import { Graph } from "./graph.js";
import { Arrivals } from "./arrivals.js";
