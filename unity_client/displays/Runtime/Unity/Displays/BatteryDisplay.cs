// SPDX-License-Identifier: Apache-2.0
using System.Globalization;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;
using UnityEngine.Events;
#if ROS2GATEWAY_UGUI
using UnityEngine.UI;
#endif

namespace Ros2Gateway.Unity
{
    /// <summary>Shows a battery's charge as text and as a bar, and says when it gets low.</summary>
    [AddComponentMenu("ROS 2 Gateway/Battery Display")]
    public sealed class BatteryDisplay : TypedDisplay<BatteryStateMsg>
    {
        private const float Tremble = 0.02f; // of the whole: a level that falls and rises by less is the same

        [SerializeField]
        [Tooltip("Its x scale, or the fill amount of an Image on it, is the charge: 0 to 1")]
        private Transform _bar;

        [SerializeField]
        [Tooltip("Below this share of the whole the charge is low")]
        [Range(0, 1)]
        private float _low = 0.2f;

        [SerializeField]
        private Color _color = Color.white;

        [SerializeField]
        private Color _lowColor = Color.red;

        [SerializeField]
        [Tooltip("Called once when the charge gets low")]
        private UnityEvent _onLow = new();

        [SerializeField]
        private TextOutput _text = new();

        private readonly Listeners<BatteryDisplay> _gotLow;

        /// <summary>A component of the scene. Made by Unity.</summary>
        public BatteryDisplay()
        {
            _gotLow = new Listeners<BatteryDisplay>(ReportFault, "listener of On Low");
            _gotLow.Add(display => _onLow.Invoke());
        }

        /// <summary>The charge as a share of the whole, 0 to 1. NaN if it is not known.</summary>
        public float Charge { get; private set; }

        /// <summary>Whether the charge is low.</summary>
        public bool IsLow { get; private set; }

        /// <summary>Its x scale, or the fill amount of an Image on it, is the charge: 0 to 1.</summary>
        public Transform Bar
        {
            get => _bar;
            set => _bar = value;
        }

        /// <summary>Below this share of the whole the charge is low.</summary>
        public float Low
        {
            get => _low;
            set => _low = value;
        }

        /// <summary>Called once when the charge gets low.</summary>
        public UnityEvent OnLow => _onLow;

        /// <summary>The text, and its places.</summary>
        public TextOutput Output => _text;

        /// <inheritdoc/>
        protected override void OnEnable()
        {
            base.OnEnable();
            Charge = float.NaN;
            if (!_text.Find(this, false) && _bar == null)
            {
                Warn("finds no TextMesh Pro, Text or TextMesh on or below it, and has no bar: add one");
            }
        }

        /// <inheritdoc/>
        protected override bool Draw(BatteryStateMsg message)
        {
            // the message says 0..1, some drivers say 0..100
            Charge = Mathf.Clamp01(message.percentage > 1 ? message.percentage / 100 : message.percentage);
            bool wasLow = IsLow;
            // NaN leaves it as it was
            IsLow = Charge < _low || (IsLow && !(Charge >= _low + Tremble));
            _text.Show(Words(message));
            _text.Paint(IsLow ? _lowColor : _color);
            DrawBar();
            if (IsLow && !wasLow)
            {
                _gotLow.Call(this);
            }
            return true;
        }

        private void DrawBar()
        {
            if (_bar == null)
            {
                return;
            }
            float filled = float.IsNaN(Charge) ? 0 : Charge;
#if ROS2GATEWAY_UGUI
            Image image = _bar.GetComponent<Image>();
            if (image != null)
            {
                image.fillAmount = filled;
                image.color = IsLow ? _lowColor : _color;
                return;
            }
#endif
            Vector3 scale = _bar.localScale;
            _bar.localScale = new Vector3(filled, scale.y, scale.z);
        }

        private string Words(BatteryStateMsg message)
        {
            string charge = float.IsNaN(Charge) ? "charge unknown"
                : Mathf.RoundToInt(Charge * 100).ToString(CultureInfo.InvariantCulture) + " %";
            string voltage = float.IsNaN(message.voltage) || message.voltage <= 0 ? ""
                : ", " + message.voltage.ToString("0.0", CultureInfo.InvariantCulture) + " V";
            return charge + voltage + Status(message.power_supply_status);
        }

        private static string Status(byte status) =>
            status switch
            {
                BatteryStateMsg.POWER_SUPPLY_STATUS_CHARGING => ", charging",
                BatteryStateMsg.POWER_SUPPLY_STATUS_DISCHARGING => ", discharging",
                BatteryStateMsg.POWER_SUPPLY_STATUS_NOT_CHARGING => ", not charging",
                BatteryStateMsg.POWER_SUPPLY_STATUS_FULL => ", full",
                _ => "",
            };
    }
}
