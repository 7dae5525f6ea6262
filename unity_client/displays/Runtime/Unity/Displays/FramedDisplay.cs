// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.StdMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// A display that stands where its messages' frame_id is, if there is a Fixed Frame above it. Without one it
    /// stays where its Transform is, which then is that frame.
    /// </summary>
    /// <remarks>
    /// It stands by the newest transform, not by that of the message's time. While none is known it is not drawn.
    /// </remarks>
    public abstract class FramedDisplay<T> : TypedDisplay<T>
        where T : class, IMessage, new()
    {
        [SerializeField]
        [Tooltip("Empty: the one above in the hierarchy. Without any, the Transform is the messages' frame")]
        private FixedFrame _fixedFrame;

        private readonly HiddenRenderers _renderers = new();
        private FixedFrame _found;

        /// <summary>In what it is placed. A change counts when the component is enabled the next time.</summary>
        public FixedFrame FixedFrame
        {
            get => _fixedFrame;
            set => _fixedFrame = value;
        }

        /// <summary>The frame of the newest message. Empty before the first.</summary>
        public string FrameId { get; private set; }

        /// <summary>Whether it is not drawn: nobody knows where its frame is, or it is outdated.</summary>
        public bool IsHidden => _renderers.IsHidden;

        /// <summary>Why it is not placed, or not again. Null while all is well.</summary>
        public string FrameProblem { get; private set; }

        /// <summary>Whether there is a Fixed Frame that it is placed in.</summary>
        protected bool HasFixedFrame => _found != null;

        /// <summary>Whether it is not drawn although its place is known, because it is too old.</summary>
        protected virtual bool IsOutdated => false;

        /// <summary>Its place in its frame: the origin. Asked for in each Update that places it.</summary>
        protected virtual Pose PoseInFrame() => Pose.identity;

        /// <inheritdoc/>
        protected override void OnEnable()
        {
            base.OnEnable();
            FrameId ??= ""; // the former drawing is still there, and stands in its frame
            FrameProblem = null;
            _found = FixedFrame.For(this, _fixedFrame);
        }

        /// <inheritdoc/>
        protected override void Update()
        {
            base.Update();
            bool isLost = _found != null && AgeSeconds < float.PositiveInfinity && !Stand();
            _renderers.Set(this, isLost || IsOutdated);
        }

        /// <inheritdoc/>
        protected override void OnDisable()
        {
            base.OnDisable();
            _renderers.Set(this, false);
        }

        /// <summary>Says in which frame what is drawn stands. Every Draw calls it.</summary>
        protected void StandIn(HeaderMsg header) => StandIn(header == null ? "" : header.frame_id);

        /// <summary>The same for what has no header.</summary>
        protected void StandIn(string frameId)
        {
            FrameId = frameId ?? "";
            _renderers.Set(this, false); // or what is drawn now would not be among what is hidden again
        }

        private bool Stand()
        {
            bool isKnown = _found.TryGetPose(FrameId, out Pose pose, out float age, out string problem);
            if (isKnown)
            {
                Pose within = PoseInFrame();
                _found.Place(
                    transform, new Pose(pose.position + pose.rotation * within.position, pose.rotation * within.rotation));
            }
            FrameProblem = problem;
            return isKnown;
        }
    }
}
