// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Threading;
using Ros2Gateway.Robots;
using Ros2Gateway.Shapes;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>Fetches the meshes of one robot from its gateway, and draws each where a small box stands for it.</summary>
    /// <remarks>
    /// One file is fetched at a time, and the one before it read and drawn in the meantime. On a thread of the pool, where
    /// there are threads, except the upload, of a part in each frame. A connection that is lost, or comes late, is
    /// waited for. A refused file is asked for again after the others, because the gateway may have been busy. Both
    /// end after three attempts for a file.
    /// </remarks>
    internal sealed class ServedMeshes : IDisposable
    {
        private const int PartVertices = 3 << 16; // more take longer to upload than a frame has
        private const int MaxAttempts = 3; // of a file with which connections end, or which is refused
        private const double RetrySeconds = 2;

#if UNITY_WEBGL && !UNITY_EDITOR
        private static readonly bool HasThreads = false;
#else
        private static readonly bool HasThreads = true;
#endif

        private readonly Action<string> _warn;
        private readonly int _maxTriangles;
        private readonly WaitCallback _work;
        private readonly Dictionary<string, ServedMesh> _byUri = new();
        private readonly Queue<ServedMesh> _unfetched = new(); // the first of it is being fetched
        private GatewayClient _client; // by which that is done
        private AssetFetch _fetch; // null while nothing is under way
        private ServedMesh _fetched; // waits to be drawn
        private ServedMesh _drawn;
        private int _triangles;

        // Of the one that is drawn. The worker's while it is at work.
        private MeshBuffer _part;
        private int _visual; // of those that show it
        private int _first; // triangle of the part
        private int _next; // triangle after it
        private string _problem;
        private volatile bool _isAtWork;

        /// <param name="warn">Gets what is wrong with a mesh, in words.</param>
        /// <param name="maxTriangles">Of all that is drawn. Further meshes stay small boxes.</param>
        internal ServedMeshes(Action<string> warn, int maxTriangles)
        {
            _warn = warn;
            _maxTriangles = maxTriangles;
            _work = state => Work();
        }

        /// <summary>Whether nothing is left to do.</summary>
        internal bool IsOver => _unfetched.Count == 0 && _fetched == null && _drawn == null;

        /// <summary>Adds a visual whose mesh is to be fetched. Before the first <see cref="Update"/>.</summary>
        /// <param name="drawn">Has the small box, and gets the mesh.</param>
        /// <param name="more">Makes another for what is too much for one. Null if there is no place any more.</param>
        internal void Add(RobotVisual visual, PointMesh drawn, Func<PointMesh> more)
        {
            if (!_byUri.TryGetValue(visual.Mesh, out ServedMesh mesh))
            {
                mesh = _byUri[visual.Mesh] = new ServedMesh(visual.Mesh);
                _unfetched.Enqueue(mesh);
            }
            mesh.Visuals.Add(new ServedVisual { Visual = visual, Drawn = drawn, More = more });
        }

        /// <summary>Goes on. In each frame.</summary>
        /// <param name="client">Null without one.</param>
        internal void Update(GatewayClient client)
        {
            Fetch(client);
            if (_isAtWork)
            {
                return;
            }
            if (_drawn != null)
            {
                TakePart();
            }
            if (_drawn == null && _fetched != null)
            {
                _drawn = _fetched;
                _fetched = null;
                _visual = 0;
                _first = 0;
                BeginPart();
            }
        }

        /// <summary>Ends all that is under way.</summary>
        public void Dispose()
        {
            if (_fetch != null)
            {
                _fetch.Cancel();
                _fetch = null;
            }
        }

        private void Fetch(GatewayClient client)
        {
            if (_fetch != null && client != _client)
            {
                Dispose(); // of a connection that is gone
            }
            if (_fetch == null && _fetched == null && client != null && client.IsConnected && FindNext())
            {
                _client = client;
                _unfetched.Peek().Attempts++;
                _fetch = new AssetFetch(client, _unfetched.Peek().Uri, Take).Start();
            }
        }

        /// <summary>Brings the next whose time has come to the front. False without one.</summary>
        private bool FindNext()
        {
            double now = Time.unscaledTimeAsDouble;
            for (int i = 0; i < _unfetched.Count; i++)
            {
                if (_unfetched.Peek().NotBefore <= now)
                {
                    return true;
                }
                _unfetched.Enqueue(_unfetched.Dequeue());
            }
            return false;
        }

        private void Take(Reply<byte[]> reply)
        {
            bool isLost = !reply.Ok && _fetch.HasLostConnection;
            _fetch = null;
            ServedMesh mesh = _unfetched.Peek();
            bool isLast = mesh.Attempts >= MaxAttempts;
            if (isLost && !isLast)
            {
                return; // asked for again when there is a connection
            }
            _unfetched.Dequeue();
            if (reply.Ok)
            {
                mesh.File = reply.Value;
                _fetched = mesh;
            }
            else if (!isLast)
            {
                mesh.NotBefore = Time.unscaledTimeAsDouble + RetrySeconds;
                _unfetched.Enqueue(mesh);
            }
            else
            {
                _warn(mesh.Uri + " cannot be fetched: " + reply.Error + ": a small box takes its place");
            }
        }

        private void BeginPart()
        {
            _isAtWork = true;
            if (HasThreads)
            {
                ThreadPool.UnsafeQueueUserWorkItem(_work, null);
            }
            else
            {
                Work();
            }
        }

        /// <summary>Reads the file unless that is done, and makes a part of it for a visual.</summary>
        private void Work()
        {
            _problem = null;
            try
            {
                if (_drawn.Mesh == null)
                {
                    byte[] file = _drawn.File;
                    _drawn.File = null;
                    _drawn.Mesh = MeshReader.Read(_drawn.Uri, file);
                }
                _part ??= new MeshBuffer { Room = PartVertices };
                _part.Clear(MeshKind.Triangles);
                RobotVisual visual = _drawn.Visuals[_visual].Visual;
                _next = _drawn.Mesh.AddTo(_part, _first, visual.Origin, visual.Size, visual.Color);
            }
            catch (MeshException error)
            {
                _problem = error.Message;
            }
            catch (OutOfMemoryException)
            {
                _problem = "not enough memory for it";
            }
            catch (Exception error) // a fault of the reader, which is not to end the application
            {
                _problem = "the reader failed: " + error.GetType().Name + ": " + error.Message;
            }
            _isAtWork = false;
        }

        /// <summary>Uploads what has been made, and begins the next part.</summary>
        private void TakePart()
        {
            ServedVisual visual = _drawn.Visuals[_visual];
            bool isRead = _drawn.Mesh != null;
            if (_problem == null && _first == 0)
            {
                bool fits = _drawn.Mesh.TriangleCount <= _maxTriangles - _triangles;
                _triangles += fits ? _drawn.Mesh.TriangleCount : 0;
                _problem = fits ? null : "with it, the robot's meshes have more than " + _maxTriangles + " triangles";
            }
            PointMesh drawn = null;
            if (_problem != null)
            {
                _warn(_drawn.Uri + " cannot be drawn: " + _problem + ": a small box takes its place");
            }
            else
            {
                drawn = _first == 0 ? visual.Drawn : visual.More();
            }
            if (drawn != null)
            {
                drawn.Upload(_part);
            }
            _first = _next;
            if (drawn == null || _first == _drawn.Mesh.TriangleCount)
            {
                _first = 0;
                _visual++;
            }
            if (isRead && _visual < _drawn.Visuals.Count)
            {
                BeginPart();
            }
            else
            {
                _drawn.Mesh = null;
                _drawn = null;
            }
        }

        /// <summary>A file, and who shows it.</summary>
        private sealed class ServedMesh
        {
            internal readonly string Uri;
            internal readonly List<ServedVisual> Visuals = new();
            internal int Attempts;
            internal double NotBefore; // of Unity's time, it is asked for again
            internal byte[] File; // from when it is fetched until it is read
            internal TriangleMesh Mesh; // from then on until it is drawn

            internal ServedMesh(string uri) => Uri = uri;
        }

        private struct ServedVisual
        {
            internal RobotVisual Visual;
            internal PointMesh Drawn;
            internal Func<PointMesh> More;
        }
    }
}
