// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.IO;
using System.Xml;
using Ros2Gateway.Shapes;

namespace Ros2Gateway.Robots
{
    /// <summary>
    /// Reads COLLADA files (1.4.1, https://www.khronos.org/files/collada_spec_1_4.pdf, 1.5 has the same): the triangles
    /// and polygons of the scene, in metres, and their colours. Any thread.
    /// </summary>
    /// <remarks>
    /// As RViz does it, the file's unit counts and its up_axis does not: x, y and z are those of the link. Textures,
    /// transparency and light are not read. Polygons are taken as convex.
    /// </remarks>
    public sealed class ColladaReader
    {
        /// <summary>Larger files are refused: as a tree, and as lists of numbers, they take several times as much.</summary>
        private const int MaxBytes = 32 << 20;

        private const int MaxParts = 1000000; // elements, attributes, texts. Of 286 meshes of robots the most was 28,000
        private const int MaxDepth = 100; // of elements, and of nodes in nodes: each is a call
        private const int MaxNodes = 100000; // and other parts of nodes, with those that are shown several times
        private const int MaxPlacement = 1000; // characters. Of these meshes the longest matrix has 129

        private readonly Dictionary<string, XmlElement> _byId = new();
        private readonly Dictionary<XmlElement, ColladaGeometry> _geometries
            = new();

        private readonly ColladaMaterials _materials;
        private readonly List<float> _corners = new();
        private readonly List<Rgba?> _colors = new();
        private bool _hasColors;
        private int _nodes;

        private ColladaReader() => _materials = new ColladaMaterials(_byId, Referred);

        /// <summary>Reads a file.</summary>
        /// <exception cref="MeshException">It is invalid, in words.</exception>
        public static TriangleMesh Read(byte[] collada)
        {
            if (collada == null || collada.Length == 0)
            {
                throw new MeshException("the COLLADA file is empty");
            }
            if (collada.Length > MaxBytes)
            {
                throw new MeshException("the COLLADA file has " + collada.Length + " bytes, at most " + MaxBytes);
            }
            XmlElement root;
            try
            {
                CheckSize(collada);
                using (XmlReader reader = Reader(collada))
                {
                    root = XmlTree.Root(reader);
                }
            }
            catch (XmlException error)
            {
                throw new MeshException("the COLLADA file is not XML: " + error.Message);
            }
            if (root.Name != "COLLADA")
            {
                throw new MeshException("the COLLADA file begins with <" + root.Name + ">, must begin with <COLLADA>");
            }
            return new ColladaReader().ReadRoot(root);
        }

        internal static MeshException TooManyTriangles() =>
            new MeshException("the COLLADA file has more than " + TriangleMesh.MaxTriangles + " triangles");

        private static XmlReader Reader(byte[] collada) => XmlReader.Create(new MemoryStream(collada), XmlTree.Settings);

        // A tree takes many times the memory of its text.
        private static void CheckSize(byte[] collada)
        {
            int parts = 0;
            using XmlReader reader = Reader(collada);
            while (reader.Read())
            {
                parts += reader.NodeType == XmlNodeType.EndElement ? 0 : 1 + reader.AttributeCount;
                if (parts > MaxParts)
                {
                    throw new MeshException(
                        "the COLLADA file has more than " + MaxParts + " elements, attributes and texts");
                }
                if (reader.Depth > MaxDepth)
                {
                    throw new MeshException("the COLLADA file is more than " + MaxDepth + " elements deep");
                }
            }
        }

        private TriangleMesh ReadRoot(XmlElement root)
        {
            Index(root);
            double unit = Unit(root);
            Affine metres = Affine.Scaling(unit, unit, unit);
            XmlElement scene = Scene(root);
            if (scene != null)
            {
                ShowAll(scene, metres, 0);
            }
            else
            {
                foreach (XmlElement library in XmlTree.Children(root, "library_geometries"))
                {
                    foreach (XmlElement geometry in XmlTree.Children(library, "geometry"))
                    {
                        Show(geometry, metres, null);
                    }
                }
            }
            if (_colors.Count == 0)
            {
                throw new MeshException("the COLLADA file shows no triangles");
            }
            return new TriangleMesh(
                _corners.ToArray(), new float[3 * _colors.Count], _hasColors ? _colors.ToArray() : null);
        }

        private void Index(XmlElement element)
        {
            string id = element.GetAttribute("id");
            if (id.Length > 0 && !_byId.ContainsKey(id))
            {
                _byId[id] = element;
            }
            foreach (XmlElement child in XmlTree.Children(element))
            {
                Index(child);
            }
        }

        /// <summary>How many metres the unit of the file has.</summary>
        private static double Unit(XmlElement root)
        {
            XmlElement asset = XmlTree.Child(root, "asset");
            XmlElement unit = asset == null ? null : XmlTree.Child(asset, "unit");
            if (unit == null || !unit.HasAttribute("meter"))
            {
                return 1;
            }
            double metres = ColladaNumbers.Floats(unit.GetAttribute("meter"), 1, "<unit meter>")[0];
            if (!(metres > 0))
            {
                throw new MeshException("the COLLADA file's unit has " + unit.GetAttribute("meter") + " metres");
            }
            return metres;
        }

        /// <summary>The scene that the file says is to be shown, else the first. Null without one.</summary>
        private XmlElement Scene(XmlElement root)
        {
            XmlElement scene = XmlTree.Child(root, "scene");
            XmlElement instance = scene == null ? null : XmlTree.Child(scene, "instance_visual_scene");
            if (instance != null)
            {
                return Referred(instance, "url");
            }
            XmlElement library = XmlTree.Child(root, "library_visual_scenes");
            return library == null ? null : XmlTree.Child(library, "visual_scene");
        }

        /// <summary>Shows what a scene or a node has, which it may place.</summary>
        private void ShowAll(XmlElement node, Affine placed, int depth)
        {
            if (depth > MaxDepth)
            {
                throw new MeshException(
                    "the COLLADA file's nodes are more than " + MaxDepth + " deep, or show themselves");
            }
            foreach (XmlElement child in XmlTree.Children(node))
            {
                if (++_nodes > MaxNodes)
                {
                    throw new MeshException("the COLLADA file shows more than " + MaxNodes + " nodes and parts of nodes");
                }
                switch (child.Name)
                {
                    case "matrix":
                    case "translate":
                    case "rotate":
                    case "scale":
                        placed = placed * Placement(child);
                        break;
                    case "lookat":
                    case "skew":
                    case "instance_controller": // of a skin, which bones move
                        throw new MeshException("the COLLADA file has <" + child.Name + ">, which is not read");
                    case "instance_geometry":
                        Show(Referred(child, "url"), placed, child);
                        break;
                    case "instance_node":
                        ShowAll(Referred(child, "url"), placed, depth + 1);
                        break;
                    case "node":
                        ShowAll(child, placed, depth + 1);
                        break;
                }
            }
        }

        private static Affine Placement(XmlElement element)
        {
            string name = element.Name;
            if (element.InnerText.Length > MaxPlacement)
            {
                throw new MeshException(
                    "the COLLADA file's <" + name + "> has more than " + MaxPlacement + " characters");
            }
            int count = name == "matrix" ? 16 : name == "rotate" ? 4 : 3;
            float[] floats = ColladaNumbers.Floats(element.InnerText, count, "<" + name + ">");
            double[] n = Array.ConvertAll(floats, one => (double)one);
            switch (name)
            {
                case "matrix":
                    return new Affine(n);
                case "translate":
                    return Affine.Moving(n[0], n[1], n[2]);
                case "scale":
                    return Affine.Scaling(n[0], n[1], n[2]);
                default:
                    bool hasAxis = n[0] != 0 || n[1] != 0 || n[2] != 0;
                    return Affine.Turning(n[0], n[1], hasAxis ? n[2] : 1, hasAxis ? n[3] * Math.PI / 180 : 0);
            }
        }

        /// <param name="instance">Says what the materials are that the geometry names. May be null.</param>
        private void Show(XmlElement element, Affine placed, XmlElement instance)
        {
            if (!_geometries.TryGetValue(element, out ColladaGeometry geometry))
            {
                geometry = _geometries[element] = new ColladaGeometry(element, reference => Referred(reference, "source"));
            }
            bool isMirroring = placed.IsMirroring;
            foreach (ColladaFaces faces in geometry.Faces)
            {
                Rgba? color = _materials.Color(faces.Material, instance);
                _hasColors |= color.HasValue;
                if (_colors.Count + faces.Corners.Count / 3 > TriangleMesh.MaxTriangles)
                {
                    throw TooManyTriangles();
                }
                for (int i = 0; i < faces.Corners.Count; i += 3)
                {
                    Add(placed.Place(faces.Positions, 3 * faces.Corners[i]));
                    Add(placed.Place(faces.Positions, 3 * faces.Corners[i + (isMirroring ? 2 : 1)]));
                    Add(placed.Place(faces.Positions, 3 * faces.Corners[i + (isMirroring ? 1 : 2)]));
                    _colors.Add(color);
                }
            }
        }

        private void Add(Vector3<Flu> corner)
        {
            if (!(Math.Abs(corner.x) + Math.Abs(corner.y) + Math.Abs(corner.z) <= float.MaxValue))
            {
                throw new MeshException(
                    "a corner of the COLLADA file is at " + corner + ", farther away than float32 goes");
            }
            _corners.Add((float)corner.x);
            _corners.Add((float)corner.y);
            _corners.Add((float)corner.z);
        }

        private XmlElement Referred(XmlElement reference, string attribute)
        {
            string id = reference.GetAttribute(attribute);
            if (id.Length < 2 || id[0] != '#' || !_byId.TryGetValue(id.Substring(1), out XmlElement found))
            {
                throw new MeshException("the COLLADA file's <" + reference.Name + "> refers to '" + id
                    + "', which is nothing in the file");
            }
            return found;
        }
    }
}
