// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Collections.Generic;
using System.Linq;

namespace UnityEditor
{
    public static class TypeCache
    {
        public static TypeCollection GetTypesDerivedFrom<T>()
        {
            return new TypeCollection(AppDomain.CurrentDomain.GetAssemblies()
                .SelectMany(assembly => assembly.GetTypes())
                .Where(type => typeof(T).IsAssignableFrom(type) && type != typeof(T)));
        }

        public struct TypeCollection : IEnumerable<Type>
        {
            private readonly IEnumerable<Type> _types;

            internal TypeCollection(IEnumerable<Type> types)
            {
                _types = types;
            }

            IEnumerator<Type> IEnumerable<Type>.GetEnumerator()
            {
                return _types.GetEnumerator();
            }

            IEnumerator IEnumerable.GetEnumerator()
            {
                return _types.GetEnumerator();
            }
        }
    }
}
