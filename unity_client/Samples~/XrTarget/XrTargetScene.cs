// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEngine;

namespace Ros2Gateway.Samples.XrTarget
{
    /// <summary>
    /// Builds the demonstration in an empty scene: a floor to point at, a user's rig, a robot's digital twin
    /// and its target. Works with a headset, and with the mouse where there is none.
    /// </summary>
    public sealed class XrTargetScene : MonoBehaviour
    {
        private const float EyeHeight = 1.6f; // m, until a headset says otherwise

        private static readonly Color FloorColor = new Color(0.35f, 0.37f, 0.4f);

        [SerializeField]
        [Tooltip("Where the gateway is, unless the scene has a Gateway Connection")]
        private string _address = "ws://localhost:9090";

        [SerializeField]
        private string _odometryTopic = "/odom";

        [SerializeField]
        private string _imageTopic = "/camera/image_raw";

        [SerializeField]
        private string _commandTopic = "/cmd_vel";

        [SerializeField]
        [Tooltip("Whether a window without focus stops the robot. Off for a headset whose desktop window is in the background")]
        private bool _stopsWithoutFocus = true;

        [SerializeField]
        [Tooltip("An object with a component that points, such as Xr Action Input; without, a headset's controllers or the mouse")]
        private GameObject _pointer;

        [SerializeField]
        [Tooltip("Of floor and robot; without, the default one, which a build with URP may lack")]
        private Material _material;

#pragma warning disable 0169 // so that stripping leaves what CreatePrimitive needs
        private MeshFilter _keepMeshFilter;
        private MeshRenderer _keepMeshRenderer;
        private MeshCollider _keepMeshCollider;
        private BoxCollider _keepBoxCollider;
        private CapsuleCollider _keepCapsuleCollider;
#pragma warning restore 0169

        private GatewaySettings _settings;
        private Material _lineMaterial;
        private TargetDriver _driver;
        private TextMesh _state;

        /// <summary>Where the gateway is; before the scene is active.</summary>
        public string Address
        {
            get { return _address; }
            set { _address = value; }
        }

        private void Awake()
        {
            if (FindAnyObjectByType<GatewayConnection>() == null)
            {
                Connect();
            }
            BuildRoom();
            BuildTwin();
            BuildUser();
        }

        private void Update()
        {
            string words = _driver.State.ToString();
            if (_driver.Reason.Length > 0)
            {
                words += ": " + _driver.Reason;
            }
            words += "\n" + _driver.Status;
            if (_state.text != words)
            {
                _state.text = words;
            }
        }

        private void OnDestroy()
        {
            if (_settings != null)
            {
                Destroy(_settings);
            }
            if (_lineMaterial != null)
            {
                Destroy(_lineMaterial);
            }
        }

        private void Connect()
        {
            _settings = ScriptableObject.CreateInstance<GatewaySettings>();
            _settings.Address = _address;
            GameObject connection = New("Gateway Connection", transform);
            connection.AddComponent<GatewayConnection>().Settings = _settings;
            connection.SetActive(true);
        }

        private void BuildRoom()
        {
            Part(PrimitiveType.Plane, "Floor", transform, Vector3.zero, Vector3.one, FloorColor);
            Light sun = new GameObject("Light", typeof(Light)).GetComponent<Light>();
            sun.type = LightType.Directional;
            sun.transform.SetParent(transform, false);
            sun.transform.localRotation = Quaternion.Euler(50, -30, 0);

            GameObject picture = Part(
                PrimitiveType.Quad, "Image Screen", transform,
                new Vector3(0, 2, 4), new Vector3(1.6f, 1.2f, 1), Color.white);
            picture.SetActive(false);
            Subscribe(picture, _imageTopic, "sensor_msgs/msg/Image", 15).AddComponent<ImageScreen>();
            picture.SetActive(true);

            GameObject hud = Text("Connection HUD", new Vector3(-2.5f, 2.6f, 4));
            hud.AddComponent<ConnectionHud>();
            hud.SetActive(true);
            GameObject state = Text("Drive's State", new Vector3(-2.5f, 1.2f, 4));
            _state = state.GetComponent<TextMesh>();
            state.SetActive(true);
        }

        private void BuildTwin()
        {
            // what the twin's poses are relative to
            Transform origin = New("Odometry's Origin", transform).transform;
            origin.gameObject.SetActive(true);
            GameObject twin = New("Digital Twin", origin);
            Subscribe(twin, _odometryTopic, "nav_msgs/msg/Odometry", 0);
            twin.AddComponent<DigitalTwin>();
            Through(Part(
                PrimitiveType.Cylinder, "Body", twin.transform,
                new Vector3(0, 0.08f, 0), new Vector3(0.28f, 0.05f, 0.28f), new Color(0.2f, 0.2f, 0.22f)));
            Through(Part(
                PrimitiveType.Cube, "Nose", twin.transform,
                new Vector3(0, 0.1f, 0.12f), new Vector3(0.05f, 0.03f, 0.05f), Color.yellow));
            twin.SetActive(true);

            GameObject marker = Part(
                PrimitiveType.Cylinder, "Target", transform,
                Vector3.zero, new Vector3(0.2f, 0.005f, 0.2f), Color.green);
            Through(marker);
            GameObject driver = New("Target Driver", transform);
            _driver = driver.AddComponent<TargetDriver>();
            _driver.Topic = _commandTopic;
            _driver.StopsWithoutFocus = _stopsWithoutFocus;
            _driver.Odometry = twin.GetComponent<TopicSubscriber>();
            _driver.Origin = origin;
            _driver.Marker = marker.transform;
            driver.SetActive(true);
        }

        private void BuildUser()
        {
            GameObject rig = New("Rig", transform);
            rig.transform.localPosition = new Vector3(0, 0, -2);
            Camera eyes = Camera.main;
            if (eyes == null)
            {
                eyes = new GameObject("Eyes", typeof(Camera)).GetComponent<Camera>();
                eyes.tag = "MainCamera";
            }
            eyes.transform.SetParent(rig.transform, false);
            eyes.transform.localPosition = new Vector3(0, EyeHeight, 0);
            eyes.transform.localRotation = Quaternion.Euler(25, 0, 0);
            eyes.gameObject.AddComponent<XrHead>();

            LineRenderer line = rig.AddComponent<LineRenderer>();
            Shader shader = Shader.Find("Sprites/Default"); // by default in every build
            if (shader != null)
            {
                _lineMaterial = new Material(shader);
                line.sharedMaterial = _lineMaterial;
            }
            line.widthMultiplier = 0.005f;
            line.positionCount = 2;
            line.startColor = Color.green;
            line.endColor = Color.green;

            XrTargetControl control = rig.AddComponent<XrTargetControl>();
            control.Driver = _driver;
            control.Rig = rig.transform;
            control.Head = eyes.transform;
            control.Line = line;
            if (_pointer != null)
            {
                control.Input = _pointer.GetComponent<IPointerInput>();
            }
            rig.SetActive(true);
        }

        private GameObject Text(string name, Vector3 position)
        {
            GameObject screen = New(name, transform);
            screen.transform.localPosition = position;
            TextMesh text = screen.AddComponent<TextMesh>();
            text.fontSize = 48; // the letters' resolution; their height comes from the next line
            text.characterSize = 0.015f;
            text.anchor = TextAnchor.UpperLeft;
            return screen;
        }

        private static GameObject Subscribe(GameObject holder, string topic, string type, float maxRate)
        {
            TopicSubscriber subscriber = holder.AddComponent<TopicSubscriber>();
            subscriber.Topic = topic;
            subscriber.Type = type;
            subscriber.MaxRate = maxRate;
            return holder;
        }

        /// <summary>
        /// An object that is not active yet, so that its components can be set up before they begin.
        /// </summary>
        private static GameObject New(string name, Transform parent)
        {
            GameObject made = new GameObject(name);
            made.SetActive(false);
            made.transform.SetParent(parent, false);
            return made;
        }

        private GameObject Part(
            PrimitiveType shape, string name, Transform parent, Vector3 position, Vector3 scale, Color color)
        {
            GameObject part = GameObject.CreatePrimitive(shape);
            part.name = name;
            part.transform.SetParent(parent, false);
            part.transform.localPosition = position;
            part.transform.localScale = scale;
            Renderer renderer = part.GetComponent<Renderer>();
            if (_material != null)
            {
                renderer.sharedMaterial = _material;
            }
            renderer.material.color = color;
            return part;
        }

        /// <summary>One points through it, at the floor.</summary>
        private static void Through(GameObject part)
        {
            part.GetComponent<Collider>().enabled = false;
        }
    }
}
