// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine
{
    [RequireComponent(typeof(MeshRenderer))]
    public sealed class TextMesh : Component
    {
        public string text { get; set; } = "";

        public Color color { get; set; }

        public float characterSize { get; set; }

        public int fontSize { get; set; }

        public TextAnchor anchor { get; set; }

        public TextAlignment alignment { get; set; }

        public Font font { get; set; }

        public bool richText { get; set; }
    }

    public sealed class Font : Object
    {
        public Material material { get; set; }
    }

    public enum TextAnchor
    {
        UpperLeft = 0,
        UpperCenter = 1,
        UpperRight = 2,
        MiddleLeft = 3,
        MiddleCenter = 4,
        MiddleRight = 5,
        LowerLeft = 6,
        LowerCenter = 7,
        LowerRight = 8,
    }

    public enum TextAlignment
    {
        Left = 0,
        Center = 1,
        Right = 2,
    }
}
