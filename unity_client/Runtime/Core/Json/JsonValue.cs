// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Text;

namespace Ros2Gateway.Json
{
    /// <summary>
    /// A JSON value of any kind as a tree, for what has no its own class. Unchangeable, hence free to
    /// share between threads. Asking for what is not there gives <see cref="Missing"/> or the fallback, never
    /// an exception.
    /// </summary>
    public sealed class JsonValue
    {
        // Before the two below, whose initialisers need them.
        private static readonly string[] NoNames = new string[0];
        private static readonly JsonValue[] NoItems = new JsonValue[0];

        /// <summary>
        /// The result of an indexer without a value. Its kind is <see cref="JsonKind.End"/>.
        /// </summary>
        public static readonly JsonValue Missing = new JsonValue(JsonKind.End);

        /// <summary>The literal null.</summary>
        public static readonly JsonValue Null = new JsonValue(JsonKind.Null);

        private const string Infinity = "Infinity";
        private const string MinusInfinity = "-Infinity";

        private readonly JsonKind _kind;
        private string _text;
        private bool _isTrue;
        private bool _isInteger; // then _magnitude holds the number, and its sign _isNegative
        private bool _isNegative;
        private ulong _magnitude;
        private double _number;
        private string[] _names = NoNames;
        private JsonValue[] _items = NoItems; // elements, or members' values by index
        private Dictionary<string, int> _indices;

        private JsonValue(JsonKind kind)
        {
            _kind = kind;
        }

        /// <summary>The kind of this value.</summary>
        public JsonKind Kind
        {
            get { return _kind; }
        }

        /// <summary>Whether there is a value at all. Null is one.</summary>
        public bool Exists
        {
            get { return _kind != JsonKind.End; }
        }

        /// <summary>How many members or elements there are. 0 for what is neither object nor array.</summary>
        public int Count
        {
            get { return _items.Length; }
        }

        /// <summary>The names of an object's members, in the order of the text.</summary>
        public IReadOnlyList<string> Names
        {
            get { return _names; }
        }

        /// <summary>The elements of an array, or the values of an object's members.</summary>
        public IReadOnlyList<JsonValue> Items
        {
            get { return _items; }
        }

        /// <summary>The member of that name.</summary>
        public JsonValue this[string name]
        {
            get
            {
                int index = -1;
                bool isKnown = name != null && _indices != null && _indices.TryGetValue(name, out index);
                return isKnown ? _items[index] : Missing;
            }
        }

        /// <summary>The element at that index, or the value of the member at that place.</summary>
        public JsonValue this[int index]
        {
            get { return index >= 0 && index < _items.Length ? _items[index] : Missing; }
        }

        /// <summary>Makes a text. Null makes <see cref="Null"/>.</summary>
        public static implicit operator JsonValue(string v)
        {
            return v == null ? Null : new JsonValue(JsonKind.String) { _text = v };
        }

        /// <summary>Makes true or false.</summary>
        public static implicit operator JsonValue(bool v)
        {
            return new JsonValue(JsonKind.Boolean) { _isTrue = v };
        }

        /// <summary>Makes an integer.</summary>
        public static implicit operator JsonValue(int v)
        {
            return (long)v;
        }

        /// <summary>Makes an integer.</summary>
        public static implicit operator JsonValue(long v)
        {
            return OfInteger(v < 0, v < 0 ? unchecked(0UL - (ulong)v) : (ulong)v);
        }

        /// <summary>Makes an integer.</summary>
        public static implicit operator JsonValue(ulong v)
        {
            return OfInteger(false, v);
        }

        /// <summary>
        /// Makes a number. JSON has no NaN, which makes <see cref="Null"/>, and no infinities, which make
        /// the texts "Infinity" and "-Infinity".
        /// </summary>
        public static implicit operator JsonValue(double v)
        {
            if (double.IsInfinity(v))
            {
                return v > 0 ? Infinity : MinusInfinity;
            }
            return double.IsNaN(v) ? Null : new JsonValue(JsonKind.Number) { _number = v };
        }

        /// <summary>Makes an array. Null among the elements is <see cref="Null"/>.</summary>
        public static JsonValue Array(params JsonValue[] items)
        {
            return OfItems(new List<JsonValue>(items));
        }

        /// <summary>Makes an object. Of two members of one name the last wins.</summary>
        public static JsonValue Object(IEnumerable<KeyValuePair<string, JsonValue>> members)
        {
            var builder = new ObjectBuilder();
            foreach (KeyValuePair<string, JsonValue> member in members)
            {
                builder.Add(member.Key, member.Value ?? Null);
            }
            return builder.Build();
        }

        /// <summary>
        /// Returns an object like this one, but with that member. Of anything but an object, one with that
        /// member alone. <c>JsonValue.Object().With("x", 1.5).With("y", 2.5)</c> makes an object.
        /// </summary>
        public JsonValue With(string name, JsonValue value)
        {
            var builder = new ObjectBuilder();
            for (int i = 0; i < _names.Length; i++)
            {
                builder.Add(_names[i], _items[i]);
            }
            builder.Add(name, value ?? Null);
            return builder.Build();
        }

        /// <summary>Makes an object without members.</summary>
        public static JsonValue Object()
        {
            return new ObjectBuilder().Build();
        }

        /// <summary>Reads a text that holds one value.</summary>
        /// <exception cref="JsonFormatException">It is not JSON, or a number is beyond float64.</exception>
        public static JsonValue Parse(string text)
        {
            byte[] utf8;
            try
            {
                utf8 = new UTF8Encoding(false, true).GetBytes(text);
            }
            catch (EncoderFallbackException)
            {
                throw new JsonFormatException("a string has half of a surrogate pair", "", 0);
            }
            var reader = new JsonReader();
            reader.Reset(utf8, 0, utf8.Length);
            JsonValue value = Read(reader);
            reader.End();
            return value;
        }

        /// <summary>Reads the value that comes next.</summary>
        /// <exception cref="JsonFormatException">It is not JSON, or a number is beyond float64.</exception>
        public static JsonValue Read(JsonReader reader)
        {
            switch (reader.Kind)
            {
                case JsonKind.Object:
                    return ReadObject(reader);
                case JsonKind.Array:
                    var items = new List<JsonValue>();
                    reader.BeginArray();
                    while (reader.NextElement())
                    {
                        items.Add(Read(reader));
                    }
                    return OfItems(items);
                case JsonKind.String:
                    return reader.ReadString();
                case JsonKind.Boolean:
                    return reader.ReadBool();
                case JsonKind.Null:
                    reader.TryReadNull();
                    return Null;
                default:
                    bool isNegative;
                    ulong magnitude;
                    double number;
                    bool isInteger = reader.ReadNumber(out isNegative, out magnitude, out number);
                    return isInteger ? OfInteger(isNegative, magnitude) : number;
            }
        }

        /// <summary>Writes this value. <see cref="Missing"/> as null.</summary>
        public void Write(JsonWriter writer)
        {
            switch (_kind)
            {
                case JsonKind.Object:
                    writer.BeginObject();
                    for (int i = 0; i < _names.Length; i++)
                    {
                        writer.Name(_names[i]);
                        _items[i].Write(writer);
                    }
                    writer.EndObject();
                    break;
                case JsonKind.Array:
                    writer.BeginArray();
                    foreach (JsonValue item in _items)
                    {
                        item.Write(writer);
                    }
                    writer.EndArray();
                    break;
                case JsonKind.String:
                    writer.Value(_text);
                    break;
                case JsonKind.Number:
                    WriteNumber(writer);
                    break;
                case JsonKind.Boolean:
                    writer.Value(_isTrue);
                    break;
                default:
                    writer.Null();
                    break;
            }
        }

        /// <summary>
        /// The number. Null is NaN, and the texts "NaN", "Infinity" and "-Infinity" are what they name, for that
        /// is how the gateway sends them.
        /// </summary>
        public double AsDouble(double fallback = double.NaN)
        {
            if (_kind == JsonKind.String)
            {
                return _text == Infinity ? double.PositiveInfinity
                    : _text == MinusInfinity ? double.NegativeInfinity
                    : _text == "NaN" ? double.NaN : fallback;
            }
            if (_kind != JsonKind.Number)
            {
                return _kind == JsonKind.Null ? double.NaN : fallback;
            }
            return !_isInteger ? _number : _isNegative ? -(double)_magnitude : _magnitude;
        }

        /// <summary>
        /// The number if it is whole and has 64 bits. Of a uint64 beyond them, the fallback.
        /// </summary>
        public long AsLong(long fallback = 0)
        {
            if (_kind != JsonKind.Number)
            {
                return fallback;
            }
            if (!_isInteger)
            {
                bool isWhole = _number >= -9223372036854775808.0 && _number < 9223372036854775808.0
                    && Math.Floor(_number).Equals(_number);
                return isWhole ? (long)_number : fallback;
            }
            if (_isNegative)
            {
                return unchecked(-(long)_magnitude);
            }
            return _magnitude <= long.MaxValue ? (long)_magnitude : fallback;
        }

        /// <summary>The number if it is whole, not negative and has 64 bits.</summary>
        public ulong AsULong(ulong fallback = 0)
        {
            if (_isInteger && !_isNegative)
            {
                return _magnitude;
            }
            long signed = AsLong(-1);
            return signed >= 0 ? (ulong)signed : fallback;
        }

        /// <summary>The text.</summary>
        public string AsString(string fallback = "")
        {
            return _kind == JsonKind.String ? _text : fallback;
        }

        /// <summary>True or false. Nothing else counts as either.</summary>
        public bool AsBool(bool fallback = false)
        {
            return _kind == JsonKind.Boolean ? _isTrue : fallback;
        }

        /// <summary>Returns the value as JSON.</summary>
        public override string ToString()
        {
            var writer = new JsonWriter();
            Write(writer);
            return writer.ToString();
        }

        private static JsonValue ReadObject(JsonReader reader)
        {
            var builder = new ObjectBuilder();
            reader.BeginObject();
            for (string name = reader.NextName(); name != null; name = reader.NextName())
            {
                builder.Add(name, Read(reader));
            }
            return builder.Build();
        }

        private static JsonValue OfInteger(bool isNegative, ulong magnitude)
        {
            return new JsonValue(JsonKind.Number)
            {
                _isInteger = true,
                _isNegative = isNegative,
                _magnitude = magnitude,
            };
        }

        private static JsonValue OfItems(List<JsonValue> items)
        {
            for (int i = 0; i < items.Count; i++)
            {
                items[i] = items[i] ?? Null;
            }
            return new JsonValue(JsonKind.Array) { _items = items.ToArray() };
        }

        private void WriteNumber(JsonWriter writer)
        {
            if (!_isInteger)
            {
                writer.Value(_number);
            }
            else if (_isNegative)
            {
                writer.Value(unchecked(-(long)_magnitude));
            }
            else
            {
                writer.Value(_magnitude);
            }
        }

        private sealed class ObjectBuilder
        {
            private readonly List<string> _names = new List<string>();
            private readonly List<JsonValue> _values = new List<JsonValue>();
            private readonly Dictionary<string, int> _indices = new Dictionary<string, int>();

            internal void Add(string name, JsonValue value)
            {
                int index;
                if (_indices.TryGetValue(name, out index))
                {
                    _values[index] = value;
                    return;
                }
                _indices.Add(name, _names.Count);
                _names.Add(name);
                _values.Add(value);
            }

            internal JsonValue Build()
            {
                return new JsonValue(JsonKind.Object)
                {
                    _names = _names.ToArray(),
                    _items = _values.ToArray(),
                    _indices = _indices,
                };
            }
        }
    }
}
