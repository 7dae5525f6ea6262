// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Hides an object and what is below it, and shows again what it has hidden.</summary>
    internal sealed class HiddenRenderers
    {
        private readonly List<Renderer> _hidden = new();

        internal bool IsHidden { get; private set; }

        internal void Set(Component top, bool isHidden)
        {
            if (isHidden == IsHidden)
            {
                return;
            }
            IsHidden = isHidden;
            if (isHidden)
            {
                foreach (Renderer part in top.GetComponentsInChildren<Renderer>())
                {
                    if (part.enabled)
                    {
                        part.enabled = false;
                        _hidden.Add(part);
                    }
                }
                return;
            }
            foreach (Renderer part in _hidden)
            {
                if (part != null)
                {
                    part.enabled = true;
                }
            }
            _hidden.Clear();
        }
    }
}
