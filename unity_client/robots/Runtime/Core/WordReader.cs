// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text;

namespace Ros2Gateway.Robots
{
    /// <summary>Reads a text's words and numbers, from bytes of ASCII without a string of each.</summary>
    internal sealed class WordReader
    {
        private const int MaxDigits = 18; // so many fit into 64 bits. Float32 needs 9
        private const int MaxExponent = 1000; // beyond, all is 0 or infinite
        private const int MaxShown = 40; // of what is repeated to people

        private readonly byte[] _text;
        private int _start; // of the word at hand
        private int _end; // behind it

        internal WordReader(byte[] text)
        {
            _text = text;
            _start = _end = Start(text);
        }

        /// <summary>Whether there is no word at hand, as the text has ended.</summary>
        internal bool IsOver => _start == _end;

        /// <summary>The line of the word at hand, counted from 1.</summary>
        internal int Line
        {
            get
            {
                int line = 1;
                for (int i = 0; i < _start; i++)
                {
                    line += _text[i] == '\n' ? 1 : 0;
                }
                return line;
            }
        }

        /// <summary>The word at hand, for people.</summary>
        internal string Shown
        {
            get
            {
                int count = Math.Min(_end - _start, MaxShown);
                return count == 0 ? "the end" : "'" + Encoding.ASCII.GetString(_text, _start, count) + "'";
            }
        }

        /// <summary>The earliest place of the first word: behind a byte order mark of UTF-8.</summary>
        internal static int Start(byte[] text) =>
            text.Length >= 3 && text[0] == 0xEF && text[1] == 0xBB && text[2] == 0xBF ? 3 : 0;

        /// <summary>Goes to the next word. False at the end.</summary>
        internal bool Next()
        {
            byte[] text = _text;
            int at = _end;
            while (at < text.Length && text[at] <= ' ')
            {
                at++;
            }
            _start = at;
            while (at < text.Length && text[at] > ' ')
            {
                at++;
            }
            _end = at;
            return _start < at;
        }

        /// <summary>Leaves out what follows on the line.</summary>
        internal void SkipLine()
        {
            while (_end < _text.Length && _text[_end] != '\n' && _text[_end] != '\r')
            {
                _end++;
            }
        }

        /// <summary>Whether the word at hand is this one, in capitals or not.</summary>
        /// <param name="word">In small letters.</param>
        internal bool Is(string word)
        {
            if (_end - _start != word.Length)
            {
                return false;
            }
            for (int i = 0; i < word.Length; i++)
            {
                if ((_text[_start + i] | 0x20) != word[i])
                {
                    return false;
                }
            }
            return true;
        }

        /// <summary>
        /// Whether the word at hand is a number that float32 has: [+-]digits[.digits][e[+-]digits], in every locale.
        /// </summary>
        internal bool TryFloat(out float value)
        {
            bool isNumber = TryParse(out double wide);
            value = (float)wide;
            return isNumber && !float.IsInfinity(value);
        }

        /// <summary>Whether the word at hand is an integer from 0 on that int has.</summary>
        internal bool TryIndex(out int value)
        {
            long wide = 0;
            int at = _start;
            for (; at < _end && (uint)(_text[at] - '0') <= 9 && wide <= int.MaxValue; at++)
            {
                wide = 10 * wide + (_text[at] - '0');
            }
            value = (int)wide;
            return at > _start && at == _end && wide <= int.MaxValue;
        }

        private bool TryParse(out double value)
        {
            value = 0;
            int at = _start;
            bool isNegative = SkipSign(ref at);
            ulong mantissa = 0;
            long exponent = 0;
            int digits = 0; // of the mantissa, without zeros before it
            bool hasDigits = false, hasPoint = false;
            for (; at < _end; at++)
            {
                uint digit = (uint)(_text[at] - '0');
                if (digit > 9)
                {
                    if (_text[at] != '.' || hasPoint)
                    {
                        break;
                    }
                    hasPoint = true;
                    continue;
                }
                hasDigits = true;
                bool fits = digits < MaxDigits;
                if (fits)
                {
                    mantissa = 10 * mantissa + digit;
                    digits += mantissa > 0 ? 1 : 0;
                }
                exponent += (fits ? 0 : 1) - (hasPoint ? 1 : 0);
            }
            if (!hasDigits || (at < _end && !TryAddExponent(at, ref exponent)))
            {
                return false;
            }
            if (mantissa > 0) // 0 times infinity would not be 0
            {
                double power = Math.Pow(10, Math.Abs(exponent));
                value = exponent < 0 ? mantissa / power : mantissa * power;
            }
            value = isNegative ? -value : value;
            return true;
        }

        private bool TryAddExponent(int at, ref long exponent)
        {
            if ((_text[at] | 0x20) != 'e')
            {
                return false;
            }
            at++;
            bool isNegative = SkipSign(ref at);
            int first = at;
            int power = 0;
            for (; at < _end && (uint)(_text[at] - '0') <= 9; at++)
            {
                power = Math.Min(10 * power + (_text[at] - '0'), MaxExponent);
            }
            exponent += isNegative ? -power : power;
            return at > first && at == _end;
        }

        private bool SkipSign(ref int at)
        {
            bool isNegative = at < _end && _text[at] == '-';
            at += isNegative || (at < _end && _text[at] == '+') ? 1 : 0;
            return isNegative;
        }
    }
}
