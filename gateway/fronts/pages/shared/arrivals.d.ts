// SPDX-License-Identifier: Apache-2.0
// by tools/page-types.sh
/** The messages that arrived of one topic, or for one card. `tick` is called once per second. */
export class Arrivals {
    messages: number;
    dropped: number;
    /**
     * Count a message.
     * @param {number} bytes how large it is
     * @param {number} dropped how many were dropped before it
     * @param {number} [seq] its number on the topic, of which not all messages need to come here. By default that here
     */
    add(bytes: number, dropped: number, seq?: number): void;
    /** Reckon the rate, from the message that it was reckoned from before to the newest. */
    tick(): void;
    /** How old the newest message is, by the time of its arrival. */
    get ageMs(): number;
    /** Whether messages came regularly, and no longer do. */
    get isLate(): boolean;
    /** Return whether messages came regularly, and none came for so long. */
    isOlder(ms: any): boolean;
    /** Whether there is a rate to show: one message has none, such as a map that stays as it is. */
    get hasRate(): boolean;
    /** The rate in words, or "". */
    get rate(): string;
    /** The size of the newest message in words. */
    get size(): string;
    #private;
}
