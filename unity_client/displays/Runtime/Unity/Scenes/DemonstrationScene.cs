// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// The base of scenes that build themselves in an empty one. With a connection unless there is one, a floor, a light, a
    /// camera, a screen and a robot's digital twin.
    /// </summary>
    public abstract class DemonstrationScene : MonoBehaviour
    {
        private static readonly Color FloorColor = new(0.35f, 0.37f, 0.4f);

        [SerializeField]
        [Tooltip("The address of the gateway, unless the scene has a Gateway Connection")]
        private string _address = "ws://localhost:9090";

        [SerializeField]
        private string _imageTopic = "/camera/image_raw";

        [SerializeField]
        private string _odometryTopic = "/odom";

        [SerializeField]
        private string _commandTopic = "/cmd_vel";

        [SerializeField]
        [Tooltip("Of floor and robot. Empty: the default one, which a build with URP may lack")]
        private Material _material;

#pragma warning disable 0169 // so that stripping leaves what CreatePrimitive needs
        private MeshFilter _keepMeshFilter;
        private MeshRenderer _keepMeshRenderer;
        private MeshCollider _keepMeshCollider;
        private BoxCollider _keepBoxCollider;
        private CapsuleCollider _keepCapsuleCollider;
#pragma warning restore 0169

        private GatewaySettings _settings;
        private List<Material> _colored = new(); // not readonly, as only so it survives a reload of scripts

        /// <summary>The address of the gateway. Before the scene is active.</summary>
        public string Address
        {
            get => _address;
            set => _address = value;
        }

        /// <summary>The robot's odometry.</summary>
        protected string OdometryTopic => _odometryTopic;

        /// <summary>The topic of the velocities.</summary>
        protected string CommandTopic => _commandTopic;

        /// <summary>Builds what this scene has in addition to connection, floor and light.</summary>
        protected abstract void Build();

        /// <summary>Destroys what is not an object of the scene. Overriders call it.</summary>
        protected virtual void OnDestroy()
        {
            if (_settings != null)
            {
                Destroy(_settings);
            }
            foreach (Material material in _colored)
            {
                Destroy(material); // Unity destroys none that Renderer.material has made
            }
        }

        /// <summary>Moves the scene's camera, or a new one, to an object, so high and tilted down so far.</summary>
        protected static Transform BuildEyes(Transform parent, float height, float tilt)
        {
            Camera eyes = Camera.main;
            if (eyes == null)
            {
                eyes = new GameObject("Eyes", typeof(Camera)).GetComponent<Camera>();
                eyes.tag = "MainCamera";
            }
            eyes.transform.SetParent(parent, false);
            eyes.transform.localPosition = new Vector3(0, height, 0);
            eyes.transform.localRotation = Quaternion.Euler(tilt, 0, 0);
            return eyes.transform;
        }

        /// <summary>Makes a screen with the camera's pictures.</summary>
        protected void BuildImageScreen(Vector3 position)
        {
            GameObject picture = Shape(
                PrimitiveType.Quad, "Image Screen", transform, position, new Vector3(1.6f, 1.2f, 1));
            picture.SetActive(false);
            SceneParts.Subscribe(picture, _imageTopic, "sensor_msgs/msg/Image", 15).AddComponent<ImageScreen>();
            picture.SetActive(true);
        }

        /// <summary>Makes a digital twin, not active yet, below an object where odometry begins.</summary>
        protected GameObject BuildTwin()
        {
            Transform origin = SceneParts.New("Odometry's Origin", transform).transform;
            origin.gameObject.SetActive(true);
            GameObject twin = SceneParts.New("Digital Twin", origin);
            SceneParts.Subscribe(twin, _odometryTopic, "nav_msgs/msg/Odometry").AddComponent<DigitalTwin>();
            Part(
                PrimitiveType.Cylinder, "Body", twin.transform,
                new Vector3(0, 0.08f, 0), new Vector3(0.28f, 0.05f, 0.28f), new Color(0.2f, 0.2f, 0.22f));
            Part(
                PrimitiveType.Cube, "Nose", twin.transform,
                new Vector3(0, 0.1f, 0.12f), new Vector3(0.05f, 0.03f, 0.05f), Color.yellow);
            return twin;
        }

        /// <summary>Makes a text, not active yet.</summary>
        protected GameObject Text(string name, Vector3 position)
        {
            GameObject screen = SceneParts.New(name, transform);
            screen.transform.localPosition = position;
            SceneParts.AddText(screen);
            return screen;
        }

        /// <summary>Makes a shape of one colour.</summary>
        protected GameObject Part(
            PrimitiveType shape, string name, Transform parent, Vector3 position, Vector3 scale, Color color)
        {
            GameObject part = Shape(shape, name, parent, position, scale);
            Material material = part.GetComponent<Renderer>().material; // a copy, for this part
            material.color = color;
            _colored.Add(material);
            return part;
        }

        private GameObject Shape(PrimitiveType shape, string name, Transform parent, Vector3 position, Vector3 scale)
        {
            GameObject part = GameObject.CreatePrimitive(shape);
            part.name = name;
            part.transform.SetParent(parent, false);
            part.transform.localPosition = position;
            part.transform.localScale = scale;
            if (_material != null)
            {
                part.GetComponent<Renderer>().sharedMaterial = _material;
            }
            return part;
        }

        private void Awake()
        {
            if (FindAnyObjectByType<GatewayConnection>() == null)
            {
                _settings = ScriptableObject.CreateInstance<GatewaySettings>();
                _settings.Address = _address;
                GameObject connection = SceneParts.New("Gateway Connection", transform);
                connection.AddComponent<GatewayConnection>().Settings = _settings;
                connection.SetActive(true);
            }
            Part(PrimitiveType.Plane, "Floor", transform, Vector3.zero, Vector3.one, FloorColor);
            Light sun = new GameObject("Light", typeof(Light)).GetComponent<Light>();
            sun.type = LightType.Directional;
            sun.transform.SetParent(transform, false);
            sun.transform.localRotation = Quaternion.Euler(50, -30, 0);
            Build();
        }
    }
}
