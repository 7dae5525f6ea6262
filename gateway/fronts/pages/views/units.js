// SPDX-License-Identifier: Apache-2.0
// The units of fields: ROS says them in the comments of its types, and REP 103 what they are.

/** @type {[RegExp, string][]} of a type, a space and a path */
const UNITS = [
  [/^sensor_msgs\/msg\/JointState position/, "rad"],
  [/^sensor_msgs\/msg\/JointState velocity/, "rad/s"],
  [/^sensor_msgs\/msg\/JointState effort/, "N·m"],
  [/^geometry_msgs\/msg\/Accel.* (.*\.)?linear\./, "m/s²"],
  [/^geometry_msgs\/msg\/Accel.* (.*\.)?angular\./, "rad/s²"],
  [/^sensor_msgs\/msg\/MagneticField /, "T"],
  [/^sensor_msgs\/msg\/FluidPressure fluid_pressure/, "Pa"],
  [/^sensor_msgs\/msg\/Illuminance illuminance/, "lx"],
  [/linear_acceleration\./, "m/s²"],
  [/angular_velocity\./, "rad/s"],
  [/(^| |\.)linear\.[xyz]$/, "m/s"],
  [/(^| |\.)angular\.[xyz]$/, "rad/s"],
  [/(position|translation)\.[xyz]$/, "m"],
  [/force\.[xyz]$/, "N"],
  [/torque\.[xyz]$/, "N·m"],
  [/ (ranges|range|min_range|max_range|range_min|range_max|altitude)(\.|$)/, "m"],
  [/ (angle_min|angle_max|angle_increment|field_of_view)$/, "rad"],
  [/ (latitude|longitude)$/, "°"],
  [/ (cell_)?voltage(\.|$)/, "V"],
  [/ current$/, "A"],
  [/ (charge|capacity|design_capacity)$/, "Ah"],
  [/ temperature$/, "°C"],
];

/**
 * Return the unit of a field, or "" if it has none or if it is not known.
 * @param {string} type of the message
 * @param {string} path of the field in it
 */
export const unitOf = (type, path) => UNITS.find(([pattern]) => pattern.test(`${type} ${path}`))?.[1] ?? "";
