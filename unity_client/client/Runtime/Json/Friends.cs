// SPDX-License-Identifier: Apache-2.0
using System.Runtime.CompilerServices;

[assembly: InternalsVisibleTo("Ros2Gateway.Core")]
[assembly: InternalsVisibleTo("Ros2Gateway.Messages")]
[assembly: InternalsVisibleTo("Ros2Gateway.Core.Tests")]
[assembly: InternalsVisibleTo("Ros2Gateway.Displays.Core")]
