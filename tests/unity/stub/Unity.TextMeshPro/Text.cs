// SPDX-License-Identifier: Apache-2.0
using UnityEngine;
using UnityEngine.UI;

namespace TMPro
{
    public abstract class TMP_Text : MaskableGraphic
    {
        private string _text = "";

        public virtual string text
        {
            get { return _text; }
            set { _text = value; }
        }

        public bool richText { get; set; }

        public bool parseCtrlCharacters { get; set; } = true;
    }

    [RequireComponent(typeof(RectTransform))]
    public class TextMeshPro : TMP_Text
    {
    }

    [RequireComponent(typeof(RectTransform))]
    public class TextMeshProUGUI : TMP_Text
    {
    }
}
