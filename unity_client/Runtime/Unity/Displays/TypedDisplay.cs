// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// A display of one type, whose class it makes known: it works where only registered classes are.
    /// </summary>
    public abstract class TypedDisplay<T> : TopicDisplay<T>
        where T : class, IMessage, new()
    {
        /// <inheritdoc/>
        protected override void OnEnable()
        {
            MessageCatalogue.Register(new T().RosType, () => new T());
            base.OnEnable();
        }
    }
}
