// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// A display of one type, whose class it makes known to its subscriber.
    /// </summary>
    public abstract class TypedDisplay<T> : TopicDisplay<T>
        where T : class, IMessage, new()
    {
        /// <inheritdoc/>
        protected override void OnEnable()
        {
            MessageCatalogue.Register<T>();
            base.OnEnable();
        }
    }
}
