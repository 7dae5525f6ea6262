// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;

namespace UnityEngine
{
    public sealed class Resources
    {
        internal static readonly Dictionary<string, Object> Assets = new Dictionary<string, Object>();

        public static T Load<T>(string path) where T : Object
        {
            Object asset;
            Assets.TryGetValue(path, out asset);
            return asset as T;
        }

        public static T GetBuiltinResource<T>(string path) where T : Object
        {
            return Load<T>(path);
        }
    }
}
