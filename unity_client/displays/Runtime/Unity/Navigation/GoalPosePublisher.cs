// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.GeometryMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Publishes where something is as a goal, on /goal_pose: as RViz' "2D Goal Pose" does. To know
    /// how it ends takes a Navigate To Pose.
    /// </summary>
    [AddComponentMenu("ROS 2 Gateway/Goal Pose Publisher")]
    public sealed class GoalPosePublisher : ConnectedBehaviour
    {
        [SerializeField]
        private string _topic = "/goal_pose";

        [SerializeField]
        [Tooltip("Empty: the one above in the hierarchy")]
        private FixedFrame _fixedFrame;

        [SerializeField]
        [Tooltip("Without a Fixed Frame: the frame whose origin is that of the scene")]
        private string _frame = "map";

        private Publisher<PoseStampedMsg> _publisher;

        /// <summary>The topic. A change takes effect when the component is enabled the next time.</summary>
        public string Topic
        {
            get => _topic;
            set => _topic = value;
        }

        /// <summary>In what the goal is given. Null for the one above.</summary>
        public FixedFrame FixedFrame
        {
            get => _fixedFrame;
            set => _fixedFrame = value;
        }

        /// <summary>Without a Fixed Frame: the frame whose origin is that of the scene.</summary>
        public string Frame
        {
            get => _frame;
            set => _frame = value;
        }

        /// <summary>Makes the place of this object the goal. For a button.</summary>
        public void Publish() => Publish(transform);

        /// <summary>Makes a place the goal. Its forward is the heading, height and tilt do not count.</summary>
        /// <returns>Whether it was sent. If not, the console or the connection's events say why.</returns>
        public bool Publish(Transform place)
        {
            if (_publisher == null)
            {
                Debug.LogWarning(
                    "Goal Pose Publisher on " + name + ": no goal is sent: "
                    + (isActiveAndEnabled ? "no Gateway Connection" : "this component is disabled"), this);
                return false;
            }
            return _publisher.Publish(GoalPoses.Of(place, FixedFrame.For(this, _fixedFrame), _frame));
        }

        /// <inheritdoc/>
        protected internal override bool MovesRobots => true;

        /// <inheritdoc/>
        protected override void Bind(GatewayConnection connection) =>
            _publisher = connection.Client.Advertise<PoseStampedMsg>(_topic);

        /// <inheritdoc/>
        protected override void Unbind(GatewayConnection connection)
        {
            _publisher.Dispose();
            _publisher = null;
        }
    }
}
