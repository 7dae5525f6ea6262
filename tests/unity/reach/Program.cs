// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Linq;
using System.Reflection;
using System.Reflection.Emit;

namespace Ros2Gateway.Reach
{
    /// <summary>
    /// Prints the messages that code refers to, as a linker follows it: <c>reach ROOT.dll ...</c>. Everything in the
    /// assemblies that are named is a root, except that of those for scenes only their components are.
    /// </summary>
    /// <remarks>
    /// It keeps more than Unity's linker does: of a type that is mentioned all constructors and virtual methods. So
    /// what is not printed is not kept there either.
    /// </remarks>
    public static class Program
    {
        private const BindingFlags Declared = BindingFlags.Instance | BindingFlags.Static
            | BindingFlags.Public | BindingFlags.NonPublic | BindingFlags.DeclaredOnly;

        private static readonly Dictionary<short, OpCode> Codes = typeof(OpCodes).GetFields()
            .Select(field => (OpCode)field.GetValue(null)).ToDictionary(code => code.Value);

        private static readonly string[] OfScenes = { "Ros2Gateway.Unity", "Ros2Gateway.Displays", "Ros2Gateway.Robots" };

        private static readonly HashSet<Type> Types = new HashSet<Type>();
        private static readonly HashSet<MethodBase> Methods = new HashSet<MethodBase>();
        private static readonly Queue<MethodBase> Waiting = new Queue<MethodBase>();

        public static int Main(string[] paths)
        {
            foreach (Type type in paths.SelectMany(path => Assembly.LoadFrom(path).GetTypes()).Where(IsRoot))
            {
                Touch(type);
                foreach (MethodBase method in type.GetMethods(Declared))
                {
                    Call(method);
                }
            }
            while (Waiting.Count > 0)
            {
                Follow(Waiting.Dequeue());
            }
            foreach (string name in Types.Where(IsMessage).Select(type => type.FullName).OrderBy(name => name))
            {
                Console.WriteLine(name);
            }
            return 0;
        }

        private static bool IsRoot(Type type)
        {
            return !type.ContainsGenericParameters
                && (!OfScenes.Contains(type.Assembly.GetName().Name) || IsComponent(type));
        }

        private static bool IsComponent(Type type)
        {
            for (Type each = type; each != null; each = each.BaseType)
            {
                if (each.FullName == "UnityEngine.MonoBehaviour" || each.FullName == "UnityEngine.ScriptableObject")
                {
                    return true;
                }
            }
            return false;
        }

        private static bool IsMessage(Type type)
        {
            return type.Namespace != null && type.Namespace.StartsWith("Ros2Gateway.Messages.")
                && type.GetInterface("IMessage") != null;
        }

        private static void Touch(Type type)
        {
            if (type == null || type.IsGenericParameter)
            {
                return;
            }
            if (type.HasElementType)
            {
                Touch(type.GetElementType());
                return;
            }
            foreach (Type argument in type.GetGenericArguments())
            {
                Touch(argument);
            }
            if (!IsOurs(type) || !Types.Add(type))
            {
                return;
            }
            Touch(type.BaseType);
            foreach (MethodBase method in type.GetConstructors(Declared))
            {
                Call(method);
            }
            foreach (MethodInfo method in type.GetMethods(Declared).Where(method => method.IsVirtual))
            {
                Call(method);
            }
        }

        private static void Call(MethodBase method)
        {
            if (method.IsGenericMethod)
            {
                foreach (Type argument in method.GetGenericArguments())
                {
                    Touch(argument);
                }
            }
            Touch(method.DeclaringType);
            if (method.DeclaringType != null && IsOurs(method.DeclaringType) && Methods.Add(method))
            {
                Waiting.Enqueue(method);
            }
        }

        // types of .NET and Unity refer to no message
        private static bool IsOurs(Type type)
        {
            string name = type.Assembly.GetName().Name;
            return name != "mscorlib" && !name.StartsWith("System") && !name.StartsWith("Unity");
        }

        private static void Follow(MethodBase method)
        {
            MethodBody body = method.GetMethodBody();
            if (body == null)
            {
                return; // of an interface
            }
            byte[] code = body.GetILAsByteArray();
            Type[] ofType = method.DeclaringType.GetGenericArguments();
            Type[] ofMethod = method.IsGenericMethod ? method.GetGenericArguments() : new Type[0];
            int at = 0;
            while (at < code.Length)
            {
                OpCode opCode = code[at] == 0xFE ? Codes[(short)(0xFE00 | code[at + 1])] : Codes[code[at]];
                at += opCode.Size;
                switch (opCode.OperandType)
                {
                    case OperandType.InlineField:
                    case OperandType.InlineMethod:
                    case OperandType.InlineTok:
                    case OperandType.InlineType:
                        Note(method.Module.ResolveMember(BitConverter.ToInt32(code, at), ofType, ofMethod));
                        break;
                }
                at += Size(opCode.OperandType, code, at);
            }
        }

        private static void Note(MemberInfo member)
        {
            MethodBase method = member as MethodBase;
            if (method != null)
            {
                Call(method);
            }
            Touch(member as Type ?? member.DeclaringType);
        }

        private static int Size(OperandType operand, byte[] code, int at)
        {
            switch (operand)
            {
                case OperandType.InlineNone:
                    return 0;
                case OperandType.ShortInlineBrTarget:
                case OperandType.ShortInlineI:
                case OperandType.ShortInlineVar:
                    return 1;
                case OperandType.InlineVar:
                    return 2;
                case OperandType.InlineI8:
                case OperandType.InlineR:
                    return 8;
                case OperandType.InlineSwitch:
                    return 4 + 4 * BitConverter.ToInt32(code, at);
                default:
                    return 4;
            }
        }
    }
}
