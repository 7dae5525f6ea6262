// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Globalization;
using Ros2Gateway.Messages;

namespace Ros2Gateway.Editor
{
    /// <summary>The types that have classes, with their numbers, to be searched by name or number.</summary>
    public sealed class TypeCatalogue
    {
        private readonly Dictionary<string, int> _numbers = new();

        /// <summary>Reads the list of message types's numbers.</summary>
        public TypeCatalogue()
        {
            while (true)
            {
                string type = MessageCatalogue.Resolve(Count.ToString(CultureInfo.InvariantCulture));
                if (type == null)
                {
                    break;
                }
                _numbers[type] = Count;
                Count++;
            }
        }

        /// <summary>How many numbers there are: from 0 to one less.</summary>
        public int Count { get; private set; }

        /// <summary>
        /// The types that a search finds: part of a name in any case, a number, or nothing for all of them.
        /// Those with a number first, by it, then the others by name.
        /// </summary>
        public IList<string> Find(string search)
        {
            string wanted = (search ?? "").Trim();
            bool isNumber = wanted.Length > 0 && char.IsDigit(wanted[0]);
            string ofNumber = isNumber ? MessageCatalogue.Resolve(wanted) : null;
            List<string> found = new();
            foreach (string type in MessageCatalogue.Types)
            {
                bool isNamed = type.IndexOf(wanted, StringComparison.OrdinalIgnoreCase) >= 0;
                if (type.Contains("/msg/") && (isNamed || type == ofNumber))
                {
                    found.Add(type);
                }
            }
            found.Sort(Compare);
            return found;
        }

        /// <summary>The type behind its number, if it has one: "1  geometry_msgs/msg/Twist".</summary>
        public string Label(string type) =>
            _numbers.TryGetValue(type, out int number)
                ? number.ToString(CultureInfo.InvariantCulture) + "  " + type
                : type;

        private int Compare(string one, string other)
        {
            int byNumber = NumberOf(one).CompareTo(NumberOf(other));
            return byNumber != 0 ? byNumber : string.CompareOrdinal(one, other);
        }

        private int NumberOf(string type) => _numbers.TryGetValue(type, out int number) ? number : int.MaxValue;
    }
}
