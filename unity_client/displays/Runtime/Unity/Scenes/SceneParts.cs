// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Parts of scenes, for the editor's menu and for scenes that build themselves.</summary>
    public static class SceneParts
    {
        /// <summary>
        /// Makes an object that is not active yet, so that its components can be set up before they begin.
        /// </summary>
        public static GameObject New(string name, Transform parent)
        {
            GameObject made = new(name);
            made.SetActive(false);
            made.transform.SetParent(parent, false);
            return made;
        }

        /// <summary>Adds a text of letters about 7 cm high, which starts at the object and goes down.</summary>
        public static TextMesh AddText(GameObject holder)
        {
            TextMesh text = holder.AddComponent<TextMesh>();
            text.fontSize = 48; // the letters' resolution. Their height comes from the next line
            text.characterSize = 0.015f;
            text.anchor = TextAnchor.UpperLeft;
            return text;
        }

        /// <summary>Adds a subscriber, for the display that comes next to it.</summary>
        public static GameObject Subscribe(GameObject holder, string topic, string type, float maxRate = 0)
        {
            TopicSubscriber subscriber = holder.AddComponent<TopicSubscriber>();
            subscriber.Topic = topic;
            subscriber.Type = type;
            subscriber.MaxRate = maxRate;
            return holder;
        }

        /// <summary>Makes a publisher suit pictures, such as those of a Texture Publisher.</summary>
        public static void PublishPictures(TopicPublisher publisher)
        {
            publisher.Topic = "/unity/image/compressed";
            publisher.Type = CompressedImageMsg.Type;
            publisher.Rate = 10; // Hz
        }
    }
}
