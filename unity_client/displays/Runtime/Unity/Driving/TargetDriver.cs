// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Drive;
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.NavMsgs;
using UnityEngine;
using UnityEngine.Events;

namespace Ros2Gateway.Unity
{
    /// <summary>Words, for the Inspector's lists of what to call.</summary>
    [Serializable]
    public sealed class ReasonEvent : UnityEvent<string>
    {
    }

    /// <summary>
    /// Drives a robot to a point of the scene by its odometry: it turns, then drives, as
    /// <see cref="DriveToTarget"/> says. It drops the target and stops the robot when the window
    /// loses the focus, the application pauses or the component is disabled. So it does when the connection is lost
    /// or the gateway refuses to drive on. A new connection resumes nothing. A new target lets a robot that was stopped drive
    /// again.
    /// </summary>
    [AddComponentMenu("ROS 2 Gateway/Target Driver")]
    public sealed class TargetDriver : ConnectedBehaviour
    {
        // A robot that was stopped may drive again 0.25 s after a zero. A longer wait has other reasons.
        private const double LetGoSeconds = 2;

        [SerializeField]
        [Tooltip("The command topic, of Twist or TwistStamped, as the robot needs it")]
        private string _topic = "/cmd_vel";

        [SerializeField]
        [Tooltip("The topic of the poses, of nav_msgs/msg/Odometry")]
        private string _odometryTopic = "/odom";

        [SerializeField]
        [Tooltip("A subscriber of the odometry that the scene has already. Empty: a separate one")]
        private TopicSubscriber _odometry;

        [SerializeField]
        [Tooltip("The origin of the odometry's frame: the digital twin's parent. Empty: the world's origin")]
        private Transform _origin;

        [SerializeField]
        [Tooltip("Marks the target, and is hidden without one")]
        private Transform _marker;

        [SerializeField]
        [Tooltip("Commands per second, in Hz")]
        [Range(10, 50)]
        private float _rate = 20;

        [SerializeField]
        [Tooltip("Off for a headset whose desktop window is in the background")]
        private bool _stopsWithoutFocus = true;

        [SerializeField]
        private DriveSettings _settings = new();

        [SerializeField]
        private UnityEvent _onReached = new();

        [SerializeField]
        private ReasonEvent _onFailed = new();

        [SerializeField]
        private ReasonEvent _onStatus = new();

        private readonly Listeners<TargetDriver> _reached;
        private readonly Listeners<string> _failed;
        private readonly Listeners<string> _statusChanged;
        private readonly DriveStatus _status = new();
        private DriveOutput _output;
        private DriveToTarget _drive;
        private Subscription<OdometryMsg> _subscription;
        private PlanarPose _pose;
        private double _poseTime = double.NaN;
        private double _next;
        private double _begins; // when the target was set. NaN once it is driven to
        private int _changes; // of the connection, when the target was set
        private Vector3 _place; // of the target, in the world

        /// <summary>A component of the scene. Made by Unity.</summary>
        public TargetDriver()
        {
            _reached = new Listeners<TargetDriver>(ReportFault, "listener of Reached");
            _reached.SetLast("listener of On Reached", driver => _onReached.Invoke());
            _failed = new Listeners<string>(ReportFault, "listener of Failed");
            _failed.SetLast("listener of On Failed", reason => _onFailed.Invoke(reason));
            _statusChanged = new Listeners<string>(ReportFault, "listener of StatusChanged");
            _statusChanged.SetLast("listener of On Status", text => _onStatus.Invoke(text));
        }

        /// <summary>The target was reached, and the robot told to stand.</summary>
        public event Action Reached
        {
            add => _reached.Add(value);
            remove => _reached.Remove(value);
        }

        /// <summary>The target was given up, and why: also by <see cref="Stop"/> with its reason.</summary>
        public event Action<string> Failed
        {
            add => _failed.Add(value);
            remove => _failed.Remove(value);
        }

        /// <summary><see cref="Status"/> is another.</summary>
        public event Action<string> StatusChanged
        {
            add => _statusChanged.Add(value);
            remove => _statusChanged.Remove(value);
        }

        /// <summary>Called with <see cref="Status"/> when it is another, from the Inspector's list.</summary>
        public ReasonEvent OnStatus => _onStatus;

        /// <summary>
        /// The state in words for people: who drives, what stopped the robot, and what to do about it. As of the last frame.
        /// </summary>
        public string Status => _status.Text;

        /// <summary>The same for programs. Null while the component is disabled.</summary>
        public ControlState Control => _output == null ? null : _output.Control;

        /// <summary>
        /// The published type, geometry_msgs/msg/Twist or TwistStamped, as the gateway reports it. Null
        /// before it is known, and until then nothing moves.
        /// </summary>
        public string CommandType => _output == null ? null : _output.Type;

        /// <summary>
        /// Where commands go. A change takes effect when the component is enabled the next time.
        /// </summary>
        public string Topic
        {
            get => _topic;
            set => _topic = value;
        }

        /// <summary>The topic of the poses. Like <see cref="Topic"/>.</summary>
        public string OdometryTopic
        {
            get => _odometryTopic;
            set => _odometryTopic = value;
        }

        /// <summary>
        /// A subscriber of the odometry to share. Null for a separate one. Like <see cref="Topic"/>.
        /// </summary>
        public TopicSubscriber Odometry
        {
            get => _odometry;
            set => _odometry = value;
        }

        /// <summary>The place of the odometry's frame in the scene. Null for the world's origin.</summary>
        public Transform Origin
        {
            get => _origin;
            set => _origin = value;
        }

        /// <summary>Marks the target, and is hidden without one. May be null.</summary>
        public Transform Marker
        {
            get => _marker;
            set => _marker = value;
        }

        /// <summary>
        /// Whether a window without focus stops the robot. Off for a headset whose desktop window is in the
        /// background.
        /// </summary>
        public bool StopsWithoutFocus
        {
            get => _stopsWithoutFocus;
            set => _stopsWithoutFocus = value;
        }

        /// <summary>The limits of the robot. Like <see cref="Topic"/>.</summary>
        public DriveSettings Settings
        {
            get => _settings;
            set => _settings = value;
        }

        /// <summary>Called when a target was reached, from the Inspector's list.</summary>
        public UnityEvent OnReached => _onReached;

        /// <summary>Called with the reason when a target was given up, from the Inspector's list.</summary>
        public ReasonEvent OnFailed => _onFailed;

        /// <summary>The present activity.</summary>
        public DriveState State => _drive == null ? DriveState.Idle : _drive.State;

        /// <summary>Why it waits, or gave up, in words. Empty otherwise.</summary>
        public string Reason => _drive == null ? "" : _drive.Reason;

        /// <summary>Metres from the robot to the target. NaN before the first pose.</summary>
        public double Distance => _drive == null ? double.NaN : _drive.Distance;

        /// <summary>
        /// Drives to a point of the scene, and ignores its height. It replaces the former target.
        /// False, and nothing happens, while there is no connection, no robot is known that takes commands, or the
        /// component is disabled. False also for a point that is not finite.
        /// </summary>
        public bool SetTarget(Vector3 worldPosition)
        {
            if (_output == null || !_output.IsConnected)
            {
                return false;
            }
            Vector3 local = _origin == null ? worldPosition : _origin.InverseTransformPoint(worldPosition);
            Vector3<Flu> target = local.FromUnity<Flu>();
            _drive.SetTarget(target.x, target.y, Time.unscaledTimeAsDouble);
            if (!_drive.IsActive)
            {
                End();
                return false;
            }
            _changes = _output.Changes;
            _begins = Time.unscaledTimeAsDouble;
            _next = 0;
            _place = worldPosition;
            ShowMarker();
            return true;
        }

        /// <summary>
        /// Stops the robot, even if another client drives, and takes the
        /// target away.
        /// </summary>
        public void Stop(string reason)
        {
            if (_output != null)
            {
                GatewayConnection connection = Connection;
                _output.Stop(); // first, for who hears that the target is given up may disable this
                connection.Halt(reason);
            }
        }

        /// <summary>
        /// Takes the target away, and lets the robot stand if a driver of this connection drove it. A robot that another
        /// client does goes on.
        /// </summary>
        public void Abandon(string reason)
        {
            if (_output != null)
            {
                GatewayConnection connection = Connection;
                if (_output.Control.Holder != ControlHolder.Other)
                {
                    _output.Send(DriveCommand.Zero); // first, as in Stop
                }
                connection.Halt(reason);
            }
        }

        /// <inheritdoc/>
        protected override void OnEnable()
        {
            MessageCatalogue.Register<OdometryMsg>(); // for the subscriber
            ShowMarker();
            base.OnEnable();
        }

        /// <inheritdoc/>
        protected internal override bool MovesRobots => true;

        /// <inheritdoc/>
        protected override void Bind(GatewayConnection connection)
        {
            try
            {
                _drive = new DriveToTarget(_settings);
            }
            catch (ArgumentException error)
            {
                Debug.LogError("Target Driver on " + name + ": " + error.Message, this);
                return;
            }
            _poseTime = double.NaN;
            _output = new DriveOutput(connection, _topic);
            connection.Halted += GiveUp;
            if (_odometry != null)
            {
                _odometry.MessageReceived += TakeAny;
            }
            else
            {
                _subscription = connection.Client.Subscribe<OdometryMsg>(
                    _odometryTopic, Take, new SubscribeOptions { Queue = 1 }); // the present place, not a former one
            }
        }

        private void Update()
        {
            if (_output == null)
            {
                TellStatus(IsBound ? "" : DriveStatus.NoConnection);
                return;
            }
            _output.Tick();
            if (!_output.IsConnected || _changes != _output.Changes)
            {
                GiveUp(_output.Missing ?? "connection lost");
            }
            if (_output != null) // a listener may disable this
            {
                TellStatus(_output.Status);
            }
            if (_output == null)
            {
                return;
            }
            double now = Time.unscaledTimeAsDouble;
            if (!_drive.IsActive)
            {
                _output.Stand(); // after a connection was lost
                _output.Rest();
            }
            else if (now >= _next && MayDrive(now))
            {
                _next = now + 1.0 / _rate;
                Step(now);
            }
        }

        // At once, in all three: Update may not be called again.
        private void OnApplicationFocus(bool hasFocus)
        {
            if (!hasFocus && _stopsWithoutFocus)
            {
                GiveUp("the window lost the focus");
            }
        }

        private void OnApplicationPause(bool isPaused)
        {
            if (isPaused)
            {
                GiveUp("the application was paused");
            }
        }

        private void OnApplicationQuit() => GiveUp("the application ends");

        /// <inheritdoc/>
        protected override void OnDisable()
        {
            bool isGivenUp = Stand("the Target Driver was disabled");
            base.OnDisable();
            if (isGivenUp)
            {
                End();
            }
            TellStatus("");
        }

        /// <inheritdoc/>
        protected override void Unbind(GatewayConnection connection)
        {
            bool isGivenUp = Stand("its connection was lost");
            if (_odometry != null)
            {
                _odometry.MessageReceived -= TakeAny;
            }
            if (_subscription != null)
            {
                _subscription.Dispose();
                _subscription = null;
            }
            if (_output != null)
            {
                connection.Halted -= GiveUp;
                _output.Dispose();
                _output = null;
            }
            if (isGivenUp)
            {
                End(); // last, for who is told may do anything
            }
        }

        private void OnDrawGizmos()
        {
            if (_drive != null && _drive.IsActive)
            {
                Gizmos.color = Color.green;
                Gizmos.DrawWireSphere(_place, 0.1f);
            }
        }

        /// <summary>Whether the robot that was stopped may drive to a new target already.</summary>
        private bool MayDrive(double now)
        {
            if (double.IsNaN(_begins))
            {
                return true;
            }
            if (_output.LetGo())
            {
                _begins = double.NaN;
                return true;
            }
            if (now - _begins > LetGoSeconds || _output.Control.Holder == ControlHolder.Other)
            {
                GiveUp(_output.Refusal ?? "the robot stays stopped");
            }
            return false;
        }

        private void TellStatus(string text)
        {
            if (_status.Take(text))
            {
                _statusChanged.Call(text);
            }
        }

        private void Step(double now)
        {
            DriveCommand command = _drive.Step(_pose, _poseTime, now);
            bool isSent = _output.Send(command);
            if (!_drive.IsActive)
            {
                End();
            }
            else if (!isSent)
            {
                GiveUp(_output.Refusal ?? "the command could not be published");
            }
        }

        private void GiveUp(string reason)
        {
            if (Stand(reason))
            {
                End();
            }
        }

        /// <summary>The robot stands, without a target. Returns whether it had one, whose end is to be told.</summary>
        private bool Stand(string reason)
        {
            if (_drive == null || !_drive.IsActive)
            {
                return false;
            }
            _drive.Stop(reason);
            _output.Stand();
            return true;
        }

        /// <summary>Tells how the target ended.</summary>
        private void End()
        {
            ShowMarker();
            if (_drive.State == DriveState.Done)
            {
                _reached.Call(this);
            }
            else
            {
                _failed.Call(_drive.Reason);
            }
        }

        private void ShowMarker()
        {
            if (_marker != null)
            {
                _marker.position = _place;
                _marker.gameObject.SetActive(_drive != null && _drive.IsActive);
            }
        }

        private void TakeAny(IMessage message)
        {
            OdometryMsg odometry = message as OdometryMsg;
            if (odometry != null)
            {
                Take(odometry);
            }
        }

        private void Take(OdometryMsg odometry)
        {
            _pose = new PlanarPose(odometry.pose.pose.As<Flu>());
            _poseTime = Time.unscaledTimeAsDouble;
        }
    }
}
