// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.StdMsgs;
using Ros2Gateway.Messages.VisualizationMsgs;

namespace Ros2Gateway.Shapes
{
    /// <summary>The shapes of visualization_msgs/msg/Marker, in the axes of the marker's own pose.</summary>
    /// <remarks>Lines are as wide as the graphics card makes them. A mesh is a box of the marker's scale.</remarks>
    public static class MarkerShapes
    {
        private const double ShaftShare = 0.77; // of an arrow that is given by its length, as in RViz
        private const double HeadShare = 0.23;

        private static readonly Vector3<Flu> Zero = new(0, 0, 0);
        private static readonly Pose<Flu> Origin = new(Zero, Quaternion<Flu>.Identity);

        /// <summary>Whether a marker is a text, which has no shape.</summary>
        public static bool IsText(this MarkerMsg marker) => marker.type == MarkerMsg.TEXT_VIEW_FACING;

        /// <summary>Builds what a marker looks like.</summary>
        /// <returns>The fault, or the part that is not shown. Null without one.</returns>
        public static string Build(MarkerMsg marker, MeshBuffer mesh)
        {
            mesh.Clear(KindOf(marker.type));
            string problem = ProblemOf(marker);
            if (problem != null)
            {
                return problem;
            }
            Vector3<Flu> scale = marker.scale.As<Flu>();
            Rgba color = Rgba.Of(marker.color);
            switch (marker.type)
            {
                case MarkerMsg.ARROW:
                    problem = Arrow(marker, mesh, scale, color);
                    break;
                case MarkerMsg.CUBE:
                    mesh.Box(Origin, scale, color);
                    break;
                case MarkerMsg.SPHERE:
                    mesh.Sphere(Origin, scale, color);
                    break;
                case MarkerMsg.CYLINDER:
                    mesh.Cylinder(Origin, scale, color);
                    break;
                case MarkerMsg.MESH_RESOURCE:
                    mesh.Box(Origin, scale, color);
                    problem = "meshes are shown as boxes";
                    break;
                case MarkerMsg.TEXT_VIEW_FACING:
                    break;
                case MarkerMsg.LINE_STRIP:
                case MarkerMsg.LINE_LIST:
                    problem = Lines(marker, mesh);
                    break;
                case MarkerMsg.TRIANGLE_LIST:
                    problem = Triangles(marker, mesh, scale);
                    break;
                case MarkerMsg.ARROW_STRIP:
                    problem = ArrowStrip(marker, mesh, scale, color);
                    break;
                default:
                    problem = Solid(marker, mesh, scale);
                    break;
            }
            return problem ?? (mesh.IsTruncated
                ? "more than " + mesh.Room + " vertices, for which there is room: only a part of it is drawn" : null);
        }

        private static MeshKind KindOf(int type) =>
            type == MarkerMsg.LINE_STRIP || type == MarkerMsg.LINE_LIST ? MeshKind.Lines : MeshKind.Triangles;

        private static string ProblemOf(MarkerMsg marker)
        {
            if (marker.type < MarkerMsg.ARROW || marker.type > MarkerMsg.ARROW_STRIP)
            {
                return "type " + marker.type + " is unknown";
            }
            if (marker.scale == null || !IsFinite(marker.scale.As<Flu>()))
            {
                return "its scale is not finite";
            }
            return null;
        }

        private static string Arrow(MarkerMsg marker, MeshBuffer mesh, Vector3<Flu> scale, Rgba color)
        {
            if (Count(marker) == 0)
            {
                mesh.Arrow(Origin, ShaftShare * scale.x, scale.y, HeadShare * scale.x, 2 * scale.y, color);
                return null;
            }
            Vector3<Flu> from, to;
            if (Count(marker) == 1 || !TryPoint(marker, 0, out from) || !TryPoint(marker, 1, out to))
            {
                return "an arrow needs a start and an end that are finite";
            }
            double head = scale.z > 0 ? scale.z : HeadShare * (to - from).Length;
            mesh.Arrow(from, to, scale.x, scale.y, head, color);
            return null;
        }

        private static string ArrowStrip(MarkerMsg marker, MeshBuffer mesh, Vector3<Flu> scale, Rgba color)
        {
            string problem = null;
            for (int i = 0; i + 1 < Count(marker) && !mesh.IsTruncated; i++)
            {
                Vector3<Flu> from, to;
                if (TryPoint(marker, i, out from) && TryPoint(marker, i + 1, out to))
                {
                    double head = scale.z > 0 ? scale.z : HeadShare * (to - from).Length;
                    mesh.Arrow(from, to, scale.x, scale.y, head, color);
                }
                else
                {
                    problem = NotFinite;
                }
            }
            return problem;
        }

        private static string Lines(MarkerMsg marker, MeshBuffer mesh)
        {
            bool isStrip = marker.type == MarkerMsg.LINE_STRIP;
            string problem = null;
            int previous = -1;
            for (int i = 0; i < Count(marker) && mesh.HasRoom(1); i++)
            {
                bool isStart = !isStrip && i % 2 == 0;
                if (!TryPoint(marker, i, out Vector3<Flu> point))
                {
                    problem = NotFinite;
                    previous = -1;
                    continue;
                }
                int vertex = mesh.Add(point, ColorOf(marker, i));
                if (previous >= 0 && !isStart)
                {
                    mesh.Line(previous, vertex);
                }
                previous = vertex;
            }
            return problem;
        }

        private static string Triangles(MarkerMsg marker, MeshBuffer mesh, Vector3<Flu> scale)
        {
            string problem = Count(marker) % 3 == 0 ? null : "a triangle has three points, and some are left over";
            for (int i = 0; i + 2 < Count(marker) && mesh.HasRoom(3); i += 3)
            {
                Vector3<Flu> a, b, c;
                if (!TryPoint(marker, i, out a) || !TryPoint(marker, i + 1, out b) || !TryPoint(marker, i + 2, out c))
                {
                    problem = NotFinite;
                    continue;
                }
                Vector3<Flu> normal = Normal(a, b, c);
                int first = mesh.Add(Scaled(a, scale), ColorOf(marker, i).Lit(normal));
                mesh.Add(Scaled(b, scale), ColorOf(marker, i + 1).Lit(normal));
                mesh.Add(Scaled(c, scale), ColorOf(marker, i + 2).Lit(normal));
                mesh.Triangle(first, first + 1, first + 2);
            }
            return problem;
        }

        /// <summary>Points and lists of boxes and of spheres: the same shape at every point.</summary>
        private static string Solid(MarkerMsg marker, MeshBuffer mesh, Vector3<Flu> scale)
        {
            // a point is a small box: it has a size in metres, which a graphics card's points have not
            Vector3<Flu> size = marker.type == MarkerMsg.POINTS
                ? new Vector3<Flu>(scale.x, scale.x, scale.y) : scale;
            string problem = null;
            for (int i = 0; i < Count(marker) && !mesh.IsTruncated; i++)
            {
                if (!TryPoint(marker, i, out Vector3<Flu> point))
                {
                    problem = NotFinite;
                    continue;
                }
                Pose<Flu> at = new(point, Quaternion<Flu>.Identity);
                if (marker.type == MarkerMsg.SPHERE_LIST)
                {
                    mesh.Sphere(at, size, ColorOf(marker, i));
                }
                else
                {
                    mesh.Box(at, size, ColorOf(marker, i));
                }
            }
            return problem;
        }

        private const string NotFinite = "some of its points are not finite, and are left out";

        private static int Count(MarkerMsg marker) => marker.points == null ? 0 : marker.points.Length;

        private static bool TryPoint(MarkerMsg marker, int index, out Vector3<Flu> point)
        {
            PointMsg message = marker.points[index];
            point = message == null ? Zero : message.As<Flu>();
            return message != null && IsFinite(point);
        }

        // Either every point has its own colour, or all have the marker's.
        private static Rgba ColorOf(MarkerMsg marker, int index)
        {
            ColorRGBAMsg[] colors = marker.colors;
            return Rgba.Of(colors != null && colors.Length == Count(marker) ? colors[index] : marker.color);
        }

        private static Vector3<Flu> Normal(Vector3<Flu> a, Vector3<Flu> b, Vector3<Flu> c)
        {
            Vector3<Flu> u = b - a, v = c - a;
            Vector3<Flu> normal = new(
                u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
            // both sides are drawn, and a flat one has none: the side that faces up counts
            return Math.Sign(normal.z) < 0 ? (-1 / normal.Length) * normal : (1 / normal.Length) * normal;
        }

        private static Vector3<Flu> Scaled(Vector3<Flu> point, Vector3<Flu> scale) =>
            new Vector3<Flu>(point.x * scale.x, point.y * scale.y, point.z * scale.z);

        private static bool IsFinite(Vector3<Flu> vector)
        {
            return vector.Length <= float.MaxValue; // false for NaN as well
        }
    }
}
