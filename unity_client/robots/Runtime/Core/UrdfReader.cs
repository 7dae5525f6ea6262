// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Xml;
using Ros2Gateway.Shapes;

namespace Ros2Gateway.Robots
{
    /// <summary>A description that is not a URDF. The text says what is wrong, and where.</summary>
    public sealed class UrdfException : Exception
    {
        internal UrdfException(string errorText)
            : base(errorText)
        {
        }
    }

    /// <summary>
    /// Reads what robots publish as /robot_description (http://wiki.ros.org/urdf/XML): what is to be seen of it.
    /// </summary>
    public sealed class UrdfReader
    {
        private const int MaxCharacters = 4 << 20; // a humanoid with all of its plugins has 300,000
        private const int MaxLinks = 1000; // an object of the scene each. A humanoid has 100
        private const int MaxVisuals = 5000;

        private readonly Dictionary<string, Rgba> _materials = new();
        private readonly Dictionary<string, RobotLink> _links = new();
        private readonly List<RobotLink> _order = new();
        private readonly Dictionary<string, RobotJoint> _byChild = new();
        private readonly List<RobotJoint> _joints = new();
        private readonly HashSet<string> _jointNames = new();
        private int _visuals;

        private UrdfReader()
        {
        }

        /// <summary>Reads a description.</summary>
        /// <exception cref="UrdfException">It is invalid, in words.</exception>
        public static RobotDescription Read(string urdf) => new UrdfReader().ReadRobot(Root(urdf));

        private static XmlElement Root(string urdf)
        {
            if (string.IsNullOrEmpty(urdf))
            {
                throw new UrdfException("the robot description is empty");
            }
            if (urdf.Length > MaxCharacters)
            {
                throw new UrdfException(
                    "the robot description has " + urdf.Length + " characters, at most " + MaxCharacters);
            }
            XmlElement root;
            try
            {
                using (XmlReader reader = XmlReader.Create(new StringReader(urdf), XmlTree.Settings))
                {
                    root = XmlTree.Root(reader);
                }
            }
            catch (XmlException error)
            {
                throw new UrdfException("the robot description is not XML: " + error.Message);
            }
            if (root.Name != "robot")
            {
                throw new UrdfException("the robot description begins with <" + root.Name
                    + ">, must begin with <robot>");
            }
            return root;
        }

        private RobotDescription ReadRobot(XmlElement robot)
        {
            foreach (XmlElement material in XmlTree.Children(robot, "material"))
            {
                Color(material);
            }
            foreach (XmlElement link in XmlTree.Children(robot, "link"))
            {
                ReadLink(link);
            }
            foreach (XmlElement joint in XmlTree.Children(robot, "joint"))
            {
                ReadJoint(joint);
            }
            string root = FindRoot();
            return new RobotDescription(robot.GetAttribute("name"), root, _order, Sorted(root));
        }

        private void ReadLink(XmlElement element)
        {
            string name = Need(element, "name", "a link");
            if (_links.ContainsKey(name))
            {
                throw new UrdfException("there are two links " + name);
            }
            if (_links.Count >= MaxLinks)
            {
                throw new UrdfException("more than " + MaxLinks + " links");
            }
            List<RobotVisual> visuals = new();
            foreach (XmlElement visual in XmlTree.Children(element, "visual"))
            {
                if (++_visuals > MaxVisuals)
                {
                    throw new UrdfException("more than " + MaxVisuals + " visuals");
                }
                visuals.Add(ReadVisual(visual, name));
            }
            RobotLink link = new(name, visuals);
            _links[name] = link;
            _order.Add(link);
        }

        private RobotVisual ReadVisual(XmlElement element, string link)
        {
            string where = "link " + link;
            XmlElement geometry = XmlTree.Child(element, "geometry");
            if (geometry == null)
            {
                throw new UrdfException(where + ": a visual has no geometry");
            }
            Pose<Flu> origin = Origin(element, where);
            XmlElement material = XmlTree.Child(element, "material");
            Rgba color = material == null ? new Rgba(200, 200, 200) : Color(material);
            XmlElement shape;
            if ((shape = XmlTree.Child(geometry, "box")) != null)
            {
                return new RobotVisual(RobotShape.Box, Vector(shape, "size", where, null), "", origin, color);
            }
            if ((shape = XmlTree.Child(geometry, "cylinder")) != null)
            {
                double width = 2 * Number(shape, "radius", where);
                Vector3<Flu> size = new(width, width, Number(shape, "length", where));
                return new RobotVisual(RobotShape.Cylinder, size, "", origin, color);
            }
            if ((shape = XmlTree.Child(geometry, "sphere")) != null)
            {
                double width = 2 * Number(shape, "radius", where);
                Vector3<Flu> size = new(width, width, width);
                return new RobotVisual(RobotShape.Sphere, size, "", origin, color);
            }
            if ((shape = XmlTree.Child(geometry, "mesh")) != null)
            {
                Vector3<Flu> scale = Vector(shape, "scale", where, new Vector3<Flu>(1, 1, 1));
                string file = Need(shape, "filename", where + ": a mesh");
                return new RobotVisual(RobotShape.Mesh, scale, file, origin, color);
            }
            throw new UrdfException(where + ": a geometry is neither box, cylinder, sphere nor mesh");
        }

        private void ReadJoint(XmlElement element)
        {
            string name = Need(element, "name", "a joint");
            string where = "joint " + name;
            if (!_jointNames.Add(name))
            {
                throw new UrdfException("there are two joints " + name);
            }
            string parent = LinkOf(element, "parent", where), child = LinkOf(element, "child", where);
            if (_byChild.ContainsKey(child))
            {
                throw new UrdfException(
                    "link " + child + " hangs from two joints: " + _byChild[child].Name + " and " + name);
            }
            XmlElement mimic = XmlTree.Child(element, "mimic");
            _byChild[child] = new RobotJoint(
                name, parent, child, MotionOf(Need(element, "type", where), where), Origin(element, where),
                Axis(element, where), mimic == null ? "" : Need(mimic, "joint", where + ": mimic"),
                mimic == null ? 1 : Number(mimic, "multiplier", where, 1),
                mimic == null ? 0 : Number(mimic, "offset", where, 0));
            _joints.Add(_byChild[child]);
        }

        private string FindRoot()
        {
            string root = null;
            foreach (RobotLink link in _order)
            {
                if (_byChild.ContainsKey(link.Name))
                {
                    continue;
                }
                if (root != null)
                {
                    throw new UrdfException(
                        "links " + root + " and " + link.Name + " hang from no joint: a robot has one root");
                }
                root = link.Name;
            }
            if (root == null)
            {
                throw new UrdfException(_order.Count == 0
                    ? "the robot has no links" : "every link hangs from another: joints in a circle");
            }
            return root;
        }

        /// <summary>Joints from the root on. Joints that are not reached hang in a circle.</summary>
        private List<RobotJoint> Sorted(string root)
        {
            Dictionary<string, List<RobotJoint>> byParent = new();
            foreach (RobotJoint joint in _joints)
            {
                if (!byParent.TryGetValue(joint.Parent, out List<RobotJoint> siblings))
                {
                    siblings = byParent[joint.Parent] = new List<RobotJoint>();
                }
                siblings.Add(joint);
            }
            List<RobotJoint> sorted = new();
            Queue<string> links = new();
            links.Enqueue(root);
            while (links.Count > 0)
            {
                if (byParent.TryGetValue(links.Dequeue(), out List<RobotJoint> below))
                {
                    foreach (RobotJoint joint in below)
                    {
                        sorted.Add(joint);
                        links.Enqueue(joint.Child);
                    }
                }
            }
            if (sorted.Count < _joints.Count)
            {
                RobotJoint lost = _joints.Find(joint => !sorted.Contains(joint));
                throw new UrdfException("joint " + lost.Name + " is in a circle, which hangs from nothing");
            }
            return sorted;
        }

        private string LinkOf(XmlElement joint, string which, string where)
        {
            XmlElement element = XmlTree.Child(joint, which);
            string link = element == null ? "" : element.GetAttribute("link");
            if (!_links.ContainsKey(link))
            {
                throw new UrdfException(
                    where + ": its " + which + " " + (link.Length == 0 ? "is missing" : link + " is not a link"));
            }
            return link;
        }

        private static JointMotion MotionOf(string type, string where) =>
            type switch
            {
                "revolute" or "continuous" => JointMotion.Turning,
                "prismatic" => JointMotion.Sliding,
                "fixed" or "floating" or "planar" => JointMotion.None,
                _ => throw new UrdfException(where + ": the type " + type + " is unknown"),
            };

        /// <summary>The colour of a material: its own, which later ones may name, or one that is named.</summary>
        private Rgba Color(XmlElement material)
        {
            string name = material.GetAttribute("name");
            XmlElement color = XmlTree.Child(material, "color");
            Rgba known;
            if (color == null)
            {
                // one with a texture alone, or one that is defined nowhere
                return _materials.TryGetValue(name, out known) ? known : new Rgba(200, 200, 200);
            }
            double[] parts = Numbers(color, "rgba", "material " + name, 4);
            known = Rgba.Of(parts[0], parts[1], parts[2], parts[3]);
            if (name.Length > 0 && !_materials.ContainsKey(name))
            {
                _materials[name] = known;
            }
            return known;
        }

        private static Pose<Flu> Origin(XmlElement element, string where)
        {
            XmlElement origin = XmlTree.Child(element, "origin");
            if (origin == null)
            {
                return new Pose<Flu>(default(Vector3<Flu>), Quaternion<Flu>.Identity);
            }
            Vector3<Flu> zero = default(Vector3<Flu>);
            Vector3<Flu> turns = Vector(origin, "rpy", where, zero);
            return new Pose<Flu>(Vector(origin, "xyz", where, zero), RollPitchYaw(turns.x, turns.y, turns.z));
        }

        private static Vector3<Flu> Axis(XmlElement joint, string where)
        {
            XmlElement element = XmlTree.Child(joint, "axis");
            Vector3<Flu> axis = element == null ? new Vector3<Flu>(1, 0, 0)
                : Vector(element, "xyz", where, new Vector3<Flu>(1, 0, 0));
            double length = axis.Length;
            return length > 0 ? 1 / length * axis : new Vector3<Flu>(1, 0, 0);
        }

        /// <summary>About x first, about z last, about axes that do not turn with it.</summary>
        private static Quaternion<Flu> RollPitchYaw(double roll, double pitch, double yaw) =>
            new Quaternion<Flu>(0, 0, Math.Sin(yaw / 2), Math.Cos(yaw / 2))
                * new Quaternion<Flu>(0, Math.Sin(pitch / 2), 0, Math.Cos(pitch / 2))
                * new Quaternion<Flu>(Math.Sin(roll / 2), 0, 0, Math.Cos(roll / 2));

        private static Vector3<Flu> Vector(XmlElement element, string name, string where, Vector3<Flu>? otherwise)
        {
            if (otherwise.HasValue && !element.HasAttribute(name))
            {
                return otherwise.Value;
            }
            double[] parts = Numbers(element, name, where, 3);
            return new Vector3<Flu>(parts[0], parts[1], parts[2]);
        }

        private static double Number(XmlElement element, string name, string where, double? otherwise = null) =>
            otherwise.HasValue && !element.HasAttribute(name)
                ? otherwise.Value : Numbers(element, name, where, 1)[0];

        private static double[] Numbers(XmlElement element, string name, string where, int count)
        {
            string text = element.GetAttribute(name);
            string[] words = text.Split((char[])null, StringSplitOptions.RemoveEmptyEntries);
            double[] numbers = new double[count];
            bool isGood = words.Length == count;
            for (int i = 0; i < count && isGood; i++)
            {
                isGood = double.TryParse(words[i], NumberStyles.Float, CultureInfo.InvariantCulture, out numbers[i])
                    && Math.Abs(numbers[i]) <= float.MaxValue; // false for NaN as well
            }
            if (!isGood)
            {
                string shown = text.Length <= 40 ? text : text.Substring(0, 40) + "...";
                throw new UrdfException(where + ": " + element.Name + " " + name + " is '" + shown + "', must be "
                    + (count == 1 ? "a number" : count + " numbers"));
            }
            return numbers;
        }

        private static string Need(XmlElement element, string name, string what)
        {
            string value = element.GetAttribute(name);
            if (value.Length == 0)
            {
                throw new UrdfException(what + " has no " + name);
            }
            return value;
        }
    }
}
