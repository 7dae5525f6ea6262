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
        /// <returns>False without a message, or if it does not fit: then it stays, and a debug message says why.</returns>
        public static bool poll_laser_scan(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref uint frame_id_size,
            ref float angle_min, ref float angle_max, ref float angle_increment,
            ref float time_increment, ref float scan_time, ref float range_min, ref float range_max,
            float[] ranges, ref uint ranges_size, float[] intensities, ref uint intensities_size)
        {
            lock (Gate)
            {
                const string Call = "poll_laser_scan";
                LaserScanMsg scan;
                if (!Oldest(Call, topic, out scan)
                    || !Fits(Call, topic, "frame_id", frame_id, frame_id_size, scan.header.frame_id)
                    || !Fits(Call, topic, "ranges", ranges, ranges_size, scan.ranges.Length)
                    || !Fits(Call, topic, "intensities", intensities, intensities_size, scan.intensities.Length))
                {
                    frame_id_size = 0;
                    ranges_size = 0;
                    intensities_size = 0;
                    return false;
                }
                Put(scan.header, ref sec, ref nanosec, frame_id, ref frame_id_size);
                angle_min = scan.angle_min;
                angle_max = scan.angle_max;
                angle_increment = scan.angle_increment;
                time_increment = scan.time_increment;
                scan_time = scan.scan_time;
                range_min = scan.range_min;
                range_max = scan.range_max;
                ranges_size = Copied(scan.ranges, ranges);
                intensities_size = Copied(scan.intensities, intensities);
                return Taken(topic, scan);
            }
        }

        /// <inheritdoc cref="poll_laser_scan(string, ref uint, ref uint, TextBuffer, ref uint, ref float, ref float, ref float, ref float, ref float, ref float, ref float, float[], ref uint, float[], ref uint)"/>
        public static bool poll_laser_scan(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref int frame_id_size,
            ref float angle_min, ref float angle_max, ref float angle_increment,
            ref float time_increment, ref float scan_time, ref float range_min, ref float range_max,
            float[] ranges, ref int ranges_size, float[] intensities, ref int intensities_size)
        {
            uint bytes = Unsigned(frame_id_size);
            uint rangeCount = Unsigned(ranges_size);
            uint intensityCount = Unsigned(intensities_size);
            bool isThere = poll_laser_scan(
                topic, ref sec, ref nanosec, frame_id, ref bytes,
                ref angle_min, ref angle_max, ref angle_increment,
                ref time_increment, ref scan_time, ref range_min, ref range_max,
                ranges, ref rangeCount, intensities, ref intensityCount);
            frame_id_size = (int)bytes;
            ranges_size = (int)rangeCount;
            intensities_size = (int)intensityCount;
            return isThere;
        }

        /// <summary>Takes the oldest unread laser scan.</summary>
        public static bool poll_laser_scan(string topic, out LaserScanMsg scan)
        {
            return Poll("poll_laser_scan", topic, out scan);
        }

        /// <summary>Takes the oldest unread state of the battery.</summary>
        /// <param name="frame_id_size">How many bytes fit. Becomes how many were written, as the sizes of all texts.</param>
        /// <param name="cell_amount">
        /// How many cells both arrays take. Becomes how many were written. With 0 none are, and the arrays may be
        /// null. If the robot tells fewer temperatures than voltages, or the other way round, the rest is NaN.
        /// </param>
        /// <returns>False without a message, or if it does not fit: then it stays, and a debug message says why.</returns>
        public static bool poll_battery_state(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref uint frame_id_size,
            ref float voltage, ref float temperature, ref float current, ref float charge, ref float capacity,
            ref float design_capacity, ref float percentage,
            ref byte power_supply_status, ref byte power_supply_health, ref byte power_supply_technology,
            ref bool present, float[] cell_voltage, float[] cell_temperature, ref uint cell_amount,
            TextBuffer location, ref uint location_size, TextBuffer serial_number, ref uint serial_number_size)
        {
            lock (Gate)
            {
                const string Call = "poll_battery_state";
                BatteryStateMsg state;
                if (!Oldest(Call, topic, out state)
                    || !Fits(Call, topic, "frame_id", frame_id, frame_id_size, state.header.frame_id)
                    || !Fits(Call, topic, "cell_voltage", cell_voltage, cell_amount, Cells(state, cell_amount))
                    || !Fits(Call, topic, "cell_temperature", cell_temperature, cell_amount, Cells(state, cell_amount))
                    || !Fits(Call, topic, "location", location, location_size, state.location)
                    || !Fits(Call, topic, "serial_number", serial_number, serial_number_size, state.serial_number))
                {
                    frame_id_size = 0;
                    cell_amount = 0;
                    location_size = 0;
                    serial_number_size = 0;
                    return false;
                }
                Put(state.header, ref sec, ref nanosec, frame_id, ref frame_id_size);
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
                cell_amount = Cells(state, cell_amount);
                PutCells(state.cell_voltage, cell_voltage, cell_amount);
                PutCells(state.cell_temperature, cell_temperature, cell_amount);
                location_size = location.Write(state.location);
                serial_number_size = serial_number.Write(state.serial_number);
                return Taken(topic, state);
            }
        }

        /// <inheritdoc cref="poll_battery_state(string, ref uint, ref uint, TextBuffer, ref uint, ref float, ref float, ref float, ref float, ref float, ref float, ref float, ref byte, ref byte, ref byte, ref bool, float[], float[], ref uint, TextBuffer, ref uint, TextBuffer, ref uint)"/>
        public static bool poll_battery_state(
            string topic, ref uint sec, ref uint nanosec, TextBuffer frame_id, ref int frame_id_size,
            ref float voltage, ref float temperature, ref float current, ref float charge, ref float capacity,
            ref float design_capacity, ref float percentage,
            ref byte power_supply_status, ref byte power_supply_health, ref byte power_supply_technology,
            ref bool present, float[] cell_voltage, float[] cell_temperature, ref int cell_amount,
            TextBuffer location, ref int location_size, TextBuffer serial_number, ref int serial_number_size)
        {
            uint bytes = Unsigned(frame_id_size);
            uint cells = Unsigned(cell_amount);
            uint locationBytes = Unsigned(location_size);
            uint serialBytes = Unsigned(serial_number_size);
            bool isThere = poll_battery_state(
                topic, ref sec, ref nanosec, frame_id, ref bytes,
                ref voltage, ref temperature, ref current, ref charge, ref capacity, ref design_capacity,
                ref percentage, ref power_supply_status, ref power_supply_health, ref power_supply_technology,
                ref present, cell_voltage, cell_temperature, ref cells,
                location, ref locationBytes, serial_number, ref serialBytes);
            frame_id_size = (int)bytes;
            cell_amount = (int)cells;
            location_size = (int)locationBytes;
            serial_number_size = (int)serialBytes;
            return isThere;
        }

        /// <summary>Takes the oldest unread state of the battery.</summary>
        public static bool poll_battery_state(string topic, out BatteryStateMsg state)
        {
            return Poll("poll_battery_state", topic, out state);
        }

        private static uint Cells(BatteryStateMsg state, uint cell_amount)
        {
            return cell_amount == 0 ? 0 : (uint)Math.Max(state.cell_voltage.Length, state.cell_temperature.Length);
        }

        private static void PutCells(float[] from, float[] to, uint count)
        {
            for (int i = 0; i < count; i++)
            {
                to[i] = i < from.Length ? from[i] : float.NaN;
            }
        }
    }
}
