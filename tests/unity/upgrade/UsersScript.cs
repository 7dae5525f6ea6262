// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway;
using Ros2Gateway.Json;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Pictures;
using Ros2Gateway.Robots;
using Ros2Gateway.Shapes;
using Ros2Gateway.Thesis;
using Ros2Gateway.Unity;
using UnityEngine;

/// <summary>A script of a project that had the single package.</summary>
public sealed class UsersScript : ConnectedBehaviour
{
    [SerializeField]
    private ImageScreen _screen;

    [SerializeField]
    private RobotDescriptionDisplay _robot;

    private Subscription<LaserScanMsg> _scans;

    private void Start()
    {
        Ros2Library.ros2_init("users");
        RobotDescription robot = UrdfReader.Read("<robot name='r'><link name='base'/></robot>");
        MeshBuffer mesh = new MeshBuffer();
        PictureMsg picture = new PictureMsg();
        JsonValue tree = JsonValue.Parse("{}");
        Debug.Log(_screen.name + _robot.name + robot + mesh + picture + tree);
    }

    protected override void Bind(GatewayConnection connection)
    {
        _scans = connection.Client.Subscribe<LaserScanMsg>("/scan", scan => Debug.Log(scan.ranges.Length));
        GetComponent<TopicPublisher>().PublishTexture(Texture2D.whiteTexture);
    }

    protected override void Unbind(GatewayConnection connection)
    {
        _scans.Dispose();
    }
}
