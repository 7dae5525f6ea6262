// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using UnityEngine.Stage;

namespace UnityEngine.XR
{
    public enum XRNode
    {
        LeftEye = 0,
        RightEye = 1,
        CenterEye = 2,
        Head = 3,
        LeftHand = 4,
        RightHand = 5,
    }

    public struct InputFeatureUsage<T>
    {
        public InputFeatureUsage(string usageName)
        {
            name = usageName;
        }

        public string name { get; set; }
    }

    public static class CommonUsages
    {
        public static InputFeatureUsage<bool> triggerButton = new InputFeatureUsage<bool>("TriggerButton");
        public static InputFeatureUsage<bool> gripButton = new InputFeatureUsage<bool>("GripButton");
        public static InputFeatureUsage<bool> primary2DAxisClick =
            new InputFeatureUsage<bool>("Primary2DAxisClick");
        public static InputFeatureUsage<bool> userPresence = new InputFeatureUsage<bool>("UserPresence");
        public static InputFeatureUsage<Vector2> primary2DAxis =
            new InputFeatureUsage<Vector2>("Primary2DAxis");
        public static InputFeatureUsage<Vector3> devicePosition =
            new InputFeatureUsage<Vector3>("DevicePosition");
        public static InputFeatureUsage<Vector3> centerEyePosition =
            new InputFeatureUsage<Vector3>("CenterEyePosition");
        public static InputFeatureUsage<Quaternion> centerEyeRotation =
            new InputFeatureUsage<Quaternion>("CenterEyeRotation");
        public static InputFeatureUsage<Quaternion> deviceRotation =
            new InputFeatureUsage<Quaternion>("DeviceRotation");
    }

    public struct InputDevice
    {
        private readonly Dictionary<string, object> _features;

        internal InputDevice(Dictionary<string, object> features)
        {
            _features = features;
        }

        public string name
        {
            get
            {
                object found = null;
                bool isNamed = isValid && _features.TryGetValue("", out found);
                return isNamed ? (string)found : "";
            }
        }

        public bool isValid
        {
            get { return _features != null; }
        }

        public bool TryGetFeatureValue(InputFeatureUsage<bool> usage, out bool value)
        {
            return TryGet(usage.name, out value);
        }

        public bool TryGetFeatureValue(InputFeatureUsage<Vector2> usage, out Vector2 value)
        {
            return TryGet(usage.name, out value);
        }

        public bool TryGetFeatureValue(InputFeatureUsage<Vector3> usage, out Vector3 value)
        {
            return TryGet(usage.name, out value);
        }

        public bool TryGetFeatureValue(InputFeatureUsage<Quaternion> usage, out Quaternion value)
        {
            return TryGet(usage.name, out value);
        }

        private bool TryGet<T>(string name, out T value)
        {
            object found;
            bool isFound = isValid && _features.TryGetValue(name, out found) && found is T;
            value = isFound ? (T)_features[name] : default(T);
            return isFound;
        }
    }

    public class InputDevices
    {
        public static InputDevice GetDeviceAtXRNode(XRNode node)
        {
            MainThread.Check("GetDeviceIdAtXRNode");
            Dictionary<string, object> features;
            XrDevices.Features.TryGetValue(node, out features);
            return new InputDevice(features);
        }
    }
}

namespace UnityEngine.Stage
{
    using UnityEngine.XR;

    /// <summary>A headset and controllers for tests.</summary>
    public static class XrDevices
    {
        internal static readonly Dictionary<XRNode, Dictionary<string, object>> Features =
            new Dictionary<XRNode, Dictionary<string, object>>();

        /// <summary>Connects the device, if need be, and gives one of its features a value.</summary>
        public static void Set<T>(XRNode node, InputFeatureUsage<T> usage, T value)
        {
            if (!Features.ContainsKey(node))
            {
                Features[node] = new Dictionary<string, object>();
            }
            Features[node][usage.name] = value;
        }

        /// <summary>Names a device that is connected.</summary>
        public static void Name(XRNode node, string name)
        {
            Features[node][""] = name;
        }

        public static void Disconnect()
        {
            Features.Clear();
        }
    }
}
