// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEditor;

namespace Ros2Gateway.Editor
{
    /// <summary>Of Topic Publishers, which need a type.</summary>
    [CanEditMultipleObjects]
    [CustomEditor(typeof(TopicPublisher))]
    public sealed class TopicPublisherInspector : TopicInspector
    {
        /// <inheritdoc/>
        protected override bool TypeMayBeEmpty
        {
            get { return false; }
        }
    }
}
