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
    public sealed class TeleoperationScene : DemonstrationScene
    {
        [SerializeField]
        private string _scanTopic = "/scan";

        [SerializeField]
        private string _batteryTopic = "/battery_state";

        /// <inheritdoc/>
        protected override void Build()
        {
            BuildPlayer();
            BuildScreens();
            BuildRobot();
            BuildDriver();
        }

        private void BuildPlayer()
        {
            GameObject player = SceneParts.New("Player", transform);
            player.transform.localPosition = new Vector3(0, 0, -2);
            player.AddComponent<PlayerWalk>().Eyes = BuildEyes(player.transform, 1.6f, 0);
            player.SetActive(true);
        }

        private void BuildScreens()
        {
            BuildImageScreen(new Vector3(0, 2, 3));

            GameObject words = Text("Text Screen", new Vector3(-3, 2.6f, 3));
            SceneParts.Subscribe(words, OdometryTopic, "nav_msgs/msg/Odometry", 5).AddComponent<TextScreen>();
            words.SetActive(true);

            GameObject log = Text("Log Screen", new Vector3(1.2f, 2.6f, 3));
            log.AddComponent<LogScreen>();
            log.SetActive(true);

            GameObject battery = Text("Battery", new Vector3(-0.8f, 1.2f, 3));
            SceneParts.Subscribe(battery, _batteryTopic, "sensor_msgs/msg/BatteryState", 1);
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
            GameObject holder = SceneParts.New("Teleop Driver", transform);
            TeleopDriver driver = holder.AddComponent<TeleopDriver>();
            driver.Topic = CommandTopic;
            driver.StatusChanged += status => text.text = status;
            holder.SetActive(true);
        }

        private void BuildRobot()
        {
            GameObject twin = BuildTwin();
            Part(
                PrimitiveType.Cylinder, "Lidar", twin.transform,
                new Vector3(0, 0.15f, 0), new Vector3(0.08f, 0.02f, 0.08f), Color.black);
            GameObject scan = SceneParts.New("Scan", twin.transform);
            scan.transform.localPosition = new Vector3(0, 0.15f, 0);
            SceneParts.Subscribe(scan, _scanTopic, "sensor_msgs/msg/LaserScan").AddComponent<LaserScanDisplay>();
            scan.SetActive(true);
            twin.SetActive(true);
        }
    }
}
