// SPDX-License-Identifier: Apache-2.0

/** The beginning of every path of this gateway, such as `/r1`. A relay serves several robots. */
export const BASE = new URL("..", import.meta.url).pathname.slice(0, -1);
