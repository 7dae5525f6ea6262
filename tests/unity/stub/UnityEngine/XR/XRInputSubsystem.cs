// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;

namespace UnityEngine
{
    public interface ISubsystem
    {
    }

    public class IntegratedSubsystem : ISubsystem
    {
    }

    public class IntegratedSubsystem<TSubsystemDescriptor> : IntegratedSubsystem
    {
    }

    /// <summary>Always empty.</summary>
    public static class SubsystemManager
    {
        public static void GetSubsystems<T>(List<T> subsystems) where T : ISubsystem
        {
            subsystems.Clear();
        }
    }
}

namespace UnityEngine.XR
{
    public class XRInputSubsystemDescriptor
    {
    }

    public class XRInputSubsystem : IntegratedSubsystem<XRInputSubsystemDescriptor>
    {
        public bool TrySetTrackingOriginMode(TrackingOriginModeFlags origin)
        {
            return false;
        }
    }

    [Flags]
    public enum TrackingOriginModeFlags
    {
        Unknown = 0,
        Device = 1,
        Floor = 2,
        TrackingReference = 4,
        Unbounded = 8,
    }
}
