// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>
    /// Asks for the chunks of an asset, one after the other, and puts them together, on the thread that reads
    /// frames. A chunk in each frame of the application would take long.
    /// </summary>
    internal sealed class AssetFetch
    {
        /// <summary>A larger asset is refused: the mesh of a link has 20 MB at most.</summary>
        internal const int MaxBytes = 64 * 1024 * 1024;

        private static readonly JsonMembers ChunkMembers = new("offset", "size", "data");

        private readonly object _gate = new();
        private readonly GatewayClient _client;
        private readonly string _uri;
        private readonly string _what;
        private readonly int _timeoutMilliseconds;
        private readonly Action<Reply<byte[]>> _done;
        private byte[] _chunk = Array.Empty<byte>(); // used again for the next one
        private byte[] _asset; // null before the first chunk
        private int _offset; // so many bytes of it are here
        private string _id; // of the chunk that is under way
        private int _connection;
        private bool _isOver;

        /// <param name="done">Called once by the pump. Never after <see cref="Cancel"/>.</param>
        /// <param name="timeoutMilliseconds">For each chunk. 0 for that of the client.</param>
        internal AssetFetch(GatewayClient client, string uri, Action<Reply<byte[]>> done, int timeoutMilliseconds = 0)
        {
            _client = client;
            _uri = uri;
            _what = What(uri);
            _timeoutMilliseconds = timeoutMilliseconds > 0 ? timeoutMilliseconds : client.CallMilliseconds;
            _done = done;
        }

        /// <summary>The request, for people.</summary>
        internal static string What(string uri) => "fetch_asset " + uri;

        /// <summary>Whether the connection has ended by which it began. There may be another.</summary>
        internal bool HasLostConnection => !_client.IsConnected || _client.Connections != _connection;

        /// <summary>Asks for the first chunk.</summary>
        internal AssetFetch Start()
        {
            _connection = _client.Connections;
            lock (_gate)
            {
                Ask();
            }
            return this;
        }

        /// <summary>Gives it up. False if it has ended. Any thread.</summary>
        internal bool Cancel()
        {
            lock (_gate)
            {
                if (_isOver)
                {
                    return false;
                }
                _isOver = true;
                _client.Requests.Forget(_id);
                return true;
            }
        }

        private void Ask()
        {
            int offset = _offset;
            _id = _client.Requests.Send(
                "fetch_asset",
                _what,
                frame =>
                {
                    frame.Name("uri").Value(_uri);
                    frame.Name("offset").Value(offset);
                },
                Read,
                Take,
                _timeoutMilliseconds,
                _done != null);
        }

        /// <summary>On the thread that reads frames.</summary>
        private Progress Read(JsonReader reader)
        {
            Chunk chunk = ReadChunk(reader);
            Progress progress = default(Progress);
            lock (_gate)
            {
                if (!_isOver)
                {
                    progress.Problem = Add(chunk);
                    progress.IsEnd = progress.Problem != null || _offset == _asset.Length;
                    if (!progress.IsEnd)
                    {
                        Ask();
                    }
                }
            }
            return progress;
        }

        private Chunk ReadChunk(JsonReader reader)
        {
            Chunk chunk = new() { Offset = -1, Size = -1, Count = -1 };
            reader.BeginObject();
            int member = JsonMembers.Unknown;
            while (reader.NextMember(ChunkMembers, ref member))
            {
                switch (member)
                {
                    case 0:
                        chunk.Offset = reader.ReadInt64();
                        break;
                    case 1:
                        chunk.Size = reader.ReadInt64();
                        break;
                    case 2:
                        chunk.Count = reader.ReadBytes(ref _chunk);
                        break;
                    default:
                        reader.Skip();
                        break;
                }
            }
            return chunk;
        }

        /// <summary>In the pump, for each chunk.</summary>
        private void Take(Reply<Progress> reply)
        {
            lock (_gate)
            {
                if (_isOver || (reply.Ok && !reply.Value.IsEnd))
                {
                    return; // cancelled while the answer waited for the pump, or another is under way
                }
                _isOver = true;
            }
            string problem = reply.Ok ? reply.Value.Problem : reply.Error;
            if (reply.Ok && problem != null)
            {
                _client.Reports.Failure(_what, problem, _done != null); // else it was reported as the request failed
            }
            if (_done != null)
            {
                _done(problem == null ? Reply<byte[]>.Of(_asset) : Reply<byte[]>.Failed(problem));
            }
        }

        /// <summary>Returns what is wrong with the chunk, or null.</summary>
        private string Add(Chunk chunk)
        {
            if (chunk.Offset < 0 || chunk.Size < 0 || chunk.Count < 0)
            {
                return "the answer has no offset, size or data, or a negative one";
            }
            if (chunk.Size > MaxBytes)
            {
                return "the asset has " + chunk.Size + " bytes, at most " + MaxBytes;
            }
            if (_asset != null && chunk.Size != _asset.Length)
            {
                return "the asset's size changed from " + _asset.Length + " to " + chunk.Size + " bytes while it was fetched";
            }
            if (chunk.Offset != _offset)
            {
                return "asked for the bytes from offset " + _offset + ", got those from " + chunk.Offset;
            }
            if (chunk.Count > chunk.Size - _offset)
            {
                return "got " + chunk.Count + " bytes from offset " + _offset + ", the asset has " + chunk.Size;
            }
            if (chunk.Count == 0 && _offset < chunk.Size)
            {
                return "got no bytes from offset " + _offset + ", the asset has " + chunk.Size;
            }
            _asset ??= new byte[chunk.Size];
            Buffer.BlockCopy(_chunk, 0, _asset, _offset, chunk.Count);
            _offset += chunk.Count;
            return null;
        }

        private struct Chunk
        {
            internal long Offset;
            internal long Size;
            internal int Count; // of its bytes
        }

        private struct Progress
        {
            internal bool IsEnd; // nothing more was asked for
            internal string Problem; // null unless something is wrong
        }
    }
}
