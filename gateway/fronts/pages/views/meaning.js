// SPDX-License-Identifier: Apache-2.0
import { locale, say } from "../shared/language.js";
import { anglesOf } from "./angles.js";

const LEAST_S = 1e9; // since 1970: fewer are a duration, or the time of a simulation
const DEGREES = 180 / Math.PI;

/** Return what some fields mean together, in words: the angles of an orientation, or the time of a stamp. Or "". */
export function meaningOf(fields) {
  const names = Object.keys(fields).join(" ");
  if (!Object.values(fields).every(Number.isFinite)) return "";
  if (names === "sec nanosec" && fields.sec >= LEAST_S) return new Date(fields.sec * 1000 + fields.nanosec / 1e6).toLocaleString(locale);
  const angles = names === "x y z w" && anglesOf(fields);
  return angles ? Object.entries(angles).map(([name, radians]) => `${say(`angle.${name}`)} ${(radians * DEGREES).toFixed(1).replace(/^-0\.0$/, "0.0")}°`).join(", ") : "";
}
