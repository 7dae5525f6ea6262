// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEngine;

namespace Ros2Gateway.Samples.Teleoperation
{
    /// <summary>
    /// Builds the demonstration in an empty scene: a room, a player, a robot's digital twin, screens with its
    /// camera, battery, messages, log and who drives. Arrow keys drive the robot, space stops it, WASD and the mouse move
    /// the player.
    /// </summary>
    public sealed class TeleoperationScene : MonoBehaviour
    {
        private static readonly Color FloorColor = new Color(0.35f, 0.37f, 0.4f);

        [SerializeField]
        [Tooltip("Where the gateway is, unless the scene has a Gateway Connection")]
        private string _address = "ws://localhost:9090";

        [SerializeField]
        private string _imageTopic = "/camera/image_raw";

        [SerializeField]
        private string _odometryTopic = "/odom";

        [SerializeField]
        private string _scanTopic = "/scan";

        [SerializeField]
        private string _batteryTopic = "/battery_state";

        [SerializeField]
        private string _commandTopic = "/cmd_vel";

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
            BuildPlayer();
            BuildScreens();
            BuildTwin();
            BuildDriver();
        }

        private void OnDestroy()
        {
            if (_settings != null)
            {
                Destroy(_settings);
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
        }

        private void BuildPlayer()
        {
            GameObject player = New("Player", transform);
            player.transform.localPosition = new Vector3(0, 0, -2);
            Camera eyes = Camera.main;
            if (eyes == null)
            {
                eyes = new GameObject("Eyes", typeof(Camera)).GetComponent<Camera>();
                eyes.tag = "MainCamera";
            }
            eyes.transform.SetParent(player.transform, false);
            eyes.transform.localPosition = new Vector3(0, 1.6f, 0);
            eyes.transform.localRotation = Quaternion.identity;
            player.AddComponent<PlayerWalk>().Eyes = eyes.transform;
            player.SetActive(true);
        }

        private void BuildScreens()
        {
            GameObject picture = Part(
                PrimitiveType.Quad, "Image Screen", transform,
                new Vector3(0, 2, 3), new Vector3(1.6f, 1.2f, 1), Color.white);
            picture.SetActive(false);
            Subscribe(picture, _imageTopic, "sensor_msgs/msg/Image", 15).AddComponent<ImageScreen>();
            picture.SetActive(true);

            GameObject words = Text("Text Screen", new Vector3(-3, 2.6f, 3));
            Subscribe(words, _odometryTopic, "nav_msgs/msg/Odometry", 5).AddComponent<TextScreen>();
            words.SetActive(true);

            GameObject log = Text("Log Screen", new Vector3(1.2f, 2.6f, 3));
            log.AddComponent<LogScreen>();
            log.SetActive(true);

            GameObject battery = Text("Battery", new Vector3(-0.8f, 1.2f, 3));
            Subscribe(battery, _batteryTopic, "sensor_msgs/msg/BatteryState", 1);
            battery.AddComponent<BatteryDisplay>();
            battery.SetActive(true);

            GameObject hud = Text("Connection HUD", new Vector3(0, 1.2f, 3));
            hud.AddComponent<ConnectionHud>();
            hud.SetActive(true);
        }

        private void BuildDriver()
        {
            GameObject words = Text("Drive's State", new Vector3(1.2f, 1.2f, 3));
            TextMesh text = words.GetComponent<TextMesh>();
            words.SetActive(true);
            GameObject holder = New("Teleop Driver", transform);
            TeleopDriver driver = holder.AddComponent<TeleopDriver>();
            driver.Topic = _commandTopic;
            driver.StatusChanged += status => text.text = status;
            holder.SetActive(true);
        }

        private void BuildTwin()
        {
            // what the twin's poses are relative to
            Transform origin = New("Odometry's Origin", transform).transform;
            origin.gameObject.SetActive(true);
            GameObject twin = New("Digital Twin", origin);
            Subscribe(twin, _odometryTopic, "nav_msgs/msg/Odometry", 0).AddComponent<DigitalTwin>();
            Part(
                PrimitiveType.Cylinder, "Body", twin.transform,
                new Vector3(0, 0.08f, 0), new Vector3(0.28f, 0.05f, 0.28f), new Color(0.2f, 0.2f, 0.22f));
            Part(
                PrimitiveType.Cylinder, "Lidar", twin.transform,
                new Vector3(0, 0.15f, 0), new Vector3(0.08f, 0.02f, 0.08f), Color.black);
            Part(
                PrimitiveType.Cube, "Nose", twin.transform,
                new Vector3(0, 0.1f, 0.12f), new Vector3(0.05f, 0.03f, 0.05f), Color.yellow);
            GameObject scan = New("Scan", twin.transform);
            scan.transform.localPosition = new Vector3(0, 0.15f, 0);
            Subscribe(scan, _scanTopic, "sensor_msgs/msg/LaserScan", 0).AddComponent<LaserScanDisplay>();
            scan.SetActive(true);
            twin.SetActive(true);
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
    }
}
