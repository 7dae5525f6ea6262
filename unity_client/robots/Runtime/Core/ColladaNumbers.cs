// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using System.Text;

namespace Ros2Gateway.Robots
{
    /// <summary>Reads the lists of numbers that COLLADA has as text.</summary>
    internal static class ColladaNumbers
    {
        /// <summary>Finite numbers, of which there are at least so many.</summary>
        /// <param name="where">For the words of an error.</param>
        internal static float[] Floats(string text, int atLeast, string where)
        {
            WordReader words = Words(text);
            List<float> numbers = new(atLeast);
            while (words.Next())
            {
                if (!words.TryFloat(out float number))
                {
                    throw Unexpected(where, "a finite number", words);
                }
                numbers.Add(number);
            }
            if (numbers.Count < atLeast)
            {
                throw new MeshException(
                    "the COLLADA file's " + where + " has " + numbers.Count + " numbers, must have " + atLeast);
            }
            return numbers.ToArray();
        }

        /// <summary>Integers from 0 on.</summary>
        internal static List<int> Indices(string text, string where)
        {
            WordReader words = Words(text);
            List<int> numbers = new();
            while (words.Next())
            {
                if (!words.TryIndex(out int number))
                {
                    throw Unexpected(where, "an integer from 0 on", words);
                }
                numbers.Add(number);
            }
            return numbers;
        }

        private static WordReader Words(string text)
        {
            return new WordReader(Encoding.ASCII.GetBytes(text)); // text outside ASCII is not a number
        }

        private static MeshException Unexpected(string where, string expected, WordReader words) => new MeshException(
            "the COLLADA file's " + where + ": expected " + expected + ", got " + words.Shown);
    }
}
