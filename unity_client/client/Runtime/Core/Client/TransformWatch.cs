// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;
using Ros2Gateway.Messages.GeometryMsgs;

namespace Ros2Gateway
{
    /// <summary>
    /// The pose of a frame in another, kept up to date by the gateway, which knows the tree of transforms. It
    /// survives reconnections and ends with <see cref="Dispose"/>. Members may be used on any thread.
    /// </summary>
    public sealed class TransformWatch : IDisposable
    {
        private const string NotKnown = "not known yet";

        private static readonly JsonMembers Frame = new("transform");

        private readonly object _gate = new();
        private readonly TransformWatches _owner;
        private readonly Clock _clock;
        private readonly RetryPause _pause = new();
        private readonly TransformStampedMsg _read = new(); // used again for every frame
        private Pose<Flu> _pose;
        private bool _isKnown;
        private bool _isStatic;
        private long _heardAt;
        private volatile string _problem = NotKnown;
        private string _refusal; // why the gateway does not look it up, as far as is known
        private bool _asksAgain; // it was refused, and not asked for since

        internal TransformWatch(
            TransformWatches owner, Clock clock, string id, string targetFrame, string sourceFrame, double rateHz)
        {
            _owner = owner;
            _clock = clock;
            Id = id;
            TargetFrame = targetFrame;
            SourceFrame = sourceFrame;
            RateHz = rateHz;
        }

        /// <summary>In which frame the pose is.</summary>
        public string TargetFrame { get; private set; }

        /// <summary>Of which frame the pose is.</summary>
        public string SourceFrame { get; private set; }

        /// <summary>How often it comes at most.</summary>
        public double RateHz { get; private set; }

        /// <summary>Why nothing, or nothing new, is known, in the gateway's words. Null while all is well.</summary>
        public string Problem => _problem;

        internal string Id { get; private set; }

        /// <summary>The newest pose. False if none has ever come.</summary>
        /// <param name="pose">Finite, its orientation of length 1.</param>
        /// <param name="ageSeconds">How long ago it came. 0 for a static one while there is a connection.</param>
        public bool TryGet(out Pose<Flu> pose, out double ageSeconds)
        {
            lock (_gate)
            {
                pose = _pose;
                bool isFixed = _isStatic && _problem == null;
                ageSeconds = isFixed ? 0 : (_clock.Now - _heardAt) / 1000.0;
                return _isKnown;
            }
        }

        /// <summary>Ends the watch.</summary>
        public void Dispose() => _owner.Remove(this);

        /// <summary>A frame with the transform has come. On the thread that reads frames.</summary>
        internal void OnFrame(JsonReader reader)
        {
            Pose<Flu> read = Read(reader, _read).transform.As<Flu>();
            Pose<Flu> pose = new(read.position, read.orientation.Normalized);
            bool isFinite = IsFinite(pose.position.x) && IsFinite(pose.position.y) && IsFinite(pose.position.z);
            lock (_gate)
            {
                if (!isFinite)
                {
                    _problem = "the transform is not finite";
                    return;
                }
                _pose = pose;
                _isKnown = true;
                _isStatic = _read.header.stamp.sec == 0 && _read.header.stamp.nanosec == 0;
                _heardAt = _clock.Now;
                _problem = null;
                Accept();
            }
        }

        /// <summary>It is looked up, but not known. Or the connection is lost, and nothing is refused any more.</summary>
        internal void OnProblem(string errorText)
        {
            lock (_gate)
            {
                Suffer(errorText);
                Accept();
            }
        }

        /// <summary>It is not looked up. Returns whether that is news.</summary>
        internal bool Refuse(string errorText, long now)
        {
            lock (_gate)
            {
                Suffer(errorText);
                bool isNews = _refusal != errorText;
                _refusal = errorText;
                _asksAgain = true;
                _pause.Begin(now);
                return isNews;
            }
        }

        /// <summary>Whether to ask for it again now. The caller does.</summary>
        internal bool AsksAgain(long now)
        {
            lock (_gate)
            {
                bool isDue = _asksAgain && _pause.IsOver(now);
                _asksAgain &= !isDue;
                return isDue;
            }
        }

        private void Suffer(string errorText)
        {
            if (_isStatic && _problem == null)
            {
                _heardAt = _clock.Now; // until now it was what it had been
            }
            _problem = errorText;
        }

        private void Accept()
        {
            _refusal = null;
            _asksAgain = false;
            _pause.Forget();
        }

        /// <summary>Reads the transform of a frame into a message.</summary>
        internal static TransformStampedMsg Read(JsonReader reader, TransformStampedMsg into)
        {
            int member = JsonMembers.Unknown;
            reader.BeginObject();
            while (reader.NextMember(Frame, ref member))
            {
                if (member == JsonMembers.Unknown)
                {
                    reader.Skip();
                }
                else
                {
                    into.Read(reader);
                }
            }
            return into;
        }

        private static bool IsFinite(double value) => !double.IsNaN(value) && !double.IsInfinity(value);
    }
}
