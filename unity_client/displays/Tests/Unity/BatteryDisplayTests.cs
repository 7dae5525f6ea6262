// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using NUnit.Framework;
using Ros2Gateway.Messages.SensorMsgs;
using UnityEngine;
using UnityEngine.TestTools;

namespace Ros2Gateway.Unity.Tests
{
    [TestFixture]
    public sealed class BatteryDisplayTests
    {
        private DisplayScene _scene;
        private BatteryDisplay _display;
        private TextMesh _text;
        private int _alarms;

        [SetUp]
        public void SetUp()
        {
            _alarms = 0;
            _scene = new DisplayScene();
            _display = _scene.Display<BatteryDisplay>(setUp: made =>
            {
                _text = made.gameObject.AddComponent<TextMesh>();
                made.Bar = _scene.Inactive("bar").transform;
                made.OnLow.AddListener(() => _alarms++);
            });
        }

        [TearDown]
        public void TearDown() => _scene.Dispose();

        [UnityTest]
        public IEnumerator ChargeVoltageAndStatusAreShown()
        {
            yield return Show(0.756f, 12.04f, BatteryStateMsg.POWER_SUPPLY_STATUS_CHARGING);
            Assert.AreEqual("76 %, 12.0 V, charging", _text.text);
            Assert.AreEqual(0.756f, _display.Bar.localScale.x);
            Assert.AreEqual(1, _display.Bar.localScale.y);
            Assert.AreEqual(Color.white, _text.color);
        }

        [UnityTest]
        public IEnumerator WhatIsNotKnownIsSaidToBeUnknown()
        {
            yield return Show(float.NaN, float.NaN);
            Assert.AreEqual("charge unknown", _text.text);
            Assert.AreEqual(0, _display.Bar.localScale.x);
            Assert.IsNaN(_display.Charge);
            Assert.AreEqual(0, _alarms);
        }

        [UnityTest]
        public IEnumerator PerCentAreTakenForWhatTheyAre()
        {
            yield return Show(87, 12);
            Assert.AreEqual(0.87f, _display.Charge, 1e-6);
            yield return Show(1000, 12);
            Assert.AreEqual(1, _display.Charge);
            yield return Show(-5, 12);
            Assert.AreEqual(0, _display.Charge);
        }

        [UnityTest]
        public IEnumerator ALowChargeIsToldOncePerCrossing()
        {
            yield return Show(0.21f, 12);
            Assert.AreEqual(0, _alarms);
            yield return Show(0.19f, 12);
            Assert.AreEqual(1, _alarms);
            Assert.AreEqual(Color.red, _text.color);
            yield return Show(0.205f, 12); // it trembles
            yield return Show(float.NaN, 12);
            yield return Show(0.19f, 12);
            Assert.AreEqual(1, _alarms);
            Assert.IsTrue(_display.IsLow);
            yield return Show(0.5f, 12);
            Assert.IsFalse(_display.IsLow);
            Assert.AreEqual(Color.white, _text.color);
            yield return Show(0.1f, 12);
            Assert.AreEqual(2, _alarms);
        }

        [UnityTest]
        public IEnumerator AListenerThatThrowsKeepsNothingFromBeingShown()
        {
            LogAssert.ignoreFailingMessages = true; // that it is told is the point
            _display.Output.OnChanged.AddListener(text => { throw new System.InvalidOperationException("by text"); });
            _display.OnLow.AddListener(() => { throw new System.InvalidOperationException("by low"); });
            yield return Show(0.5f, 12);
            yield return Show(0.1f, 12);
            Assert.AreEqual("10 %, 12.0 V", _text.text);
            Assert.AreEqual(Color.red, _text.color);
            Assert.AreEqual(0.1f, _display.Bar.localScale.x);
            Assert.Less(_display.AgeSeconds, float.PositiveInfinity);
            Assert.AreEqual(1, Told("listener of On Changed of BatteryDisplay on BatteryDisplay threw InvalidOperationException: by text"));
            Assert.AreEqual(1, Told("listener of On Low of BatteryDisplay on BatteryDisplay threw InvalidOperationException: by low"));
        }

#if ROS2GATEWAY_UGUI
        [UnityTest]
        public IEnumerator AnImageIsFilled()
        {
            UnityEngine.UI.Image image = _display.Bar.gameObject.AddComponent<UnityEngine.UI.Image>();
            _display.Bar = image.transform;
            yield return Show(0.25f, 12);
            Assert.AreEqual(0.25f, image.fillAmount);
            Assert.AreEqual(1, _display.Bar.localScale.x);
        }
#endif

        private int Told(string words) => _scene.Logged.FindAll(text => text.Contains(words)).Count;

        private IEnumerator Show(float percentage, float voltage, byte status = 0)
        {
            _display.Show(new BatteryStateMsg
            {
                percentage = percentage,
                voltage = voltage,
                power_supply_status = status,
            });
            yield return null;
        }
    }
}
