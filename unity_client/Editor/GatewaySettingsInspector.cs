// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;

namespace Ros2Gateway.Editor
{
    /// <summary>Of Gateway Settings, with a button that tries the connection.</summary>
    [CustomEditor(typeof(GatewaySettings))]
    public sealed class GatewaySettingsInspector : UnityEditor.Editor
    {
        private ConnectionProbe _probe;

        /// <summary>Draws the settings, the button and what came of it.</summary>
        public override void OnInspectorGUI()
        {
            DrawDefaultInspector();
            EditorGUILayout.Space();
            if (GUILayout.Button("Test connection"))
            {
                End();
                _probe = new ConnectionProbe(((GatewaySettings)target).Options());
                EditorApplication.update += Pump;
            }
            if (_probe != null)
            {
                bool isBad = _probe.IsDone && !_probe.IsGood;
                EditorGUILayout.HelpBox(_probe.Text, isBad ? MessageType.Error : MessageType.Info);
            }
        }

        // also called before a domain reload
        private void OnDisable()
        {
            End();
        }

        private void Pump()
        {
            _probe.Pump();
            if (_probe.IsDone)
            {
                EditorApplication.update -= Pump;
            }
            Repaint();
        }

        private void End()
        {
            if (_probe != null)
            {
                EditorApplication.update -= Pump;
                _probe.Dispose();
                _probe = null;
            }
        }
    }
}
