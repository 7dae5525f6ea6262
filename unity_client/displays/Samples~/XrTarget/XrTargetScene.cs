// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEngine;

namespace Ros2Gateway.Samples.XrTarget
{
    /// <summary>
    /// Builds the demonstration in an empty scene: a floor to point at, a user's rig, a robot's digital twin
    /// and its target. Works with a headset, and with the mouse without one.
    /// </summary>
    public sealed class XrTargetScene : DemonstrationScene
    {
        private const float EyeHeight = 1.6f; // m, until a headset says otherwise

        [SerializeField]
        [Tooltip("Whether a window without focus stops the robot. Off for a headset whose desktop window is in the background")]
        private bool _stopsWithoutFocus = true;

        [SerializeField]
        [Tooltip("An object with a component that points, such as Xr Action Input. Empty: a headset's controllers or the mouse")]
        private GameObject _pointer;

        private Material _lineMaterial;
        private TargetDriver _driver;
        private TextMesh _state;

        /// <inheritdoc/>
        protected override void Build()
        {
            BuildScreens();
            BuildRobot();
            BuildUser();
        }

        /// <inheritdoc/>
        protected override void OnDestroy()
        {
            base.OnDestroy();
            if (_lineMaterial != null)
            {
                Destroy(_lineMaterial);
            }
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

        private void BuildScreens()
        {
            BuildImageScreen(new Vector3(0, 2, 4));

            GameObject hud = Text("Connection HUD", new Vector3(-2.5f, 2.6f, 4));
            hud.AddComponent<ConnectionHud>();
            hud.SetActive(true);
            GameObject state = Text("Drive's State", new Vector3(-2.5f, 1.2f, 4));
            _state = state.GetComponent<TextMesh>();
            state.SetActive(true);
        }

        private void BuildRobot()
        {
            GameObject twin = BuildTwin();
            foreach (Collider part in twin.GetComponentsInChildren<Collider>(true))
            {
                part.enabled = false; // one points through it, at the floor
            }
            twin.SetActive(true);

            GameObject marker = Part(
                PrimitiveType.Cylinder, "Target", transform,
                Vector3.zero, new Vector3(0.2f, 0.005f, 0.2f), Color.green);
            marker.GetComponent<Collider>().enabled = false;
            GameObject driver = SceneParts.New("Target Driver", transform);
            _driver = driver.AddComponent<TargetDriver>();
            _driver.Topic = CommandTopic;
            _driver.StopsWithoutFocus = _stopsWithoutFocus;
            _driver.Odometry = twin.GetComponent<TopicSubscriber>();
            _driver.Origin = twin.transform.parent;
            _driver.Marker = marker.transform;
            driver.SetActive(true);
        }

        private void BuildUser()
        {
            GameObject rig = SceneParts.New("Rig", transform);
            rig.transform.localPosition = new Vector3(0, 0, -2);
            Transform eyes = BuildEyes(rig.transform, EyeHeight, 25);
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
            control.Head = eyes;
            control.Line = line;
            if (_pointer != null)
            {
                control.Input = _pointer.GetComponent<IPointerInput>();
            }
            rig.SetActive(true);
        }
    }
}
