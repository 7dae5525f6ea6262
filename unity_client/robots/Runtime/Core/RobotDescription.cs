// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using Ros2Gateway.Shapes;

namespace Ros2Gateway.Robots
{
    /// <summary>A robot as a tree: links, and the joints between them. Unchangeable.</summary>
    public sealed class RobotDescription
    {
        private readonly Dictionary<string, RobotJoint> _joints = new();

        internal RobotDescription(string name, string root, List<RobotLink> links, List<RobotJoint> joints)
        {
            Name = name;
            Root = root;
            Links = links;
            Joints = joints;
            foreach (RobotJoint joint in joints)
            {
                _joints[joint.Name] = joint;
            }
        }

        /// <summary>The robot's name.</summary>
        public string Name { get; private set; }

        /// <summary>The link from which all others hang.</summary>
        public string Root { get; private set; }

        /// <summary>The links, as they stand in the description.</summary>
        public IReadOnlyList<RobotLink> Links { get; private set; }

        /// <summary>The joints, each after the one that its parent hangs from.</summary>
        public IReadOnlyList<RobotJoint> Joints { get; private set; }

        /// <summary>The joint of a name, or null.</summary>
        public RobotJoint Joint(string name) => name != null && _joints.TryGetValue(name, out RobotJoint joint) ? joint : null;
    }

    /// <summary>A rigid part of a robot.</summary>
    public sealed class RobotLink
    {
        internal RobotLink(string name, List<RobotVisual> visuals)
        {
            Name = name;
            Visuals = visuals;
        }

        /// <summary>Its name, which is that of its frame as well.</summary>
        public string Name { get; private set; }

        /// <summary>Its look.</summary>
        public IReadOnlyList<RobotVisual> Visuals { get; private set; }
    }

    /// <summary>The shape of a part of a link.</summary>
    public enum RobotShape
    {
        /// <summary>A box. Its size is along its own axes.</summary>
        Box,

        /// <summary>A cylinder along z. Its size is twice the diameter and the length.</summary>
        Cylinder,

        /// <summary>A sphere. Its size is three times the diameter.</summary>
        Sphere,

        /// <summary>A mesh in a file. Its size is the scale.</summary>
        Mesh,
    }

    /// <summary>A shape of a link, where it is in the link's frame.</summary>
    public sealed class RobotVisual
    {
        internal RobotVisual(RobotShape shape, Vector3<Flu> size, string mesh, Pose<Flu> origin, Rgba color)
        {
            Shape = shape;
            Size = size;
            Mesh = mesh;
            Origin = origin;
            Color = color;
        }

        /// <summary>Its shape.</summary>
        public RobotShape Shape { get; private set; }

        /// <summary>In metres. Of a mesh, the factors by which it is larger than its file.</summary>
        public Vector3<Flu> Size { get; private set; }

        /// <summary>The address of the mesh, mostly package://.... Empty for other shapes.</summary>
        public string Mesh { get; private set; }

        /// <summary>The place of its middle.</summary>
        public Pose<Flu> Origin { get; private set; }

        /// <summary>Its colour.</summary>
        public Rgba Color { get; private set; }
    }
}
