// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Xml;

namespace Ros2Gateway.Robots
{
    /// <summary>Triangles of one material.</summary>
    internal sealed class ColladaFaces
    {
        internal readonly List<int> Corners = new(); // three of Positions for each, counterclockwise
        internal float[] Positions; // x, y, z for each
        internal string Material; // a name that an instance of the geometry binds
    }

    /// <summary>The triangles of a geometry, with its polygons, strips and fans. Lines are left out.</summary>
    internal sealed class ColladaGeometry
    {
        /// <summary>One for each list of primitives.</summary>
        internal readonly List<ColladaFaces> Faces = new();

        private readonly Func<XmlElement, XmlElement> _source;
        private readonly Dictionary<XmlElement, float[]> _positions = new();

        /// <param name="source">The target of an element's source.</param>
        /// <exception cref="MeshException">In words.</exception>
        internal ColladaGeometry(XmlElement geometry, Func<XmlElement, XmlElement> source)
        {
            _source = source;
            XmlElement mesh = XmlTree.Child(geometry, "mesh"); // else it is a curve
            if (mesh == null)
            {
                return;
            }
            foreach (XmlElement primitives in XmlTree.Children(mesh))
            {
                switch (primitives.Name)
                {
                    case "triangles":
                    case "polylist":
                    case "polygons":
                    case "tristrips":
                    case "trifans":
                        Read(primitives);
                        break;
                }
            }
        }

        private void Read(XmlElement primitives)
        {
            string kind = primitives.Name;
            int stride = 0;
            int offset = -1;
            ColladaFaces faces = new() { Material = primitives.GetAttribute("material") };
            foreach (XmlElement input in XmlTree.Children(primitives, "input"))
            {
                int at = Integer(input, "offset", 0);
                stride = Math.Max(stride, at + 1);
                if (input.GetAttribute("semantic") == "VERTEX")
                {
                    offset = at;
                    faces.Positions = Positions(_source(input));
                }
            }
            if (offset < 0)
            {
                throw new MeshException("the COLLADA file's <" + kind + "> has no VERTEX");
            }
            XmlElement counts = XmlTree.Child(primitives, "vcount");
            List<int> lengths = counts == null ? null : ColladaNumbers.Indices(counts.InnerText, "<vcount>");
            foreach (XmlElement child in XmlTree.Children(primitives))
            {
                // A polygon with holes is drawn without them.
                XmlElement list = child.Name == "ph" ? XmlTree.Child(child, "p") : child;
                if (list != null && list.Name == "p")
                {
                    List<int> corners = Corners(list, stride, offset, faces.Positions.Length / 3);
                    AddAll(faces.Corners, kind, corners, lengths);
                }
            }
            if (faces.Corners.Count > 0)
            {
                Faces.Add(faces);
            }
        }

        private static void AddAll(List<int> faces, string kind, List<int> corners, List<int> lengths)
        {
            switch (kind)
            {
                case "triangles":
                    for (int i = 0; i + 2 < corners.Count; i += 3)
                    {
                        AddFan(faces, corners, i, 3);
                    }
                    break;
                case "tristrips":
                    for (int i = 0; i + 2 < corners.Count; i++)
                    {
                        Add(faces, corners[i + i % 2], corners[i + 1 - i % 2], corners[i + 2]);
                    }
                    break;
                case "polylist":
                    int at = 0;
                    foreach (int length in lengths ?? new List<int>())
                    {
                        if (length > corners.Count - at)
                        {
                            throw new MeshException(
                                "the COLLADA file's <polylist> has more corners in its <vcount> than in its <p>");
                        }
                        AddFan(faces, corners, at, length);
                        at += length;
                    }
                    break;
                default: // a polygon, or a fan
                    AddFan(faces, corners, 0, corners.Count);
                    break;
            }
        }

        private static void AddFan(List<int> faces, List<int> corners, int first, int count)
        {
            for (int i = first + 2; i < first + count; i++)
            {
                Add(faces, corners[first], corners[i - 1], corners[i]);
            }
        }

        private static void Add(List<int> faces, int a, int b, int c)
        {
            if (faces.Count == 3 * TriangleMesh.MaxTriangles)
            {
                throw ColladaReader.TooManyTriangles();
            }
            faces.Add(a);
            faces.Add(b);
            faces.Add(c);
        }

        /// <summary>The positions' numbers in a list that has normals and the like between them.</summary>
        private static List<int> Corners(XmlElement list, int stride, int offset, int positions)
        {
            List<int> numbers = ColladaNumbers.Indices(list.InnerText, "<p>");
            List<int> corners = new(numbers.Count / stride);
            for (int i = offset; i < numbers.Count; i += stride)
            {
                if (numbers[i] >= positions)
                {
                    throw new MeshException("the COLLADA file's <p> has position " + numbers[i] + " of " + positions
                        + ", counted from 0");
                }
                corners.Add(numbers[i]);
            }
            return corners;
        }

        private float[] Positions(XmlElement vertices)
        {
            foreach (XmlElement input in XmlTree.Children(vertices, "input"))
            {
                if (input.GetAttribute("semantic") == "POSITION")
                {
                    XmlElement source = _source(input);
                    if (!_positions.TryGetValue(source, out float[] positions))
                    {
                        positions = _positions[source] = ReadPositions(source);
                    }
                    return positions;
                }
            }
            throw new MeshException("the COLLADA file's <" + vertices.Name + "> has no POSITION");
        }

        private float[] ReadPositions(XmlElement source)
        {
            XmlElement technique = XmlTree.Child(source, "technique_common");
            XmlElement accessor = technique == null ? null : XmlTree.Child(technique, "accessor");
            XmlElement array = accessor == null ? null : _source(accessor);
            if (array == null)
            {
                throw new MeshException("the COLLADA file's <source> of positions has no accessor");
            }
            int count = Integer(accessor, "count", 0);
            int stride = Integer(accessor, "stride", 1);
            int offset = Integer(accessor, "offset", 0);
            float[] numbers = ColladaNumbers.Floats(array.InnerText, 0, "<" + array.Name + ">");
            if (stride < 3 || offset + (long)stride * count > numbers.Length)
            {
                throw new MeshException("the COLLADA file has " + count + " positions of " + stride + " numbers from "
                    + offset + " on, in an array of " + numbers.Length);
            }
            float[] positions = new float[3 * count];
            for (int i = 0; i < count; i++)
            {
                Array.Copy(numbers, offset + stride * i, positions, 3 * i, 3);
            }
            return positions;
        }

        private static int Integer(XmlElement element, string name, int otherwise)
        {
            if (!element.HasAttribute(name))
            {
                return otherwise;
            }
            List<int> numbers = ColladaNumbers.Indices(element.GetAttribute(name), "<" + element.Name + " " + name + ">");
            if (numbers.Count != 1 || numbers[0] == int.MaxValue)
            {
                throw new MeshException("the COLLADA file's <" + element.Name + "> has no good " + name);
            }
            return numbers[0];
        }
    }
}
