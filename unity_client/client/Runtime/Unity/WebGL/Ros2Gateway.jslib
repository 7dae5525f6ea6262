// SPDX-License-Identifier: Apache-2.0
// WebSockets for WebGL builds, to be polled: nothing in here calls into wasm. WebGlSocket.cs declares it.
//
// Text crosses the border as UTF-8 with its length, so that no string function of Emscripten is needed: which
// of them are there without being asked for, and how to ask, differs between the Unity versions. The syntax
// is ES5, as Emscripten prints these functions into the build as text and older ones parse no more; for the
// same reason only the object below has state, and functions reach it by its name.

var Ros2GatewaySocketLibrary = {
    $Ros2GatewaySockets: {
        sockets: {},
        lastHandle: 0,

        CLOSED: 3, // WebSocket.readyState's numbers
        GOODBYE_MS: 1000, // how long a peer may take to answer a close frame
        REASON_BYTES: 123, // RFC 6455, 5.5: what fits into a close frame beside the code
        FRAME_BYTES: 256, // what a waiting frame costs beside its text: many small ones have a bound, too

        text: function (pointer, bytes) {
            // A copy, as a TextDecoder takes no view of memory that threads share.
            return new TextDecoder().decode(HEAPU8.slice(pointer >>> 0, (pointer >>> 0) + bytes));
        },

        bytes: function (text) {
            return new TextEncoder().encode(text);
        },

        open: function (url, maxMessageBytes, maxInboxBytes) {
            var socket = {
                webSocket: null,
                state: 0,
                inbox: [], // frames from head on; of one that was too long only the size
                head: 0,
                inboxBytes: 0,
                maxMessageBytes: maxMessageBytes,
                maxInboxBytes: maxInboxBytes,
                closing: null, // code and reason of a close from here
                code: 0,
                reason: '',
                timer: 0
            };
            try {
                socket.webSocket = new WebSocket(url);
            } catch (error) {
                // No URL, or a page from https: may not open ws:.
                Ros2GatewaySockets.finish(socket, 0, 'cannot connect to ' + url + ': ' + error.message);
                return socket;
            }
            socket.webSocket.binaryType = 'arraybuffer';
            socket.webSocket.onopen = function () {
                socket.state = 1;
            };
            socket.webSocket.onmessage = function (event) {
                Ros2GatewaySockets.take(socket, event.data);
            };
            socket.webSocket.onclose = function (event) {
                var code = event.code;
                var reason = event.reason;
                if (code === 1006) { // never on the wire: the browser's word for a failure
                    code = 0;
                    reason = socket.state === 0
                        ? 'cannot connect, the browser does not tell why'
                        : 'the connection was lost';
                } else if (code === 1005) { // the peer gave no code
                    code = 0;
                }
                Ros2GatewaySockets.finish(socket, code, reason);
            };
            return socket;
        },

        take: function (socket, data) {
            if (socket.closing !== null && socket.closing.code === 4000) {
                return; // nobody read, nobody will
            }
            var frame = typeof data === 'string' ? Ros2GatewaySockets.bytes(data) : new Uint8Array(data);
            var kept = frame.length <= socket.maxMessageBytes;
            var cost = (kept ? frame.length : 0) + Ros2GatewaySockets.FRAME_BYTES;
            if (socket.inboxBytes + cost > socket.maxInboxBytes) {
                // Nobody here can tell which frame may be dropped; a new connection begins with the newest.
                socket.inbox = [];
                socket.head = 0;
                socket.inboxBytes = 0;
                Ros2GatewaySockets.close(socket, 4000, 'page does not read');
                return;
            }
            socket.inbox.push({ size: frame.length, bytes: kept ? frame : null, cost: cost });
            socket.inboxBytes += cost;
        },

        drop: function (socket) {
            socket.inboxBytes -= socket.inbox[socket.head].cost;
            socket.inbox[socket.head] = null;
            socket.head += 1;
            // Now and then, as shifting a long array frame by frame takes time.
            if (socket.head === socket.inbox.length || socket.head === 1024) {
                socket.inbox = socket.inbox.slice(socket.head);
                socket.head = 0;
            }
        },

        close: function (socket, code, reason) {
            if (socket.closing !== null || socket.state === Ros2GatewaySockets.CLOSED) {
                return;
            }
            socket.closing = { code: code, reason: reason };
            while (Ros2GatewaySockets.bytes(reason).length > Ros2GatewaySockets.REASON_BYTES) {
                reason = reason.slice(0, -1);
            }
            // Browsers refuse the codes that the specification keeps for itself.
            socket.webSocket.close(code >= 3000 && code <= 4999 ? code : 1000, reason);
            socket.timer = setTimeout(function () {
                Ros2GatewaySockets.finish(socket, code, reason);
            }, Ros2GatewaySockets.GOODBYE_MS);
        },

        finish: function (socket, code, reason) {
            Ros2GatewaySockets.detach(socket);
            socket.state = Ros2GatewaySockets.CLOSED;
            socket.code = socket.closing === null ? code : socket.closing.code;
            socket.reason = socket.closing === null ? reason : socket.closing.reason;
        },

        detach: function (socket) {
            clearTimeout(socket.timer);
            if (socket.webSocket !== null) {
                socket.webSocket.onopen = null;
                socket.webSocket.onmessage = null;
                socket.webSocket.onclose = null;
            }
        }
    },

    // Begins to connect and returns a handle, whatever comes of it.
    Ros2GatewaySocketOpen: function (url, urlBytes, maxMessageBytes, maxInboxBytes) {
        var address = Ros2GatewaySockets.text(url, urlBytes);
        Ros2GatewaySockets.lastHandle += 1;
        Ros2GatewaySockets.sockets[Ros2GatewaySockets.lastHandle] =
            Ros2GatewaySockets.open(address, maxMessageBytes, maxInboxBytes);
        return Ros2GatewaySockets.lastHandle;
    },

    // 0 connecting, 1 open, 2 closing, 3 closed; frames may wait in every state.
    Ros2GatewaySocketState: function (handle) {
        var socket = Ros2GatewaySockets.sockets[handle];
        return socket.state === 1 && socket.closing !== null ? 2 : socket.state;
    },

    // Bytes of the frame that waits longest, -1 where none waits.
    Ros2GatewaySocketFrameBytes: function (handle) {
        var socket = Ros2GatewaySockets.sockets[handle];
        return socket.inbox.length === 0 ? -1 : socket.inbox[socket.head].size;
    },

    // Moves that frame to the buffer and returns its bytes, 0 for one beyond the limit, which is gone now. -1
    // where none waits or it does not fit; then it stays.
    Ros2GatewaySocketReceive: function (handle, buffer, capacity) {
        var socket = Ros2GatewaySockets.sockets[handle];
        if (socket.inbox.length === 0) {
            return -1;
        }
        var frame = socket.inbox[socket.head];
        if (frame.bytes !== null) {
            if (frame.size > capacity) {
                return -1;
            }
            HEAPU8.set(frame.bytes, buffer >>> 0);
        }
        Ros2GatewaySockets.drop(socket);
        return frame.bytes === null ? 0 : frame.size;
    },

    // Copies a text frame to the browser and returns 1, or 0 where the socket is not open.
    Ros2GatewaySocketSend: function (handle, buffer, bytes) {
        var socket = Ros2GatewaySockets.sockets[handle];
        if (socket.state !== 1 || socket.closing !== null) {
            return 0;
        }
        socket.webSocket.send(Ros2GatewaySockets.text(buffer, bytes));
        return 1;
    },

    // Bytes that the browser has taken and the network has not.
    Ros2GatewaySocketBufferedBytes: function (handle) {
        var socket = Ros2GatewaySockets.sockets[handle];
        return socket.webSocket === null ? 0 : Math.min(socket.webSocket.bufferedAmount, 0x7fffffff);
    },

    Ros2GatewaySocketClose: function (handle, code, reason, reasonBytes) {
        var text = Ros2GatewaySockets.text(reason, reasonBytes);
        Ros2GatewaySockets.close(Ros2GatewaySockets.sockets[handle], code, text);
    },

    // Once closed: the close code, 0 where there was none.
    Ros2GatewaySocketCloseCode: function (handle) {
        return Ros2GatewaySockets.sockets[handle].code;
    },

    // Once closed: copies the reason, as far as it fits, and returns its bytes.
    Ros2GatewaySocketCloseReason: function (handle, buffer, capacity) {
        var bytes = Ros2GatewaySockets.bytes(Ros2GatewaySockets.sockets[handle].reason).subarray(0, capacity);
        HEAPU8.set(bytes, buffer >>> 0);
        return bytes.length;
    },

    // Forgets the socket, closing it where it is not closed; the handle means nothing afterwards.
    Ros2GatewaySocketFree: function (handle) {
        var socket = Ros2GatewaySockets.sockets[handle];
        delete Ros2GatewaySockets.sockets[handle];
        Ros2GatewaySockets.detach(socket);
        if (socket.webSocket !== null) {
            socket.webSocket.close();
        }
    }
};

autoAddDeps(Ros2GatewaySocketLibrary, '$Ros2GatewaySockets');
mergeInto(LibraryManager.library, Ros2GatewaySocketLibrary);
