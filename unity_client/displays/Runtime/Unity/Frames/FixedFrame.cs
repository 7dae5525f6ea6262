// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// The Transform is the origin of a ROS frame, such as map. Its children in the hierarchy are placed by the
    /// transforms that the robot publishes.
    /// </summary>
    [AddComponentMenu("ROS 2 Gateway/Fixed Frame")]
    [DefaultExecutionOrder(-900)] // after the connection, before what asks it for poses
    [DisallowMultipleComponent]
    public sealed class FixedFrame : ConnectedBehaviour
    {
        private const int MaxFrames = 16; // as many as a gateway looks up for a client by default
        private const float IdleSeconds = 10; // a frame that nobody has asked for so long makes room

        [SerializeField]
        [Tooltip("The frame whose origin this is. A change takes effect when you enable the component again")]
        private string _frame = "map";

        [SerializeField]
        [Tooltip("How often poses may come, in Hz")]
        [Range(1, 200)]
        private float _rate = 30;

        private readonly Dictionary<string, Entry> _entries = new();
        private string _fixed = "";
        private GatewayClient _client;

        /// <summary>The frame whose origin this is. A change takes effect when it is enabled the next time.</summary>
        public string Frame
        {
            get => _frame;
            set => _frame = value;
        }

        /// <summary>How often poses may come, in Hz. Like <see cref="Frame"/>.</summary>
        public float Rate
        {
            get => _rate;
            set => _rate = value;
        }

        /// <summary>The fixed frame that a component uses: its own choice, else the one above it, else null.</summary>
        public static FixedFrame For(Component component, FixedFrame chosen) =>
            chosen != null ? chosen : component.GetComponentInParent<FixedFrame>();

        /// <summary>The newest known pose of a frame, in the axes of this Transform.</summary>
        /// <param name="age">How long ago it came, in seconds. 0 for what does not move.</param>
        /// <param name="problem">Why nothing, or nothing new, is known. Null while all is well.</param>
        /// <returns>Whether there is a pose. It is watched from the first question on.</returns>
        public bool TryGetPose(string frame, out Pose pose, out float age, out string problem)
        {
            pose = Pose.identity;
            age = 0;
            problem = null;
            string name = Plain(frame);
            if (name == _fixed && name.Length > 0)
            {
                return true;
            }
            TransformWatch watch = Watch(name, out problem);
            if (watch == null)
            {
                return false;
            }
            Pose<Flu> known;
            double seconds;
            problem = watch.Problem;
            if (!watch.TryGet(out known, out seconds))
            {
                return false;
            }
            pose = known.ToUnity();
            age = (float)seconds;
            return true;
        }

        /// <summary>Puts a Transform to a pose that is given in the axes of this one.</summary>
        public void Place(Transform what, Pose pose) => what.SetPositionAndRotation(
            transform.TransformPoint(pose.position), transform.rotation * pose.rotation);

        /// <summary>The pose of a Transform in this frame, in ROS' axes.</summary>
        public Pose<Flu> PoseOf(Transform what)
        {
            Pose pose = new(
                transform.InverseTransformPoint(what.position), Quaternion.Inverse(transform.rotation) * what.rotation);
            return pose.FromUnity<Flu>();
        }

        /// <inheritdoc/>
        protected override void OnEnable()
        {
            _fixed = Plain(_frame);
            base.OnEnable();
        }

        /// <inheritdoc/>
        protected override void Bind(GatewayConnection connection) => _client = connection.Client;

        /// <inheritdoc/>
        protected override void Unbind(GatewayConnection connection)
        {
            foreach (Entry entry in _entries.Values)
            {
                entry.Watch.Dispose();
            }
            _entries.Clear();
            _client = null;
        }

        private TransformWatch Watch(string frame, out string problem)
        {
            Entry entry;
            problem = null;
            if (_entries.TryGetValue(frame, out entry))
            {
                entry.UsedAt = Time.unscaledTime;
                return entry.Watch;
            }
            if (frame.Length == 0 || _fixed.Length == 0)
            {
                problem = frame.Length == 0 ? "frame_id is empty" : "the Fixed Frame " + name + " has no frame";
                return null;
            }
            if (_client == null)
            {
                problem = "the Fixed Frame " + name + " is disabled, or has no Gateway Connection";
                return null;
            }
            if (_entries.Count >= MaxFrames && !ForgetIdle())
            {
                problem = "at most " + MaxFrames + " frames below one Fixed Frame";
                return null;
            }
            entry = new Entry(_client.WatchTransform(_fixed, frame, _rate), Time.unscaledTime);
            _entries[frame] = entry;
            return entry.Watch;
        }

        // Others of this client may wait for the room. By now all have asked, also after a long frame.
        private void LateUpdate() => ForgetIdle();

        private bool ForgetIdle()
        {
            string oldest = null;
            float since = Time.unscaledTime - IdleSeconds;
            foreach (KeyValuePair<string, Entry> entry in _entries)
            {
                if (entry.Value.UsedAt < since)
                {
                    since = entry.Value.UsedAt;
                    oldest = entry.Key;
                }
            }
            if (oldest == null)
            {
                return false;
            }
            _entries[oldest].Watch.Dispose();
            return _entries.Remove(oldest);
        }

        // ROS 1 wrote frames with a leading slash, and some publishers still do.
        private static string Plain(string frame)
        {
            string name = frame ?? "";
            return name.StartsWith("/", System.StringComparison.Ordinal) ? name.Substring(1) : name;
        }

        private sealed class Entry
        {
            internal readonly TransformWatch Watch;
            internal float UsedAt;

            internal Entry(TransformWatch watch, float usedAt)
            {
                Watch = watch;
                UsedAt = usedAt;
            }
        }
    }
}
