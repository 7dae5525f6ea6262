// SPDX-License-Identifier: Apache-2.0
using UnityEngine.Stage;

namespace UnityEngine
{
    /// <summary>Rays against boxes: every collider is taken for the box that it fills.</summary>
    public class Physics
    {
        public const int DefaultRaycastLayers = -5;

        public static bool Raycast(Ray ray, out RaycastHit hitInfo)
        {
            return Raycast(ray.origin, ray.direction, out hitInfo, Mathf.Infinity, DefaultRaycastLayers);
        }

        public static bool Raycast(Ray ray, out RaycastHit hitInfo, float maxDistance)
        {
            return Raycast(ray.origin, ray.direction, out hitInfo, maxDistance, DefaultRaycastLayers);
        }

        public static bool Raycast(Ray ray, out RaycastHit hitInfo, float maxDistance, int layerMask)
        {
            return Raycast(ray.origin, ray.direction, out hitInfo, maxDistance, layerMask);
        }

        public static bool Raycast(Vector3 origin, Vector3 direction, out RaycastHit hitInfo)
        {
            return Raycast(origin, direction, out hitInfo, Mathf.Infinity, DefaultRaycastLayers);
        }

        public static bool Raycast(Vector3 origin, Vector3 direction, out RaycastHit hitInfo,
            float maxDistance)
        {
            return Raycast(origin, direction, out hitInfo, maxDistance, DefaultRaycastLayers);
        }

        public static bool Raycast(Vector3 origin, Vector3 direction, out RaycastHit hitInfo,
            float maxDistance, int layerMask)
        {
            MainThread.Check("Internal_Raycast");
            hitInfo = new RaycastHit { distance = maxDistance };
            bool found = false;
            foreach (Collider collider in Object.All<Collider>())
            {
                RaycastHit hit;
                bool isAsked = collider.enabled && (layerMask & (1 << collider.gameObject.layer)) != 0;
                if (isAsked && Hits(collider, origin, direction.normalized, out hit)
                    && hit.distance <= hitInfo.distance)
                {
                    hitInfo = hit;
                    found = true;
                }
            }
            return found;
        }

        /// <summary>The slab method, in the collider's own frame.</summary>
        private static bool Hits(Collider collider, Vector3 origin, Vector3 direction, out RaycastHit hit)
        {
            hit = new RaycastHit();
            Transform frame = collider.transform;
            Vector3 start = frame.InverseTransformPoint(origin);
            Vector3 way = frame.InverseTransformPoint(origin + direction) - start;
            Vector3 low = collider.LocalBounds.min;
            Vector3 high = collider.LocalBounds.max;
            float enter = float.NegativeInfinity;
            float leave = float.PositiveInfinity;
            var normal = Vector3.zero;
            for (int axis = 0; axis < 3; axis++)
            {
                if (way[axis] == 0F)
                {
                    if (start[axis] < low[axis] || start[axis] > high[axis])
                    {
                        return false;
                    }
                    continue;
                }
                float near = ((way[axis] > 0F ? low[axis] : high[axis]) - start[axis]) / way[axis];
                float far = ((way[axis] > 0F ? high[axis] : low[axis]) - start[axis]) / way[axis];
                if (near > enter)
                {
                    enter = near;
                    normal = Vector3.zero;
                    normal[axis] = way[axis] > 0F ? -1F : 1F;
                }
                leave = Mathf.Min(leave, far);
            }
            if (enter > leave || enter < 0F)
            {
                return false;
            }
            hit = new RaycastHit
            {
                point = origin + direction * enter,
                distance = enter,
                normal = frame.TransformDirection(normal),
                Collider = collider,
            };
            return true;
        }
    }

    public struct LayerMask
    {
        private int _mask;

        public int value
        {
            get { return _mask; }
            set { _mask = value; }
        }

        public static implicit operator int(LayerMask mask)
        {
            return mask._mask;
        }

        public static implicit operator LayerMask(int intVal)
        {
            return new LayerMask { _mask = intVal };
        }
    }
}
