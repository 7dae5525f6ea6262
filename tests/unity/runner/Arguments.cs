// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Globalization;
using System.Linq;
using System.Reflection;

namespace Ros2Gateway.Runner
{
    /// <summary>A test case's arguments: as its method takes them, and in words.</summary>
    public static class Arguments
    {
        private const int LongestWord = 40;

        public static object Converted(object argument, ParameterInfo[] parameters, int index)
        {
            if (argument == null || index >= parameters.Length)
            {
                return argument;
            }
            Type type = parameters[index].ParameterType;
            bool fits = type.IsInstanceOfType(argument) || type.IsEnum || !(argument is IConvertible);
            return fits ? argument : Convert.ChangeType(argument, type, CultureInfo.InvariantCulture);
        }

        public static string Words(object[] arguments)
        {
            string words = string.Join(",", arguments.Select(Word).ToArray());
            return arguments.Length == 0 ? "" : "(" + words + ")";
        }

        private static string Word(object argument)
        {
            if (argument == null)
            {
                return "null";
            }
            var text = argument as string;
            var items = argument as IEnumerable;
            if (text == null && items != null)
            {
                return "[" + Shortened(string.Join(",", items.Cast<object>().Select(Word).ToArray())) + "]";
            }
            text = text == null
                ? Convert.ToString(argument, CultureInfo.InvariantCulture)
                : "\"" + text + "\"";
            return Shortened(new string(text.Select(c => c < ' ' || c > '~' ? '?' : c).ToArray()));
        }

        private static string Shortened(string text)
        {
            return text.Length <= LongestWord ? text : text.Substring(0, LongestWord) + "...";
        }
    }
}
