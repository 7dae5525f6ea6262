// SPDX-License-Identifier: Apache-2.0
using System.Linq;
using System.Text;
using Ros2Gateway.Json;
using Ros2Gateway.Messages;
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;

namespace Ros2Gateway.Editor
{
    /// <summary>Of Topic Publishers, which need a type. Their message is a text, or has fields.</summary>
    [CanEditMultipleObjects]
    [CustomEditor(typeof(TopicPublisher))]
    public sealed class TopicPublisherInspector : TopicInspector
    {
        private string _problem;

        /// <inheritdoc/>
        protected override bool TypeMayBeEmpty => false;

        /// <inheritdoc/>
        protected override void DrawOthers(params string[] drawn)
        {
            SerializedProperty fields = serializedObject.FindProperty("_fields");
            IMessage message = (IMessage)fields.managedReferenceValue;
            bool hasFields = message != null;
            base.DrawOthers(drawn.Append(hasFields ? "_message" : "_fields").ToArray());
            if (serializedObject.isEditingMultipleObjects)
            {
                return;
            }
            string type = MessageCatalogue.Resolve(serializedObject.FindProperty("_type").stringValue);
            if (hasFields && message.RosType != type)
            {
                Warn("the fields are those of " + message.RosType + ", the type is " + type);
            }
            if (hasFields && GUILayout.Button("Edit as text"))
            {
                serializedObject.FindProperty("_message").stringValue = UnstampedMessage.Of(message).Value.ToString();
                fields.managedReferenceValue = null;
                _problem = null;
            }
            else if (GUILayout.Button(hasFields ? "Clear the fields" : "Edit the fields"))
            {
                string text = hasFields ? "" : serializedObject.FindProperty("_message").stringValue;
                IMessage made = Read(type, text);
                fields.managedReferenceValue = made ?? message;
                if (made != null)
                {
                    // else what nobody sees would be published if the fields were lost
                    serializedObject.FindProperty("_message").stringValue = "";
                }
            }
            Warn(_problem);
        }

        /// <summary>A message of a type with what a text says of it. Null, with a problem, if that cannot be.</summary>
        private IMessage Read(string type, string text)
        {
            _problem = null;
            IMessage message = MessageClasses.Create(type);
            if (message == null)
            {
                _problem = "no class for " + type + ": make one with Window > ROS 2 Gateway > Messages";
                return null;
            }
            if (string.IsNullOrEmpty(text))
            {
                return message;
            }
            try
            {
                JsonReader reader = new();
                byte[] utf8 = Encoding.UTF8.GetBytes(text);
                reader.Reset(utf8, 0, utf8.Length);
                message.Read(reader);
                reader.End();
                return message;
            }
            catch (JsonFormatException error)
            {
                _problem = "the text is not a " + type + ": " + error.Message;
                return null;
            }
        }
    }
}
