// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Drive;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Drives a robot by keys: a velocity while one is held, zero on release. The robot is told to stand, and
    /// held keys must be pressed again, when the window loses the focus, the application pauses, the component
    /// is disabled or STOP is pressed. While there is no connection nothing is published, and a new one
    /// resumes no motion. If the gateway has stopped the robot, or another client drives it, <see
    /// cref="Status"/> says so, and keys must be let go before it drives on.
    /// </summary>
    [AddComponentMenu("ROS 2 Gateway/Teleop Driver")]
    public sealed class TeleopDriver : ConnectedBehaviour
    {
        [SerializeField]
        private string _topic = "/cmd_vel";

        [SerializeField]
        [Tooltip("Ahead and back, in m/s. A TurtleBot3 Waffle Pi does 0.26")]
        [Range(0.01f, 2)]
        private float _linearSpeed = 0.26f;

        [SerializeField]
        [Tooltip("Turning, in rad/s. A TurtleBot3 Waffle Pi does 1.82")]
        [Range(0.01f, 6)]
        private float _angularSpeed = 1.82f;

        [SerializeField]
        [Tooltip("How often a held key is published, in Hz: robots stop after half a second of silence")]
        [Range(10, 20)]
        private float _rate = 15;

        [SerializeField]
        private ReasonEvent _onStatus = new();

        private readonly Listeners<string> _statusChanged;
        private readonly DriveStatus _status = new();
        private DriveOutput _output;
        private KeyDrive _keys;
        private IDriveInput _input;
        private bool _isUnfocused;
        private bool _isPaused;
        private bool _mayDrive; // as long as a key is held
        private int _changes; // of the connection, when keys were let go of last

        /// <summary>A component of the scene. Made by Unity.</summary>
        public TeleopDriver()
        {
            _statusChanged = new Listeners<string>(ReportFault, "listener of StatusChanged");
            _statusChanged.SetLast("listener of On Status", text => _onStatus.Invoke(text));
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

        /// <summary>The topic. A change takes effect when the component is enabled the next time.</summary>
        public string Topic
        {
            get => _topic;
            set => _topic = value;
        }

        /// <summary>m/s ahead and back. Like <see cref="Topic"/>.</summary>
        public float LinearSpeed
        {
            get => _linearSpeed;
            set => _linearSpeed = value;
        }

        /// <summary>rad/s of turning. Like <see cref="Topic"/>.</summary>
        public float AngularSpeed
        {
            get => _angularSpeed;
            set => _angularSpeed = value;
        }

        /// <summary>The source of keys. The arrow keys and space, unless it is set.</summary>
        public IDriveInput Input
        {
            get => _input ?? (_input = DriveInputs.Keyboard());
            set => _input = value;
        }

        /// <summary>
        /// Stops the robot, even if another client drives. Held keys must be
        /// pressed again. For a key, and for a button's list of what to call.
        /// </summary>
        public void Stop()
        {
            if (_output != null)
            {
                GatewayConnection connection = Connection;
                _output.Stop(); // first, for a listener of what is halted may disable this
                connection.Halt("stop was pressed");
            }
        }

        /// <inheritdoc/>
        protected internal override bool MovesRobots => true;

        /// <inheritdoc/>
        protected override void Bind(GatewayConnection connection)
        {
            try
            {
                _keys = new KeyDrive(_linearSpeed, _angularSpeed, _rate);
            }
            catch (ArgumentException error)
            {
                Debug.LogError("Teleop Driver on " + name + ": " + error.Message, this);
                return;
            }
            _output = new DriveOutput(connection, _topic);
            _changes = _output.Changes; // each output counts again
            connection.Halted += Halt;
            _isUnfocused = !Application.isFocused; // it may have come back while this was disabled
            _isPaused = false;
            LetGo(); // a key that is held already drives nothing
        }

        private void Update()
        {
            if (_output == null)
            {
                TellStatus(IsBound ? "" : DriveStatus.NoConnection);
                return;
            }
            _output.Tick();
            if (Input.StopPressed) // before anybody is told anything, and whatever is known of the robot
            {
                Stop();
            }
            if (_output != null) // a listener of another driver that gives up may disable this
            {
                TellStatus(_output.Status);
            }
            if (_output == null || !_output.IsConnected) // so may who is told
            {
                return;
            }
            if (_changes != _output.Changes)
            {
                _changes = _output.Changes;
                LetGo();
            }
            DriveCommand command = DriveCommand.Zero;
            bool isDue = !_isUnfocused && !_isPaused
                && _keys.Step(Input.Held, Time.unscaledTimeAsDouble, out command);
            bool isZero = command.Equals(DriveCommand.Zero);
            // A key that was pressed again may begin with the zero that a stopped robot waits for. One that was
            // held when it was stopped must be let go of.
            _mayDrive = !isZero && (_mayDrive || _output.LetGo());
            if (isDue && (isZero || _mayDrive))
            {
                _output.Send(command);
            }
            else if (isZero)
            {
                _output.Rest();
            }
        }

        // At once, in all three: Update may not be called again.
        private void OnApplicationFocus(bool hasFocus)
        {
            _isUnfocused = !hasFocus;
            LetGo();
        }

        private void OnApplicationPause(bool isPaused)
        {
            _isPaused = isPaused;
            LetGo();
        }

        private void OnApplicationQuit() => LetGo();

        /// <inheritdoc/>
        protected override void OnDisable()
        {
            base.OnDisable();
            TellStatus("");
        }

        /// <inheritdoc/>
        protected override void Unbind(GatewayConnection connection)
        {
            if (_output != null)
            {
                connection.Halted -= Halt;
                _output.Dispose();
                _output = null;
            }
        }

        private void TellStatus(string text)
        {
            if (_status.Take(text))
            {
                _statusChanged.Call(text);
            }
        }

        private void Halt(string reason) => LetGo();

        /// <summary>The robot stands, and what is held now counts again once it was released.</summary>
        private void LetGo()
        {
            if (_output == null)
            {
                return;
            }
            _output.Stand(); // first, for the input may be a class of the application's, which may throw anything
            double now = Time.unscaledTimeAsDouble;
            DriveKeys held = Input.Held;
            _keys.Step(held, now, out DriveCommand ignored);
            _keys.Release();
            _keys.Step(held, now, out ignored);
        }
    }
}
