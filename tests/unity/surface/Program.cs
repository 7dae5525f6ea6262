// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Globalization;
using System.Linq;
using System.Reflection;

namespace Ros2Gateway.Surface
{
    /// <summary>Prints what assemblies offer, a member a line: <c>surface STUB.dll ...</c>. Left out are
    /// the stage's own controls, overrides, and constructors without arguments.</summary>
    public static class Program
    {
        private const BindingFlags Declared = BindingFlags.Instance | BindingFlags.Static
            | BindingFlags.Public | BindingFlags.NonPublic | BindingFlags.DeclaredOnly;

        private static readonly Dictionary<Type, string> Keywords = new Dictionary<Type, string>
        {
            { typeof(void), "void" }, { typeof(bool), "bool" }, { typeof(byte), "byte" },
            { typeof(int), "int" },
            { typeof(float), "float" }, { typeof(double), "double" }, { typeof(string), "string" },
            { typeof(object), "object" },
        };

        public static int Main(string[] paths)
        {
            var lines = new SortedSet<string>(StringComparer.Ordinal);
            foreach (string path in paths)
            {
                foreach (Type type in Assembly.LoadFrom(path).GetTypes())
                {
                    if (type.IsVisible && type.Namespace != "UnityEngine.Stage")
                    {
                        lines.UnionWith(Lines(type));
                    }
                }
            }
            foreach (string line in lines)
            {
                Console.WriteLine(line);
            }
            return 0;
        }

        private static IEnumerable<string> Lines(Type type)
        {
            string name = (type.Namespace + "." + Name(type)).Replace("..", ".");
            yield return name + " : " + Kind(type);
            if (type.IsSubclassOf(typeof(Delegate)))
            {
                yield break;
            }
            foreach (MemberInfo member in type.GetMembers(Declared))
            {
                string words = Words(member, type);
                if (words != null)
                {
                    yield return name + " { " + words + " }";
                }
            }
        }

        private static string Kind(Type type)
        {
            if (type.IsEnum)
            {
                return "enum";
            }
            if (type.IsSubclassOf(typeof(Delegate)))
            {
                return "delegate " + Signature(type.GetMethod("Invoke"), "");
            }
            if (type.IsValueType)
            {
                return "struct";
            }
            if (type.IsInterface)
            {
                return "interface";
            }
            bool isStatic = type.IsAbstract && type.IsSealed;
            string modifier = isStatic ? "static " : type.IsAbstract ? "abstract " : "";
            return modifier + "class" + (type.BaseType == typeof(object) ? "" : " " + Name(type.BaseType));
        }

        private static string Words(MemberInfo member, Type type)
        {
            var field = member as FieldInfo;
            if (field != null)
            {
                return Words(field, type);
            }
            var property = member as PropertyInfo;
            if (property != null)
            {
                return Words(property);
            }
            var happening = member as EventInfo;
            if (happening != null)
            {
                return "event " + Name(happening.EventHandlerType) + " " + happening.Name;
            }
            var constructor = member as ConstructorInfo;
            if (constructor != null)
            {
                bool isOffered = IsOffered(constructor) && constructor.GetParameters().Length > 0;
                return isOffered ? "new(" + Parameters(constructor) + ")" : null;
            }
            var method = member as MethodInfo;
            bool isOperator = method != null && method.Name.StartsWith("op_", StringComparison.Ordinal);
            if (method == null || !IsOffered(method) || IsOverride(method)
                || (method.IsSpecialName && !isOperator))
            {
                return null;
            }
            bool isEquals = method.Name == "Equals" || method.Name == "GetEnumerator";
            return isEquals && !method.IsStatic ? null : Signature(method, method.Name);
        }

        private static string Words(FieldInfo field, Type type)
        {
            if (!field.IsPublic || field.IsSpecialName)
            {
                return null;
            }
            if (type.IsEnum)
            {
                return field.Name + " = "
                    + Convert.ToString(field.GetRawConstantValue(), CultureInfo.InvariantCulture);
            }
            string modifier = field.IsLiteral ? "const " : field.IsStatic ? "static " : "";
            return modifier + (field.IsInitOnly ? "readonly " : "") + Name(field.FieldType) + " "
                + field.Name;
        }

        private static string Words(PropertyInfo property)
        {
            MethodInfo getter = property.GetGetMethod(true);
            MethodInfo setter = property.GetSetMethod(true);
            if (getter == null || !IsOffered(getter) || IsOverride(getter))
            {
                return null;
            }
            string index = property.GetIndexParameters().Length == 0 ? "" : "[" + Parameters(getter) + "]";
            string accessors = setter != null && setter.IsPublic ? " get set" : " get";
            return (getter.IsStatic ? "static " : "") + Name(property.PropertyType) + " " + property.Name
                + index + accessors;
        }

        private static string Signature(MethodInfo method, string name)
        {
            string generic = method.IsGenericMethod
                ? "<" + string.Join(", ", method.GetGenericArguments().Select(Name).ToArray()) + ">"
                : "";
            return (method.IsStatic ? "static " : "") + Name(method.ReturnType) + " " + name + generic
                + "(" + Parameters(method) + ")";
        }

        private static string Parameters(MethodBase method)
        {
            return string.Join(", ", method.GetParameters().Select(
                p => (p.IsOut ? "out " : p.IsDefined(typeof(ParamArrayAttribute), false) ? "params " : "")
                    + Name(p.ParameterType)).ToArray());
        }

        private static bool IsOffered(MethodBase method)
        {
            return method.IsPublic || method.IsFamily;
        }

        private static bool IsOverride(MethodInfo method)
        {
            return method.GetBaseDefinition() != method;
        }

        private static string Name(Type type)
        {
            if (type.IsByRef)
            {
                return Name(type.GetElementType());
            }
            if (type.IsArray)
            {
                return Name(type.GetElementType()) + "[]";
            }
            string keyword;
            if (Keywords.TryGetValue(type, out keyword))
            {
                return keyword;
            }
            string outer = type.IsNested && !type.IsGenericParameter ? Name(type.DeclaringType) + "." : "";
            if (!type.IsGenericType)
            {
                return outer + type.Name;
            }
            string[] arguments = type.GetGenericArguments().Select(Name).ToArray();
            return outer + type.Name.Split('`')[0] + "<" + string.Join(", ", arguments) + ">";
        }
    }
}
