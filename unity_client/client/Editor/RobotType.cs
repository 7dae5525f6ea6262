// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;

namespace Ros2Gateway.Editor
{
    /// <summary>A message, service or action type that the robot has.</summary>
    public sealed class RobotType
    {
        internal RobotType(string name, IEnumerable<string> uses)
        {
            Name = name;
            Uses = string.Join(", ", uses);
            HasClass = IsKnown(name);
        }

        /// <summary><c>pkg/msg/Name</c>, <c>pkg/srv/Name</c> or <c>pkg/action/Name</c>.</summary>
        public string Name { get; private set; }

        /// <summary>The topics, services and actions that have it now. Empty if none has.</summary>
        public string Uses { get; private set; }

        /// <summary>Whether its class is there, in the package or in the project.</summary>
        public bool HasClass { get; private set; }

        private static bool IsKnown(string name)
        {
            string part = name.Contains("/srv/") ? "_Request" : name.Contains("/action/") ? "_Goal" : "";
            return MessageClasses.Create(name + part) != null;
        }
    }
}
