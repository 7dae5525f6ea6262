// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using Ros2Gateway.Messages.StdMsgs;
using Ros2Gateway.Robots;
using Ros2Gateway.Shapes;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Builds a robot from its description (URDF): an object for each link, which joints move. Below a Fixed Frame it
    /// stands where its root link's frame is. Else the Transform is the root link.
    /// </summary>
    /// <remarks>
    /// Boxes, cylinders and spheres are drawn. A mesh is one of *Models* with the name of its file. Else the file itself
    /// if it is an STL or COLLADA file (.dae) of a package, which the gateway serves. Else, and until that has come, a small
    /// box. A file's own colours come before those of the description, as in RViz. Textures are not shown.
    /// </remarks>
    [AddComponentMenu("ROS 2 Gateway/Robot Description Display")]
    public sealed class RobotDescriptionDisplay : FramedDisplay<StringMsg>
    {
        private const double MeshBox = 0.05; // metres: where something is, not what it is like

        [SerializeField]
        [Tooltip("Imported models for the robot's meshes: base.stl and base.dae are the one with the name base")]
        private GameObject[] _models = new GameObject[0];

        [SerializeField]
        [Tooltip("Fetch meshes that are not among Models from the gateway: STL and COLLADA files of its packages")]
        private bool _fetchMeshes = true;

        [SerializeField]
        [Tooltip("Of all meshes that are fetched for a robot. Further ones stay small boxes. 4 million take 250 MB of the GPU")]
        [Range(1000, 50000000)]
        private int _maxTriangles = 1 << 22;

        [SerializeField]
        [Tooltip("Before the names of links in the frames of transforms, such as robot1/")]
        private string _framePrefix = "";

        [SerializeField]
        [Tooltip("Of solids. Empty: one that uses the colors of vertices")]
        private Material _material;

        private readonly Dictionary<string, Transform> _links = new();
        private List<GameObject> _made = new(); // not readonly, as only so it survives a reload of scripts
        private readonly List<PointMesh> _meshes = new();
        private readonly MeshBuffer _shapes = new();
        private readonly MeshStaging _staging = new();
        private string _shown;
        private Material _own; // if none was chosen
        private ServedMeshes _served; // of the robot that is shown. Null if none of its meshes is to be fetched

        /// <summary>Imported models for the robot's meshes, by the files' names. For the next description.</summary>
        public GameObject[] Models
        {
            get => _models;
            set => _models = value;
        }

        /// <summary>Whether meshes that are not among Models are fetched from the gateway. For the next description.</summary>
        public bool FetchMeshes
        {
            get => _fetchMeshes;
            set => _fetchMeshes = value;
        }

        /// <summary>How many triangles all meshes that are fetched for a robot may have. For the next description.</summary>
        public int MaxTriangles
        {
            get => _maxTriangles;
            set => _maxTriangles = value;
        }

        /// <summary>Before the names of links in the frames of transforms, such as robot1/.</summary>
        public string FramePrefix
        {
            get => _framePrefix;
            set => _framePrefix = value;
        }

        /// <summary>The robot that is shown. Null before the first description.</summary>
        public RobotDescription Robot { get; private set; }

        /// <summary>The object of a link, or null.</summary>
        public Transform Link(string name) => name != null && _links.TryGetValue(name, out Transform link) ? link : null;

        /// <summary>Moves a joint, and those that mimic it. False if there is no such joint.</summary>
        /// <param name="position">In radians or metres.</param>
        public bool SetJoint(string name, double position)
        {
            RobotJoint joint = Robot == null ? null : Robot.Joint(name);
            if (joint == null)
            {
                return false;
            }
            Move(joint, position);
            foreach (RobotJoint other in Robot.Joints)
            {
                if (other.Mimicked == name)
                {
                    Move(other, other.Multiplier * position + other.Offset);
                }
            }
            return true;
        }

        /// <inheritdoc/>
        protected override void Update()
        {
            if (_served != null)
            {
                _served.Update(Client()); // first, as base.Update hides what is new if it must
                _served = _served.IsOver ? null : _served;
            }
            base.Update();
        }

        private void OnDestroy()
        {
            Clear();
            Destroy(_own);
        }

        /// <inheritdoc/>
        protected override bool Draw(StringMsg message)
        {
            if (Robot != null && message.data == _shown)
            {
                StandIn(_framePrefix + Robot.Root);
                return true; // published again: joints stay where they are
            }
            RobotDescription robot;
            try
            {
                robot = UrdfReader.Read(message.data);
            }
            catch (UrdfException error)
            {
                Warn(error.Message);
                return false;
            }
            Clear();
            Robot = robot;
            _shown = message.data;
            StandIn(_framePrefix + robot.Root);
            Build();
            return true;
        }

        private void Build()
        {
            _links[Robot.Root] = transform;
            foreach (RobotJoint joint in Robot.Joints)
            {
                GameObject link = new(joint.Child);
                link.transform.SetParent(_links[joint.Parent], false);
                _links[joint.Child] = link.transform;
                _made.Add(link);
                Move(joint, 0);
            }
            foreach (RobotJoint joint in Robot.Joints)
            {
                if (joint.Mimicked.Length > 0)
                {
                    Move(joint, joint.Offset);
                }
            }
            foreach (RobotLink link in Robot.Links)
            {
                foreach (RobotVisual visual in link.Visuals)
                {
                    Add(visual, _links[link.Name]);
                }
            }
        }

        private void Add(RobotVisual visual, Transform link)
        {
            GameObject model = visual.Shape == RobotShape.Mesh ? Model(visual.Mesh) : null;
            if (model != null)
            {
                Pose pose = visual.Origin.ToUnity();
                GameObject copy = Instantiate(model, link);
                copy.transform.localPosition = pose.position;
                copy.transform.localRotation = pose.rotation * copy.transform.localRotation;
                copy.transform.localScale = Vector3.Scale(copy.transform.localScale, ScaleOf(visual));
                _made.Add(copy);
                return;
            }
            PointMesh mesh = Drawn(visual, link);
            _shapes.Clear(MeshKind.Triangles);
            Shape(visual);
            mesh.Upload(_shapes);
            if (IsServed(visual))
            {
                _served ??= new ServedMeshes(Warn, _maxTriangles);
                _served.Add(visual, mesh, () => More(visual, link));
            }
        }

        private PointMesh Drawn(RobotVisual visual, Transform link)
        {
            GameObject made = new(visual.Shape.ToString(), typeof(MeshFilter), typeof(MeshRenderer));
            made.transform.SetParent(link, false);
            _made.Add(made);
            _own = _material != null ? _own : _own ?? DisplayMaterials.Solid();
            made.GetComponent<MeshRenderer>().sharedMaterial = _material != null ? _material : _own;
            PointMesh mesh = new(made.transform, true, _staging);
            _meshes.Add(mesh);
            return mesh;
        }

        // For what is too much for one mesh. Null if someone has destroyed the link.
        private PointMesh More(RobotVisual visual, Transform link)
        {
            if (link == null)
            {
                return null;
            }
            StandIn(FrameId); // or it would be drawn while all else is hidden
            return Drawn(visual, link);
        }

        private void Shape(RobotVisual visual)
        {
            switch (visual.Shape)
            {
                case RobotShape.Box:
                    _shapes.Box(visual.Origin, visual.Size, visual.Color);
                    break;
                case RobotShape.Cylinder:
                    _shapes.Cylinder(visual.Origin, visual.Size, visual.Color);
                    break;
                case RobotShape.Sphere:
                    _shapes.Sphere(visual.Origin, visual.Size, visual.Color);
                    break;
                default:
                    WarnOfBox(visual);
                    _shapes.Box(visual.Origin, new Vector3<Flu>(MeshBox, MeshBox, MeshBox), visual.Color);
                    break;
            }
        }

        private void WarnOfBox(RobotVisual visual)
        {
            string reason = !_fetchMeshes ? ""
                : !IsServed(visual) ? " among Models, and the gateway serves only .stl and .dae by package:// or file://"
                : Client() == null ? " among Models, and no Gateway Connection to fetch it" : null;
            if (reason != null)
            {
                Warn("no model for " + visual.Mesh + reason + ": a small box takes its place");
            }
        }

        private bool IsServed(RobotVisual visual)
        {
            return _fetchMeshes && visual.Shape == RobotShape.Mesh
                && (visual.Mesh.StartsWith("package://", StringComparison.Ordinal)
                    || visual.Mesh.StartsWith("file://", StringComparison.Ordinal)) // by xacro's find
                && MeshReader.CanRead(visual.Mesh);
        }

        private GatewayClient Client()
        {
            GatewayConnection connection = Subscriber == null ? null : Subscriber.Connection;
            return connection == null ? null : connection.Client;
        }

        private GameObject Model(string mesh)
        {
            int from = mesh.LastIndexOf('/') + 1;
            int dot = mesh.LastIndexOf('.');
            string file = dot > from ? mesh.Substring(from, dot - from) : mesh.Substring(from);
            foreach (GameObject model in _models)
            {
                if (model != null && model.name == file)
                {
                    return model;
                }
            }
            return null;
        }

        // factors along x, y, z of ROS, which are forward, left, up
        private static Vector3 ScaleOf(RobotVisual visual) =>
            new Vector3((float)visual.Size.y, (float)visual.Size.z, (float)visual.Size.x);

        private void Move(RobotJoint joint, double position)
        {
            Pose pose = joint.PoseAt(position).ToUnity();
            Transform link = _links[joint.Child];
            link.localPosition = pose.position;
            link.localRotation = pose.rotation;
        }

        private void Clear()
        {
            if (_served != null)
            {
                _served.Dispose();
                _served = null;
            }
            foreach (PointMesh mesh in _meshes)
            {
                mesh.Destroy();
            }
            foreach (GameObject made in _made)
            {
                if (made != null) // else it went with its parent
                {
                    Destroy(made);
                }
            }
            _meshes.Clear();
            _made.Clear();
            _links.Clear();
            Robot = null;
        }
    }
}
