// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEditor;

namespace Ros2Gateway.Editor
{
    /// <summary>Of Topic Subscribers. An empty type takes what the topic has.</summary>
    [CanEditMultipleObjects]
    [CustomEditor(typeof(TopicSubscriber))]
    public sealed class TopicSubscriberInspector : TopicInspector
    {
        /// <inheritdoc/>
        protected override bool TypeMayBeEmpty => true;
    }
}
