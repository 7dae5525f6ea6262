// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace UnityEditor
{
    public sealed class MenuCommand
    {
        public Object context;

        public MenuCommand(Object inContext)
        {
            context = inContext;
        }
    }

    public sealed class GameObjectUtility
    {
        public static void SetParentAndAlign(GameObject child, GameObject parent)
        {
            if (parent != null)
            {
                child.transform.SetParent(parent.transform, false);
            }
        }
    }
}
