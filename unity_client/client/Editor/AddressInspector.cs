// SPDX-License-Identifier: Apache-2.0
using System.Net;
using UnityEditor;
using UnityEngine;

namespace Ros2Gateway.Editor
{
    /// <summary>Of what has an address: with buttons that find gateways, and try the connection.</summary>
    public abstract class AddressInspector : UnityEditor.Editor
    {
        private const double FindSeconds = 10; // nobody answers later who has not by then

        private ConnectionProbe _probe;
        private GatewayFinder _finder;
        private double _findsUntil;

        /// <summary>The place to look for gateways: by default everywhere on this network.</summary>
        public IPAddress[] Targets { get; set; } = new IPAddress[0];

        /// <summary>The options of a connection, as things are set.</summary>
        protected abstract GatewayOptions Options();

        /// <summary>The name of the field that is the address.</summary>
        protected abstract string AddressField { get; }

        /// <summary>Draws what can be set, the buttons and what came of them.</summary>
        public override void OnInspectorGUI()
        {
            DrawDefaultInspector();
            EditorGUILayout.Space();
            DrawFound();
            if (GUILayout.Button("Test connection"))
            {
                End();
                _probe = new ConnectionProbe(Options());
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
            EndFinding();
        }

        private void DrawFound()
        {
            if (GUILayout.Button("Find gateways"))
            {
                EndFinding();
                _finder = new GatewayFinder(Targets);
                _findsUntil = EditorApplication.timeSinceStartup + FindSeconds;
                EditorApplication.update += Find;
            }
            if (_finder == null)
            {
                return;
            }
            EditorGUILayout.HelpBox(_finder.Problem ?? Progress(), MessageType.Info);
            foreach (FoundGateway found in _finder.Found)
            {
                // the encrypted one first: a token is to be seen by nobody
                if (IsChosen(found, found.SecureAddress) || IsChosen(found, found.Address))
                {
                    EndFinding();
                    return;
                }
            }
        }

        private bool IsChosen(FoundGateway found, string address)
        {
            string token = found.NeedsToken ? ", needs a token" : "";
            if (address == null || !GUILayout.Button(found.Name + "  " + address + token))
            {
                return false;
            }
            serializedObject.Update();
            serializedObject.FindProperty(AddressField).stringValue = address;
            serializedObject.ApplyModifiedProperties(); // an instance of a prefab keeps it, and it can be undone
            return true;
        }

        private string Progress() =>
            _finder.Found.Count > 0
                ? "choose one:"
                : "no gateway has answered yet: start one with ros2-gateway serve --lan";

        private void Find()
        {
            _finder.Pump();
            if (EditorApplication.timeSinceStartup > _findsUntil)
            {
                EditorApplication.update -= Find;
                _finder.Dispose(); // found gateways stay
            }
            Repaint();
        }

        private void EndFinding()
        {
            if (_finder != null)
            {
                EditorApplication.update -= Find;
                _finder.Dispose();
                _finder = null;
            }
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
