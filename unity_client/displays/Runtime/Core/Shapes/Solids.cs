// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Shapes
{
    /// <summary>
    /// Boxes, spheres, cylinders and arrows as triangles, each where a pose is and lit from above. Light is part of
    /// the colours, because the shaders of every build know none.
    /// </summary>
    public static class Solids
    {
        /// <summary>The vertices of a box.</summary>
        public const int BoxVertices = 24;

        private const int Around = 16; // corners of a circle: it looks round at arm's length
        private const int Along = 8; // rings of a sphere

        /// <summary>Adds a box by its middle and its sizes along its own axes.</summary>
        public static void Box(this MeshBuffer mesh, Pose<Flu> pose, Vector3<Flu> size, Rgba color)
        {
            if (!mesh.HasRoom(BoxVertices))
            {
                return;
            }
            for (int axis = 0; axis < 3; axis++)
            {
                for (int sign = -1; sign <= 1; sign += 2)
                {
                    Face(mesh, pose, size, color, axis, sign);
                }
            }
        }

        /// <summary>Adds a sphere, or an ellipsoid: by its middle and its diameters.</summary>
        public static void Sphere(this MeshBuffer mesh, Pose<Flu> pose, Vector3<Flu> size, Rgba color)
        {
            if (!mesh.HasRoom((Along + 1) * (Around + 1)))
            {
                return;
            }
            int first = mesh.VertexCount;
            for (int ring = 0; ring <= Along; ring++)
            {
                double up = Math.PI * ring / Along;
                for (int i = 0; i <= Around; i++)
                {
                    double turn = 2 * Math.PI * i / Around;
                    Vector3<Flu> normal = new(
                        Math.Sin(up) * Math.Cos(turn), Math.Sin(up) * Math.Sin(turn), Math.Cos(up));
                    Add(mesh, pose, Scaled(normal, size, 0.5), normal, color);
                }
            }
            for (int ring = 0; ring < Along; ring++)
            {
                Strip(mesh, first + ring * (Around + 1), first + (ring + 1) * (Around + 1));
            }
        }

        /// <summary>Adds a cylinder along z, by its middle, its diameters along x and y and its height.</summary>
        public static void Cylinder(this MeshBuffer mesh, Pose<Flu> pose, Vector3<Flu> size, Rgba color) =>
            Frustum(mesh, pose, -size.z / 2, size.z / 2, size, 0.5, 0.5, color);

        /// <summary>Adds an arrow along x, from where the pose is.</summary>
        public static void Arrow(
            this MeshBuffer mesh, Pose<Flu> pose, double shaftLength, double shaftDiameter, double headLength,
            double headDiameter, Rgba color)
        {
            // a frustum's axis is z: turned about y by a quarter, z points along x
            double half = Math.Sqrt(0.5);
            Pose<Flu> along = pose * new Pose<Flu>(default(Vector3<Flu>), new Quaternion<Flu>(0, half, 0, half));
            Vector3<Flu> one = new(1, 1, 1);
            Frustum(mesh, along, 0, shaftLength, one, shaftDiameter / 2, shaftDiameter / 2, color);
            Frustum(mesh, along, shaftLength, shaftLength + headLength, one, headDiameter / 2, 0, color);
        }

        /// <summary>Adds an arrow from one point to another.</summary>
        /// <param name="headLength">Of the whole. The shaft has what is left.</param>
        public static void Arrow(
            this MeshBuffer mesh, Vector3<Flu> from, Vector3<Flu> to, double shaftDiameter, double headDiameter,
            double headLength, Rgba color)
        {
            Vector3<Flu> way = to - from;
            double length = way.Length;
            if (!(length > 0))
            {
                return;
            }
            double head = Math.Min(headLength, length);
            Arrow(
                mesh, new Pose<Flu>(from, Towards(way)), length - head, shaftDiameter, head, headDiameter, color);
        }

        /// <summary>The shortest rotation that turns x into a direction.</summary>
        private static Quaternion<Flu> Towards(Vector3<Flu> way)
        {
            double length = way.Length;
            if (way.x <= -length * (1 - 1e-12))
            {
                return new Quaternion<Flu>(0, 0, 1, 0); // back: about z, as about any other axis
            }
            return new Quaternion<Flu>(0, -way.z, way.y, length + way.x).Normalized;
        }

        private static void Face(
            MeshBuffer mesh, Pose<Flu> pose, Vector3<Flu> size, Rgba color, int axis, int sign)
        {
            int first = mesh.VertexCount;
            Vector3<Flu> normal = Axis(axis, sign);
            for (int corner = 0; corner < 4; corner++)
            {
                // counterclockwise seen from outside, in the next two axes
                double u = corner == 0 || corner == 3 ? -1 : 1;
                double v = corner < 2 ? -1 : 1;
                Vector3<Flu> at = normal + u * Axis((axis + 1) % 3, sign) + v * Axis((axis + 2) % 3, 1);
                Add(mesh, pose, Scaled(at, size, 0.5), normal, color);
            }
            mesh.Triangle(first, first + 1, first + 2);
            mesh.Triangle(first, first + 2, first + 3);
        }

        /// <summary>A part of a cone along z, closed at both ends.</summary>
        private static void Frustum(
            MeshBuffer mesh, Pose<Flu> pose, double low, double high, Vector3<Flu> scale, double lowRadius,
            double highRadius, Rgba color)
        {
            if (!mesh.HasRoom(4 * (Around + 1) + 2))
            {
                return;
            }
            int side = mesh.VertexCount;
            double slope = high > low ? (lowRadius - highRadius) / (high - low) : 0;
            Ring(mesh, pose, high, highRadius, scale, slope, color);
            Ring(mesh, pose, low, lowRadius, scale, slope, color);
            Strip(mesh, side, side + Around + 1);
            Cap(mesh, pose, low, lowRadius, scale, -1, color);
            Cap(mesh, pose, high, highRadius, scale, 1, color);
        }

        private static void Ring(
            MeshBuffer mesh, Pose<Flu> pose, double height, double radius, Vector3<Flu> scale, double slope, Rgba color)
        {
            for (int i = 0; i <= Around; i++)
            {
                double turn = 2 * Math.PI * i / Around;
                double x = Math.Cos(turn), y = Math.Sin(turn);
                Vector3<Flu> normal = Unit(new Vector3<Flu>(x, y, slope));
                Vector3<Flu> at = new(radius * x * scale.x, radius * y * scale.y, height);
                Add(mesh, pose, at, normal, color);
            }
        }

        private static void Cap(
            MeshBuffer mesh, Pose<Flu> pose, double height, double radius, Vector3<Flu> scale, int sign, Rgba color)
        {
            if (!(radius > 0))
            {
                return;
            }
            Vector3<Flu> normal = new(0, 0, sign);
            int middle = Add(mesh, pose, new Vector3<Flu>(0, 0, height), normal, color);
            for (int i = 0; i <= Around; i++)
            {
                double turn = sign * 2 * Math.PI * i / Around;
                Vector3<Flu> at = new(
                    radius * Math.Cos(turn) * scale.x, radius * Math.Sin(turn) * scale.y, height);
                int corner = Add(mesh, pose, at, normal, color);
                if (i > 0)
                {
                    mesh.Triangle(middle, corner - 1, corner);
                }
            }
        }

        /// <summary>Joins two rings, the upper one first.</summary>
        private static void Strip(MeshBuffer mesh, int upper, int lower)
        {
            for (int i = 0; i < Around; i++)
            {
                mesh.Triangle(upper + i, lower + i, lower + i + 1);
                mesh.Triangle(upper + i, lower + i + 1, upper + i + 1);
            }
        }

        private static int Add(
            MeshBuffer mesh, Pose<Flu> pose, Vector3<Flu> point, Vector3<Flu> normal, Rgba color) =>
            mesh.Add(pose * point, color.Lit(pose.orientation * normal));

        private static Vector3<Flu> Axis(int axis, double length) =>
            new Vector3<Flu>(axis == 0 ? length : 0, axis == 1 ? length : 0, axis == 2 ? length : 0);

        private static Vector3<Flu> Scaled(Vector3<Flu> vector, Vector3<Flu> size, double factor) => new Vector3<Flu>(
            factor * vector.x * size.x, factor * vector.y * size.y, factor * vector.z * size.z);

        private static Vector3<Flu> Unit(Vector3<Flu> vector) => (1 / vector.Length) * vector;
    }
}
