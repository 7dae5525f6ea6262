// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway.Json
{
    /// <summary>The kind of a JSON value.</summary>
    public enum JsonKind
    {
        /// <summary>Members by name.</summary>
        Object,

        /// <summary>Elements in order.</summary>
        Array,

        /// <summary>Text.</summary>
        String,

        /// <summary>A number, whole or not.</summary>
        Number,

        /// <summary>True or false.</summary>
        Boolean,

        /// <summary>The literal null. In ROS messages the NaN of a float.</summary>
        Null,

        /// <summary>No value: the text has ended, or there is no such member.</summary>
        End,
    }
}
