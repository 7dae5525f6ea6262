// SPDX-License-Identifier: Apache-2.0
#if UNITY_WEBGL && !UNITY_EDITOR
using System.Runtime.InteropServices;

namespace Ros2Gateway.Unity
{
    // What Ros2Gateway.jslib offers. The contract of each is next to it there. Arrays cross without a copy,
    // and text as UTF-8.
    internal static class WebGlSocket
    {
        internal const int Open = 1;
        internal const int Closed = 3;

        [DllImport("__Internal", EntryPoint = "Ros2GatewaySocketOpen")]
        internal static extern int Connect(byte[] url, int urlBytes, int maxMessageBytes, int maxInboxBytes);

        [DllImport("__Internal", EntryPoint = "Ros2GatewaySocketState")]
        internal static extern int State(int handle);

        [DllImport("__Internal", EntryPoint = "Ros2GatewaySocketFrameBytes")]
        internal static extern int FrameBytes(int handle);

        [DllImport("__Internal", EntryPoint = "Ros2GatewaySocketReceive")]
        internal static extern int Receive(int handle, byte[] buffer, int capacity);

        [DllImport("__Internal", EntryPoint = "Ros2GatewaySocketSend")]
        internal static extern int Send(int handle, byte[] buffer, int bytes);

        [DllImport("__Internal", EntryPoint = "Ros2GatewaySocketBufferedBytes")]
        internal static extern int BufferedBytes(int handle);

        [DllImport("__Internal", EntryPoint = "Ros2GatewaySocketClose")]
        internal static extern void Close(int handle, int code, byte[] reason, int reasonBytes);

        [DllImport("__Internal", EntryPoint = "Ros2GatewaySocketCloseCode")]
        internal static extern int CloseCode(int handle);

        [DllImport("__Internal", EntryPoint = "Ros2GatewaySocketCloseReason")]
        internal static extern int CloseReason(int handle, byte[] buffer, int capacity);

        [DllImport("__Internal", EntryPoint = "Ros2GatewaySocketFree")]
        internal static extern void Free(int handle);
    }
}
#endif
