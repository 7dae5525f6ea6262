// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine.XR.Interaction.Toolkit.Interactors
{
    public abstract class XRBaseInteractor : MonoBehaviour
    {
    }

    public abstract class XRBaseInputInteractor : XRBaseInteractor
    {
    }

    /// <summary>A straight ray along the forward axis of its origin.</summary>
    public class XRRayInteractor : XRBaseInputInteractor
    {
        private float _maxRaycastDistance = 30F;

        public Transform rayOriginTransform { get; set; }

        public float maxRaycastDistance
        {
            get { return _maxRaycastDistance; }
            set { _maxRaycastDistance = value; }
        }

        public bool TryGetCurrent3DRaycastHit(out RaycastHit raycastHit)
        {
            Transform origin = rayOriginTransform == null ? transform : rayOriginTransform;
            return Physics.Raycast(origin.position, origin.forward, out raycastHit, maxRaycastDistance);
        }
    }
}
