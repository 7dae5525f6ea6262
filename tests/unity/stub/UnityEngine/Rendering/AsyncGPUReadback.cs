// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using Unity.Collections;
using UnityEngine.Stage;

namespace UnityEngine.Rendering
{
    public static class AsyncGPUReadback
    {
        private static readonly Queue<Action> Pending = new Queue<Action>();

        public static AsyncGPUReadbackRequest Request(
            Texture src, int mipIndex, TextureFormat dstFormat, Action<AsyncGPUReadbackRequest> callback)
        {
            MainThread.Check("Request");
            var request = new AsyncGPUReadbackRequest(src);
            Pending.Enqueue(() => callback(request));
            return request;
        }

        /// <summary>The GPU has done what earlier frames have asked for.</summary>
        internal static void Complete()
        {
            for (int count = Pending.Count; count > 0; count--)
            {
                Pending.Dequeue()();
            }
        }
    }

    public struct AsyncGPUReadbackRequest
    {
        private readonly Texture _source;

        internal AsyncGPUReadbackRequest(Texture source)
        {
            _source = source;
        }

        public bool hasError
        {
            get { return _source == null || Gpu.Fails; }
        }

        /// <summary>Black and transparent: there are no pixels on the GPU.</summary>
        public NativeArray<T> GetData<T>(int layer = 0)
            where T : struct
        {
            MainThread.Check("GetData");
            return new NativeArray<T>(new T[4 * _source.width * _source.height]);
        }
    }
}

namespace UnityEngine.Experimental.Rendering
{
    public enum GraphicsFormat
    {
        R8G8B8A8_SRGB = 4,
    }
}

namespace Unity.Collections
{
    public struct NativeArray<T>
        where T : struct
    {
        private readonly T[] _values;

        internal NativeArray(T[] values)
        {
            _values = values;
        }

        public int Length
        {
            get { return _values.Length; }
        }

        public void CopyTo(T[] array)
        {
            if (array.Length != _values.Length)
            {
                throw new ArgumentException("source and destination length must be the same");
            }
            _values.CopyTo(array, 0);
        }
    }
}
