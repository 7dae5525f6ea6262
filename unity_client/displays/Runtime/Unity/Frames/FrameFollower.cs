// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Follows a ROS frame, such as base_link, in a Fixed Frame, and says in a text next to or below it how old
    /// the pose is.
    /// </summary>
    [AddComponentMenu("ROS 2 Gateway/Frame Follower")]
    [DefaultExecutionOrder(-800)] // before the displays on it
    public sealed class FrameFollower : MonoBehaviour
    {
        private const float TextSeconds = 0.2f; // nobody reads faster

        [SerializeField]
        [Tooltip("Empty: the one above in the hierarchy")]
        private FixedFrame _fixedFrame;

        [SerializeField]
        private string _frame = "base_link";

        [SerializeField]
        [Tooltip("It is hidden when the pose is older than this, in seconds. 0 for never")]
        private float _hideAfter;

        [SerializeField]
        private TextOutput _output = new();

        private readonly HiddenRenderers _renderers = new();
        private FixedFrame _found;
        private float _nextText;

        /// <summary>The frame that is followed. A change counts at once.</summary>
        public string Frame
        {
            get => _frame;
            set => _frame = value;
        }

        /// <summary>In what it is followed. A change counts when the component is enabled the next time.</summary>
        public FixedFrame FixedFrame
        {
            get => _fixedFrame;
            set => _fixedFrame = value;
        }

        /// <summary>When the pose is older it is not drawn, in seconds. 0 for never.</summary>
        public float HideAfter
        {
            get => _hideAfter;
            set => _hideAfter = value;
        }

        /// <summary>The text.</summary>
        public TextOutput Output => _output;

        /// <summary>How long ago the pose came, in seconds. Infinite before the first.</summary>
        public float AgeSeconds { get; private set; }

        /// <summary>Why nothing, or nothing new, is known of the frame. Null while all is well.</summary>
        public string Problem { get; private set; }

        /// <summary>Whether it is not drawn, because the pose is too old or not known yet.</summary>
        public bool IsHidden => _renderers.IsHidden;

        private void OnEnable()
        {
            AgeSeconds = float.PositiveInfinity;
            _nextText = 0;
            _output.Find(this, false);
            _found = FixedFrame.For(this, _fixedFrame);
            if (_found == null)
            {
                Problem = "no Fixed Frame: put this below one";
                Debug.LogWarning("FrameFollower on " + name + ": " + Problem, this);
            }
        }

        private void Update()
        {
            if (_found != null)
            {
                Follow();
            }
            _renderers.Set(this, _hideAfter > 0 && AgeSeconds > _hideAfter);
            if (Time.unscaledTime >= _nextText)
            {
                _nextText = Time.unscaledTime + TextSeconds;
                _output.Show(Text());
            }
        }

        private void OnDisable() => _renderers.Set(this, false);

        private void Follow()
        {
            if (_found.TryGetPose(_frame, out Pose pose, out float age, out string problem))
            {
                _found.Place(transform, pose);
                AgeSeconds = age;
            }
            else
            {
                AgeSeconds = float.PositiveInfinity;
            }
            Problem = problem;
        }

        private string Text()
        {
            string what = _found == null ? _frame : _frame + " in " + _found.Frame;
            if (Problem != null)
            {
                return what + ": " + Problem;
            }
            return what + ", " + AgeSeconds.ToString("0.0", System.Globalization.CultureInfo.InvariantCulture) + " s old";
        }
    }
}
