// SPDX-License-Identifier: Apache-2.0
using System.Runtime.CompilerServices;

[assembly: InternalsVisibleTo("Ros2Gateway.Unity")]
[assembly: InternalsVisibleTo("Ros2Gateway.Thesis")]
[assembly: InternalsVisibleTo("Ros2Gateway.Core.Tests")]
[assembly: InternalsVisibleTo("Ros2Gateway.Displays.Core")]
[assembly: InternalsVisibleTo("Ros2Gateway.Displays")]
[assembly: InternalsVisibleTo("Ros2Gateway.Robots.Core")]
