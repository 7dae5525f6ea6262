// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Drive
{
    /// <summary>The three gains of a <see cref="Pid"/>. Shows in Unity's Inspector.</summary>
    [Serializable]
    public struct PidGains
    {
        /// <summary>Output per error.</summary>
        public double proportional;

        /// <summary>Output per error and second.</summary>
        public double integral;

        /// <summary>Output per error a second.</summary>
        public double derivative;

        /// <summary>Takes gains as they are.</summary>
        public PidGains(double proportional, double integral, double derivative)
        {
            this.proportional = proportional;
            this.integral = integral;
            this.derivative = derivative;
        }
    }
}
