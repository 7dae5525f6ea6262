// SPDX-License-Identifier: Apache-2.0
using System;
using System.Net.WebSockets;
using System.Threading;
using System.Threading.Tasks;

namespace Ros2Gateway
{
    /// <summary>A transport on .NET's ClientWebSocket: editor, desktop players, Android and iOS.</summary>
    /// <remarks>
    /// Its rules answer what ClientWebSocket does on Mono. A connection attempt cannot be cancelled: it is
    /// abandoned instead, and keeps its socket for as long as the server stays silent. Pings are answered
    /// only while a receive is pending, and one always is. After a local close a pending receive throws,
    /// which is normal then. It reads each message in two parts, each by way of another thread: that
    /// limits the rate, at about 10,000 messages a second.
    /// </remarks>
    public sealed class WebSocketTransport : ITransport
    {
        private const int FirstBufferBytes = 64 * 1024; // most frames. Larger ones make it grow
        private const int PieceBytes = 32 * 1024; // so that a slow link shows progress: 1 Mbit/s does it in 0.3 s
        private const int RetainedBufferBytes = 1024 * 1024; // the buffer of one rare huge frame is given back,
        private const int FramesUntilRare = 1000; // once so many were smaller: a cloud at 1 Hz next to what a robot says
        private const int GoodbyeMilliseconds = 1000; // how long a peer may take to answer a close frame

        private readonly int _connectMilliseconds;
        private readonly int _maxMessageBytes;
        private readonly ClientWebSocket _socket = new();
        private readonly CancellationTokenSource _ended = new();
        private readonly SemaphoreSlim _toSend = new(0);
        private readonly TaskCompletionSource<bool> _received = new(); // all there was
        private ITransportListener _listener;
        private byte[] _frame; // under way, or null. Set by TrySend, cleared by the sender
        private int _frameBytes;
        private int _isConnected;
        private int _isOpen;
        private int _isClosing;
        private int _closeCode;
        private string _closeReason;

        /// <param name="connectMilliseconds">How long connecting may take.</param>
        /// <param name="maxMessageBytes">Longer messages are read and thrown away.</param>
        public WebSocketTransport(int connectMilliseconds, int maxMessageBytes)
        {
            _connectMilliseconds = connectMilliseconds;
            _maxMessageBytes = maxMessageBytes;
        }

        /// <inheritdoc/>
        public void Open(Uri address, ITransportListener listener)
        {
            _listener = listener;
            // Task.Run, because resolving a name blocks, and so does the first part of ConnectAsync.
            Task.Run(() => LiveAsync(address));
        }

        /// <inheritdoc/>
        public bool TrySend(byte[] buffer, int count)
        {
            if (Volatile.Read(ref _isOpen) == 0 || Volatile.Read(ref _isClosing) == 1)
            {
                return false;
            }
            if (Interlocked.CompareExchange(ref _frame, buffer, null) != null)
            {
                return false;
            }
            _frameBytes = count;
            _toSend.Release();
            return true;
        }

        /// <inheritdoc/>
        public void Poll()
        {
        }

        /// <inheritdoc/>
        public void Close(int code, string reason)
        {
            if (Interlocked.Exchange(ref _isClosing, 1) == 1)
            {
                return;
            }
            _closeCode = code;
            _closeReason = reason;
            Task.Run(() => SayGoodbyeAsync());
        }

        /// <summary>Ends everything at once, without a goodbye.</summary>
        public void Dispose()
        {
            Interlocked.Exchange(ref _isClosing, 1);
            _ended.Cancel();
            if (Volatile.Read(ref _isConnected) == 1)
            {
                _socket.Abort(); // earlier it would do nothing but lose the socket
            }
        }

        private async Task LiveAsync(Uri address)
        {
            int code = 0;
            string reason;
            Task sender = Task.CompletedTask;
            try
            {
                await ConnectAsync(address).ConfigureAwait(false);
                Volatile.Write(ref _isConnected, 1);
                _ended.Token.ThrowIfCancellationRequested();
                Volatile.Write(ref _isOpen, 1);
                _listener.OnOpen();
                sender = SendAsync();
                reason = await ReceiveAsync().ConfigureAwait(false);
                code = (int)_socket.CloseStatus.GetValueOrDefault(0);
            }
            catch (Exception error)
            {
                // Any error is the end of this connection, and told in words.
                reason = ErrorText(error);
            }
            Volatile.Write(ref _isOpen, 0);
            if (Volatile.Read(ref _isClosing) == 1 && _closeReason != null)
            {
                code = _closeCode;
                reason = _closeReason;
            }
            Dispose();
            _received.TrySetResult(true);
            await sender.ConfigureAwait(false); // so that nothing comes after OnClosed
            _listener.OnClosed(code, reason);
        }

        private async Task ConnectAsync(Uri address)
        {
            _socket.Options.KeepAliveInterval = TimeSpan.Zero; // the client's own heartbeat notices more
            // Without a token: a cancelled attempt would leak its socket, where a forgotten one ends some time.
            Task connecting = _socket.ConnectAsync(address, CancellationToken.None);
            Task deadline = Task.Delay(_connectMilliseconds, _ended.Token);
            if (await Task.WhenAny(connecting, deadline).ConfigureAwait(false) != connecting)
            {
                Forget(connecting);
                throw new TimeoutException("no answer within " + _connectMilliseconds + " ms");
            }
            await connecting.ConfigureAwait(false);
        }

        private async Task<string> ReceiveAsync()
        {
            byte[] buffer = new byte[FirstBufferBytes];
            int count = 0;
            long skipped = 0;
            int smaller = 0; // frames, since the last that would not fit in what is kept
            while (true)
            {
                WebSocketReceiveResult result = await _socket.ReceiveAsync(
                    new ArraySegment<byte>(buffer, count, Math.Min(PieceBytes, buffer.Length - count)),
                    CancellationToken.None).ConfigureAwait(false); // Abort ends it, and a token would cost
                if (result.MessageType == WebSocketMessageType.Close)
                {
                    await AnswerCloseAsync().ConfigureAwait(false);
                    return result.CloseStatusDescription ?? "";
                }
                count += result.Count;
                if (!result.EndOfMessage)
                {
                    _listener.OnProgress();
                    if (count < buffer.Length)
                    {
                        continue;
                    }
                    if (buffer.Length < _maxMessageBytes)
                    {
                        Array.Resize(ref buffer, (int)Math.Min(2L * buffer.Length, _maxMessageBytes));
                        continue;
                    }
                    skipped += count; // too long: read on over it, so that the next frame begins where it should
                    count = 0;
                    continue;
                }
                if (skipped > 0)
                {
                    _listener.OnOversized(skipped + count);
                }
                else
                {
                    _listener.OnFrame(buffer, count);
                }
                smaller = count > RetainedBufferBytes ? 0 : smaller + 1;
                skipped = 0;
                count = 0;
                if (buffer.Length > RetainedBufferBytes && smaller >= FramesUntilRare)
                {
                    buffer = new byte[FirstBufferBytes];
                }
            }
        }

        private async Task SendAsync()
        {
            try
            {
                while (true)
                {
                    await _toSend.WaitAsync(_ended.Token).ConfigureAwait(false);
                    await _socket.SendAsync(
                        new ArraySegment<byte>(_frame, 0, _frameBytes), WebSocketMessageType.Text, true, _ended.Token)
                        .ConfigureAwait(false);
                    Volatile.Write(ref _frame, null);
                    _listener.OnSent();
                }
            }
            catch (Exception)
            {
                // Nothing can be sent any more. Mostly that is because the peer has closed, and its reason is
                // on its way to the receiver: that one tells, unless it hears nothing either.
                await Task.WhenAny(_received.Task, Task.Delay(GoodbyeMilliseconds)).ConfigureAwait(false);
                _socket.Abort();
            }
        }

        private async Task AnswerCloseAsync()
        {
            if (_socket.State == WebSocketState.CloseReceived)
            {
                Task answer = _socket.CloseOutputAsync(WebSocketCloseStatus.NormalClosure, "", _ended.Token);
                await Task.WhenAny(answer, Task.Delay(GoodbyeMilliseconds)).ConfigureAwait(false);
            }
        }

        private async Task SayGoodbyeAsync()
        {
            try
            {
                if (_socket.State == WebSocketState.Open)
                {
                    WebSocketCloseStatus code = (WebSocketCloseStatus)_closeCode;
                    Task goodbye = _socket.CloseOutputAsync(code, _closeReason, _ended.Token);
                    await Task.WhenAny(goodbye, Task.Delay(GoodbyeMilliseconds, _ended.Token)).ConfigureAwait(false);
                    // The receiver sees the peer's close frame and ends everything, or its time is up.
                    await Task.Delay(GoodbyeMilliseconds, _ended.Token).ConfigureAwait(false);
                }
            }
            catch (Exception)
            {
                // It had ended already.
            }
            Dispose();
        }

        // Nobody awaits it any more. If it ends after all, so does its socket. Its exception is looked at, or
        // it would be reported as unobserved.
        private void Forget(Task abandoned) => abandoned.ContinueWith(task =>
        {
            Exception ignored = task.Exception;
            _socket.Abort();
        });

        private static string ErrorText(Exception error)
        {
            // The outermost says only "Unable to connect to the remote server".
            Exception innermost = error;
            while (innermost.InnerException != null)
            {
                innermost = innermost.InnerException;
            }
            return string.IsNullOrEmpty(innermost.Message) ? innermost.GetType().Name : innermost.Message;
        }
    }
}
