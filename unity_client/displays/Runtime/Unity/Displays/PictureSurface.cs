// SPDX-License-Identifier: Apache-2.0
using UnityEngine;
#if ROS2GATEWAY_UGUI
using UnityEngine.UI;
#endif

namespace Ros2Gateway.Unity
{
    /// <summary>The surface for an image: the Renderer or the RawImage next to a display.</summary>
    internal sealed class PictureSurface
    {
        // The shader of a Quad of the built-in pipeline: lit, as no image should be, and pink in URP.
        private const string DefaultMaterial = "Default-Material";

        // The same of URP, also by its shader, because the name is a common one. A build cannot ask the pipeline for it.
        private const string DefaultMaterialOfUrp = "Lit";
        private const string LitShaderOfUrp = "Universal Render Pipeline/Lit";

        private readonly Renderer _renderer;
        private readonly Material _original;
        private readonly Material _material; // a copy: the original may be an asset that others use
        private readonly bool _hasTint; // Unity logs an error where a shader has none
        private readonly Color _tint;
#if ROS2GATEWAY_UGUI
        private readonly RawImage _image;
        private readonly Color _imageTint;
        private AspectRatioFitter _fitter;
        private bool _isFitterOurs;
#endif

        internal PictureSurface(Component display)
        {
            _renderer = display.GetComponent<Renderer>();
            if (_renderer != null)
            {
                _original = _renderer.sharedMaterial;
                _material = CopyOf(_original);
                _renderer.sharedMaterial = _material;
            }
            _hasTint = _material != null
                && (_material.HasProperty("_Color") || _material.HasProperty("_BaseColor"));
            _tint = _hasTint ? _material.color : Color.white;
#if ROS2GATEWAY_UGUI
            _image = display.GetComponent<RawImage>();
            _imageTint = _image != null ? _image.color : Color.white;
            _fitter = display.GetComponent<AspectRatioFitter>();
#endif
        }

        internal bool Exists
        {
            get
            {
#if ROS2GATEWAY_UGUI
                if (_image != null)
                {
                    return true;
                }
#endif
                return _material != null;
            }
        }

        internal void Show(Texture texture)
        {
            if (_material != null)
            {
                _material.mainTexture = texture;
            }
#if ROS2GATEWAY_UGUI
            if (_image != null)
            {
                _image.texture = texture;
            }
#endif
        }

        /// <summary>Makes it as wide as the picture demands. The height stays.</summary>
        internal void KeepAspect(float aspect)
        {
#if ROS2GATEWAY_UGUI
            if (_image != null)
            {
                if (_fitter == null)
                {
                    _fitter = _image.gameObject.AddComponent<AspectRatioFitter>();
                    _fitter.aspectMode = AspectRatioFitter.AspectMode.HeightControlsWidth;
                    _isFitterOurs = true;
                }
                _fitter.aspectRatio = aspect;
                return;
            }
#endif
            if (_renderer != null)
            {
                Vector3 scale = _renderer.transform.localScale;
                _renderer.transform.localScale = new Vector3(scale.y * aspect, scale.y, scale.z);
            }
        }

        /// <summary>
        /// How many pixels of a camera's its longer side takes at most. Infinite if it is unknown, such as without a camera.
        /// </summary>
        internal float PixelsAcross(Camera camera)
        {
#if ROS2GATEWAY_UGUI
            if (_image != null)
            {
                Canvas canvas = _image.GetComponentInParent<Canvas>();
                Rect rect = ((RectTransform)_image.transform).rect;
                Vector3 scale = _image.transform.lossyScale;
                float side = Mathf.Max(rect.width * scale.x, rect.height * scale.y);
                if (canvas != null && canvas.renderMode == RenderMode.ScreenSpaceOverlay)
                {
                    return side; // a unit of the world is a pixel there
                }
                return Seen(camera, _image.transform.position, side);
            }
#endif
            if (_renderer == null)
            {
                return float.PositiveInfinity;
            }
            Bounds bounds = _renderer.bounds;
            return Seen(camera, bounds.center, Mathf.Max(bounds.size.x, Mathf.Max(bounds.size.y, bounds.size.z)));
        }

        /// <summary>Makes it darker than its colour. A share of 1 is its colour.</summary>
        internal void Darken(float share)
        {
            if (_hasTint)
            {
                _material.color = Darker(_tint, share);
            }
#if ROS2GATEWAY_UGUI
            if (_image != null)
            {
                _image.color = Darker(_imageTint, share);
            }
#endif
        }

        internal void Destroy()
        {
            if (_renderer != null)
            {
                _renderer.sharedMaterial = _original;
            }
            Object.Destroy(_material);
#if ROS2GATEWAY_UGUI
            if (_image != null)
            {
                _image.texture = null;
                _image.color = _imageTint;
            }
            if (_isFitterOurs)
            {
                Object.Destroy(_fitter);
            }
#endif
        }

        // As if it faced the camera in the middle of the view, with half of it nearer than the middle.
        private static float Seen(Camera camera, Vector3 middle, float side)
        {
            if (camera == null)
            {
                return float.PositiveInfinity;
            }
            if (camera.orthographic)
            {
                return side / (2 * camera.orthographicSize) * camera.pixelHeight;
            }
            float distance = Vector3.Distance(camera.transform.position, middle) - side / 2;
            float height = 2 * distance * Mathf.Tan(camera.fieldOfView / 2 * Mathf.Deg2Rad);
            return height > 0 ? side / height * camera.pixelHeight : float.PositiveInfinity;
        }

        private static Color Darker(Color color, float share) =>
            new Color(color.r * share, color.g * share, color.b * share, color.a);

        private static Material CopyOf(Material original)
        {
            Material unlit = IsChosen(original) ? null : DisplayMaterials.Flat();
            return unlit != null || original == null ? unlit : new Material(original);
        }

        private static bool IsChosen(Material material) =>
            material != null && material.name != DefaultMaterial
                && !(material.name == DefaultMaterialOfUrp && material.shader.name == LitShaderOfUrp);
    }
}
