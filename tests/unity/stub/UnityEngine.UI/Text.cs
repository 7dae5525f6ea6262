// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine.UI
{
    [RequireComponent(typeof(RectTransform))]
    public abstract class Graphic : EventSystems.UIBehaviour
    {
        private Color _color = Color.white;

        public virtual Color color
        {
            get { return _color; }
            set { _color = value; }
        }

        public virtual bool raycastTarget { get; set; }

        public virtual Material material { get; set; }
    }

    public abstract class MaskableGraphic : Graphic
    {
    }

    public class Text : MaskableGraphic
    {
        private string _text = "";

        public virtual string text
        {
            get { return _text; }
            set { _text = value ?? ""; }
        }

        public Font font { get; set; }

        public int fontSize { get; set; }

        public TextAnchor alignment { get; set; }

        public bool supportRichText { get; set; }

        public HorizontalWrapMode horizontalOverflow { get; set; }

        public VerticalWrapMode verticalOverflow { get; set; }
    }

    public class RawImage : MaskableGraphic
    {
        private Rect _uvRect = new Rect(0F, 0F, 1F, 1F);

        public Texture texture { get; set; }

        public Rect uvRect
        {
            get { return _uvRect; }
            set { _uvRect = value; }
        }
    }

    public class Image : MaskableGraphic
    {
        public float fillAmount { get; set; }
    }

    public class CanvasScaler : EventSystems.UIBehaviour
    {
        public ScaleMode uiScaleMode { get; set; }

        public Vector2 referenceResolution { get; set; }

        public float dynamicPixelsPerUnit { get; set; }

        public enum ScaleMode
        {
            ConstantPixelSize = 0,
            ScaleWithScreenSize = 1,
            ConstantPhysicalSize = 2,
        }
    }

    public class AspectRatioFitter : EventSystems.UIBehaviour
    {
        public AspectMode aspectMode { get; set; }

        public float aspectRatio { get; set; }

        public enum AspectMode
        {
            None = 0,
            WidthControlsHeight = 1,
            HeightControlsWidth = 2,
            FitInParent = 3,
            EnvelopeParent = 4,
        }
    }
}

namespace UnityEngine.EventSystems
{
    public abstract class UIBehaviour : MonoBehaviour
    {
    }
}
