// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages.SensorMsgs;

namespace Ros2Gateway.Thesis
{
    /// <content>Laser scans and the battery.</content>
    public static partial class Ros2Library
    {
        /// <summary>Takes the oldest unread laser scan.</summary>
        /// <param name="frame_id_size">How many bytes fit. Becomes how many were written.</param>
        /// <param name="ranges_size">How many values fit. Becomes how many were written, as that of intensities.</param>
        /// <returns>False without a message, or if an array is too small: then it stays, and a debug message says why.</returns>
        public static bool poll_laser_scan<TFrame, TRanges, TIntensities>(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref TFrame frame_id_size,
            ref float angle_min, ref float angle_max, ref float angle_increment,
            ref float time_increment, ref float scan_time, ref float range_min, ref float range_max,
            float[] ranges, ref TRanges ranges_size, float[] intensities, ref TIntensities intensities_size)
            where TFrame : struct
            where TRanges : struct
            where TIntensities : struct
        {
            lock (Gate)
            {
                const string Call = "poll_laser_scan";
                if (!Oldest(Call, topic, out LaserScanMsg scan)
                    || !Fits(Call, topic, "ranges", ranges, ranges_size, scan.ranges.Length)
                    || !Fits(Call, topic, "intensities", intensities, intensities_size, scan.intensities.Length))
                {
                    frame_id_size = default(TFrame);
                    ranges_size = default(TRanges);
                    intensities_size = default(TIntensities);
                    return false;
                }
                Put(Call, topic, scan.header, ref sec, ref nanosec, frame_id, ref frame_id_size);
                angle_min = scan.angle_min;
                angle_max = scan.angle_max;
                angle_increment = scan.angle_increment;
                time_increment = scan.time_increment;
                scan_time = scan.scan_time;
                range_min = scan.range_min;
                range_max = scan.range_max;
                Copy(scan.ranges, ranges, out ranges_size);
                Copy(scan.intensities, intensities, out intensities_size);
                return Taken(topic, scan);
            }
        }

        /// <summary>Takes the oldest unread state of the battery.</summary>
        /// <param name="frame_id_size">How many bytes fit. Becomes how many were written, as the sizes of all texts.</param>
        /// <param name="cell_amount">
        /// How many cells both arrays take. Becomes how many were written. With 0 none are, and the arrays may be
        /// null. If the robot tells fewer temperatures than voltages, or the other way round, the rest is NaN.
        /// </param>
        /// <returns>False without a message, or if an array is too small: then it stays, and a debug message says why.</returns>
        public static bool poll_battery_state<TFrame, TCells, TLocation, TSerial>(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref TFrame frame_id_size,
            ref float voltage, ref float temperature, ref float current, ref float charge, ref float capacity,
            ref float design_capacity, ref float percentage,
            ref byte power_supply_status, ref byte power_supply_health, ref byte power_supply_technology,
            ref bool present, float[] cell_voltage, float[] cell_temperature, ref TCells cell_amount,
            TextBuffer location, ref TLocation location_size, TextBuffer serial_number, ref TSerial serial_number_size)
            where TFrame : struct
            where TCells : struct
            where TLocation : struct
            where TSerial : struct
        {
            lock (Gate)
            {
                const string Call = "poll_battery_state";
                BatteryStateMsg state;
                int cells = 0;
                if (!Oldest(Call, topic, out state)
                    || ((cells = Cells(state, cell_amount)) > 0
                        && !(Fits(Call, topic, "cell_voltage", cell_voltage, cell_amount, cells)
                            && Fits(Call, topic, "cell_temperature", cell_temperature, cell_amount, cells))))
                {
                    frame_id_size = default(TFrame);
                    cell_amount = default(TCells);
                    location_size = default(TLocation);
                    serial_number_size = default(TSerial);
                    return false;
                }
                Put(Call, topic, state.header, ref sec, ref nanosec, frame_id, ref frame_id_size);
                voltage = state.voltage;
                temperature = state.temperature;
                current = state.current;
                charge = state.charge;
                capacity = state.capacity;
                design_capacity = state.design_capacity;
                percentage = state.percentage;
                power_supply_status = state.power_supply_status;
                power_supply_health = state.power_supply_health;
                power_supply_technology = state.power_supply_technology;
                present = state.present;
                cell_amount = Size<TCells>(cells);
                PutCells(state.cell_voltage, cell_voltage, cells);
                PutCells(state.cell_temperature, cell_temperature, cells);
                Put(Call, topic, "location", state.location, location, ref location_size);
                Put(Call, topic, "serial_number", state.serial_number, serial_number, ref serial_number_size);
                return Taken(topic, state);
            }
        }

        private static int Cells<T>(BatteryStateMsg state, T cell_amount)
            where T : struct =>
            Count(cell_amount) == 0 ? 0 : Math.Max(state.cell_voltage.Length, state.cell_temperature.Length);

        private static void PutCells(float[] from, float[] to, int count)
        {
            for (int i = 0; i < count; i++)
            {
                to[i] = i < from.Length ? from[i] : float.NaN;
            }
        }
    }
}
