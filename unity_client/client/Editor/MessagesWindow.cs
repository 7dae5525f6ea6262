// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Linq;
using Ros2Gateway.Json;
using Ros2Gateway.Unity;
using UnityEditor;
using UnityEngine;

namespace Ros2Gateway.Editor
{
    /// <summary>
    /// Window > ROS 2 Gateway > Messages: C# classes of the types that the connected robot has and the package has not.
    /// </summary>
    public sealed class MessagesWindow : EditorWindow
    {
        private const int MostRows = 100; // a longer list does not help: search further

        [SerializeField]
        private GatewaySettings _settings;

        [SerializeField]
        private string _folder = "Assets/RobotMessages";

        [SerializeField]
        private string _assembly = GeneratedMessages.DefaultAssembly;

        [SerializeField]
        private string _search = "";

        [SerializeField]
        private string _result = ""; // is read after the reload that new scripts bring

        [SerializeField]
        private bool _isBad;

        // ticked by hand, over what the folder has
        private readonly Dictionary<string, bool> _ticked = new();
        private GeneratedMessages _there;
        private RobotTypes _robot;
        private Vector2 _scroll;
        private bool _isWorking;

        /// <summary>Opens it.</summary>
        [MenuItem("Window/ROS 2 Gateway/Messages")]
        public static void Open() => GetWindow<MessagesWindow>("ROS 2 Messages").Show();

        private void OnEnable() => Look();

        // also called before a domain reload
        private void OnDisable() => Disconnect();

        private void OnGUI()
        {
            _settings = (GatewaySettings)EditorGUILayout.ObjectField(
                "Gateway settings", _settings, typeof(GatewaySettings), false);
            if (GUILayout.Button("Connect"))
            {
                Connect();
            }
            if (_robot == null)
            {
                EditorGUILayout.HelpBox(
                    "Connect lists the types of the robot at " + Options().Address, MessageType.Info);
                return;
            }
            if (_robot.Problem.Length > 0)
            {
                EditorGUILayout.HelpBox(_robot.Problem, MessageType.Info);
            }
            _search = EditorGUILayout.TextField("Find a type", _search);
            DrawTypes();
            string folder = EditorGUILayout.TextField("Folder", _folder);
            if (folder != _folder)
            {
                _folder = folder;
                Look();
            }
            _assembly = EditorGUILayout.TextField("Assembly", _assembly);
            if (GUILayout.Button("Generate") && !_isWorking)
            {
                Generate();
            }
            if (_result.Length > 0)
            {
                EditorGUILayout.HelpBox(_result, _isBad ? MessageType.Error : MessageType.Info);
            }
        }

        private void DrawTypes()
        {
            _scroll = EditorGUILayout.BeginScrollView(_scroll);
            int found = 0;
            foreach (RobotType type in _robot.Types)
            {
                bool isFound = type.Name.IndexOf(_search.Trim(), StringComparison.OrdinalIgnoreCase) >= 0;
                if (!isFound || IsOfPackage(type) || ++found > MostRows)
                {
                    continue;
                }
                string label = type.Uses.Length > 0 ? type.Name + "   " + type.Uses : type.Name;
                bool isChosen = IsChosen(type.Name);
                if (EditorGUILayout.ToggleLeft(label, isChosen) != isChosen)
                {
                    _ticked[type.Name] = !isChosen;
                }
            }
            EditorGUILayout.EndScrollView();
            if (found > MostRows)
            {
                EditorGUILayout.HelpBox(found - MostRows + " more: search further", MessageType.Info);
            }
            if (found == 0 && _robot.Types.Count > 0)
            {
                EditorGUILayout.HelpBox(
                    "the package and the project already have classes of all types with this name", MessageType.Info);
            }
        }

        /// <summary>Its class was not generated into this folder, so it comes with the package, or is someone's own.</summary>
        private bool IsOfPackage(RobotType type) => type.HasClass && (_there == null || !_there.Has(type.Name));

        private bool IsChosen(string type) =>
            _ticked.TryGetValue(type, out bool isTicked) ? isTicked : _there != null && _there.Has(type);

        private void Generate()
        {
            List<string> known = _robot.Types.Select(type => type.Name).ToList();
            List<string> asked = known.Where(IsChosen).ToList();
            string missing = _there == null
                ? null
                : _there.Types.FirstOrDefault(type => !type.EndsWith("*") && !known.Contains(type) && IsChosen(type));
            if (missing != null)
            {
                Tell("this robot does not have " + missing + ", which " + _folder + " has: choose another folder", true);
                return;
            }
            if (asked.Count == 0)
            {
                Tell("no type is chosen", true);
                return;
            }
            _isWorking = true;
            Tell("the gateway writes the classes of " + asked.Count + " types", false);
            string folder = _folder;
            _robot.Generate(asked, _assembly, reply => Write(reply, folder));
        }

        private void Write(Reply<JsonValue> reply, string folder)
        {
            _isWorking = false;
            try
            {
                JsonValue code = reply.OrThrow();
                IList<string> changed = new GeneratedMessages(folder).Write(code["files"]);
                List<string> words = new() { changed.Count + " files of " + folder + " have changed" };
                words.AddRange(code["notes"].Items.Select(note => note.AsString()));
                Tell(string.Join("\n", words), false);
                _ticked.Clear();
                Look();
                if (changed.Count > 0)
                {
                    AssetDatabase.Refresh();
                }
            }
            catch (GatewayException error)
            {
                Tell(error.Message, true);
            }
        }

        private void Look()
        {
            try
            {
                _there = new GeneratedMessages(_folder);
                _assembly = _there.Assembly;
            }
            catch (GatewayException error)
            {
                _there = null;
                Tell(error.Message, true);
            }
        }

        private void Connect()
        {
            Disconnect();
            _robot = new RobotTypes(Options());
            _robot.Changed += Repaint;
            EditorApplication.update += _robot.Pump;
        }

        private void Disconnect()
        {
            if (_robot != null)
            {
                EditorApplication.update -= _robot.Pump;
                _robot.Dispose();
                _robot = null;
            }
            _isWorking = false;
        }

        private GatewayOptions Options() =>
            _settings != null
                ? _settings.Options()
                : EditorClient.OptionsOf(FindAnyObjectByType<GatewayConnection>());

        private void Tell(string text, bool isBad)
        {
            _result = text;
            _isBad = isBad;
            Repaint();
        }
    }
}
