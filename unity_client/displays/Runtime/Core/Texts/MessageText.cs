// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Globalization;
using System.Text;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>
    /// Writes any message for people: a line per field, indented as it is nested, with long arrays and texts
    /// shortened and binary data as its size. A message of a single field "data" is its value alone. For one
    /// thread at a time. Keep it, it uses its buffers again.
    /// </summary>
    public sealed class MessageText
    {
        private const int LongestLine = 200; // characters: two lines of a screen
        private const int WholeArray = 8; // numbers that fit into a line, a quaternion and more
        private const int ShownOfLonger = 2; // numbers: enough to see that they are alive
        private const int ShownMessages = 3;
        private const int ShortestBase64 = 64; // characters: nobody writes so long a word
        private const string Indentation = "  ";

        private readonly int _maxLines;
        private readonly JsonWriter _writer = new();
        private readonly JsonReader _reader = new();
        private readonly StringBuilder _text = new();
        private readonly List<string> _elements = new();
        private int _lines;

        /// <summary>Writes so many lines at most, the last then being "...".</summary>
        public MessageText(int maxLines = 40) => _maxLines = Math.Max(1, maxLines);

        private bool IsFull => _lines > _maxLines;

        /// <summary>Returns the message as lines without a line break at the end.</summary>
        public string Of(IMessage message)
        {
            _text.Clear();
            _lines = 0;
            try
            {
                _writer.Clear();
                message.Write(_writer);
            }
            catch (InvalidOperationException error) // an array of fixed length has another
            {
                return error.Message;
            }
            if (HasOnlyData())
            {
                Begin();
                _reader.NextName();
                Value("", 0);
            }
            else
            {
                Begin();
                Members(0);
            }
            return _text.ToString();
        }

        private bool HasOnlyData()
        {
            Begin();
            if (_reader.NextName() != "data")
            {
                return false;
            }
            _reader.Skip();
            return _reader.NextName() == null;
        }

        private void Begin()
        {
            _reader.Reset(_writer.Buffer, 0, _writer.Count);
            _reader.BeginObject();
        }

        private void Members(int depth)
        {
            // once the text is full, nobody needs the rest of the message
            for (string name = _reader.NextName(); name != null && !IsFull; name = _reader.NextName())
            {
                Value(name, depth);
                if (IsFull)
                {
                    return;
                }
            }
        }

        private void Value(string name, int depth)
        {
            switch (_reader.Kind)
            {
                case JsonKind.Object:
                    Line(depth, name, "");
                    _reader.BeginObject();
                    Members(depth + 1);
                    break;
                case JsonKind.Array:
                    Elements(name, depth);
                    break;
                case JsonKind.String:
                    string text = Text();
                    if (name.Length > 0)
                    {
                        Line(depth, name, text.Replace("\n", "\\n"));
                        break;
                    }
                    foreach (string line in text.Split('\n'))
                    {
                        Line(depth, name, line);
                    }
                    break;
                default:
                    Line(depth, name, Scalar());
                    break;
            }
        }

        private void Elements(string name, int depth)
        {
            int count = 0;
            bool hasNested = false;
            _elements.Clear();
            _reader.BeginArray();
            while (_reader.NextElement())
            {
                bool isNested = _reader.Kind == JsonKind.Object || _reader.Kind == JsonKind.Array;
                if (isNested && !hasNested)
                {
                    hasNested = true;
                    Line(depth, name, "");
                }
                count++;
                if (isNested && count <= ShownMessages)
                {
                    Value("[" + (count - 1).ToString(CultureInfo.InvariantCulture) + "]", depth + 1);
                    if (IsFull)
                    {
                        return;
                    }
                }
                else if (isNested || count > WholeArray)
                {
                    _reader.Skip();
                }
                else
                {
                    _elements.Add(Scalar());
                }
            }
            string all = "... " + count.ToString(CultureInfo.InvariantCulture);
            if (hasNested)
            {
                if (count > ShownMessages)
                {
                    Line(depth + 1, "", all);
                }
                return;
            }
            if (count > WholeArray)
            {
                _elements.RemoveRange(ShownOfLonger, _elements.Count - ShownOfLonger);
                _elements.Add(all);
            }
            Line(depth, name, "[" + string.Join(", ", _elements) + "]");
        }

        private string Scalar()
        {
            switch (_reader.Kind)
            {
                case JsonKind.String:
                    return Text();
                case JsonKind.Boolean:
                    return _reader.ReadBool() ? "true" : "false";
                case JsonKind.Null:
                    _reader.TryReadNull();
                    return "nan"; // which JSON has not
                default:
                    bool isNegative;
                    ulong magnitude;
                    double number;
                    if (_reader.ReadNumber(out isNegative, out magnitude, out number))
                    {
                        return (isNegative ? "-" : "") + magnitude.ToString(CultureInfo.InvariantCulture);
                    }
                    return number.ToString("G6", CultureInfo.InvariantCulture);
            }
        }

        private string Text()
        {
            int bytes = Base64Bytes();
            if (bytes > 0)
            {
                _reader.Skip();
                return bytes.ToString(CultureInfo.InvariantCulture) + " bytes";
            }
            return _reader.ReadString();
        }

        /// <summary>How many bytes the string that comes next stands for. 0 if it does not look like base64.
        /// </summary>
        private int Base64Bytes()
        {
            byte[] buffer = _writer.Buffer;
            int start = _reader.Position + 1; // behind the quote
            int end = start;
            while (end < _writer.Count && IsBase64(buffer[end]))
            {
                end++;
            }
            int padding = 0;
            while (end < _writer.Count && buffer[end] == (byte)'=' && padding < 2)
            {
                padding++;
                end++;
            }
            int length = end - start;
            bool isWhole = end < _writer.Count && buffer[end] == (byte)'"';
            return isWhole && length >= ShortestBase64 && length % 4 == 0 ? length / 4 * 3 - padding : 0;
        }

        private static bool IsBase64(byte character) =>
            (character >= 'A' && character <= 'Z') || (character >= 'a' && character <= 'z')
                || (character >= '0' && character <= '9') || character == '+' || character == '/';

        private void Line(int depth, string name, string value)
        {
            if (IsFull)
            {
                return;
            }
            _lines++;
            if (_text.Length > 0)
            {
                _text.Append('\n');
            }
            if (IsFull)
            {
                _text.Append("...");
                return;
            }
            for (int i = 0; i < depth; i++)
            {
                _text.Append(Indentation);
            }
            if (name.Length > 0)
            {
                _text.Append(name).Append(value.Length > 0 ? ": " : ":");
            }
            if (value.Length <= LongestLine)
            {
                _text.Append(value);
            }
            else
            {
                _text.Append(value, 0, LongestLine).Append("... ").Append(value.Length).Append(" characters");
            }
        }
    }
}
