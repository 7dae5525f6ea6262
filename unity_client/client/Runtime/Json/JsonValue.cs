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
        private static readonly Dictionary<string, int> NoIndices = new();
        private static readonly List<string> NoNames = new();
        private static readonly List<JsonValue> NoItems = new();

        /// <summary>
        /// The result of an indexer without a value. Its kind is <see cref="JsonKind.End"/>.
        /// </summary>
        public static readonly JsonValue Missing = new(JsonKind.End);

        /// <summary>The literal null.</summary>
        public static readonly JsonValue Null = new(JsonKind.Null);

        private const string Infinity = "Infinity";
        private const string MinusInfinity = "-Infinity";

        private readonly JsonKind _kind;
        private string _text;
        private bool _isTrue;
        private bool _isInteger; // then _magnitude holds the number, and its sign _isNegative
        private bool _isNegative;
        private ulong _magnitude;
        private double _number;
        private Dictionary<string, int> _indices = NoIndices; // of an object's members, by name
        private List<string> _names = NoNames; // of them
        private List<JsonValue> _items = NoItems; // their values, or elements

        private JsonValue(JsonKind kind) => _kind = kind;

        /// <summary>The kind of this value.</summary>
        public JsonKind Kind => _kind;

        /// <summary>Whether there is a value at all. Null is one.</summary>
        public bool Exists => _kind != JsonKind.End;

        /// <summary>How many members or elements there are. 0 for what is neither object nor array.</summary>
        public int Count => _items.Count;

        /// <summary>The names of an object's members, in the order of the text.</summary>
        public IReadOnlyList<string> Names => _names;

        /// <summary>The elements of an array, or the values of an object's members.</summary>
        public IReadOnlyList<JsonValue> Items => _items;

        /// <summary>The member of that name.</summary>
        public JsonValue this[string name] =>
            name != null && _indices.TryGetValue(name, out int index) ? _items[index] : Missing;

        /// <summary>The element at that index, or the value of the member at that place.</summary>
        public JsonValue this[int index] => index >= 0 && index < _items.Count ? _items[index] : Missing;

        /// <summary>Makes a text. Null makes <see cref="Null"/>.</summary>
        public static implicit operator JsonValue(string v) => v == null ? Null : new JsonValue(JsonKind.String) { _text = v };

        /// <summary>Makes true or false.</summary>
        public static implicit operator JsonValue(bool v) => new JsonValue(JsonKind.Boolean) { _isTrue = v };

        /// <summary>Makes an integer.</summary>
        public static implicit operator JsonValue(int v) => (long)v;

        /// <summary>Makes an integer.</summary>
        public static implicit operator JsonValue(long v) => OfInteger(v < 0, v < 0 ? unchecked(0UL - (ulong)v) : (ulong)v);

        /// <summary>Makes an integer.</summary>
        public static implicit operator JsonValue(ulong v) => OfInteger(false, v);

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
        public static JsonValue Array(params JsonValue[] items) => OfItems(new List<JsonValue>(items));

        /// <summary>Makes an object. Of two members of one name the last wins.</summary>
        public static JsonValue Object(IEnumerable<KeyValuePair<string, JsonValue>> members)
        {
            JsonValue made = Object();
            foreach (KeyValuePair<string, JsonValue> member in members)
            {
                made.Set(member.Key, member.Value);
            }
            return made;
        }

        /// <summary>
        /// Returns an object like this one, but with that member. Of anything but an object, one with that
        /// member alone. <c>JsonValue.Object().With("x", 1.5).With("y", 2.5)</c> makes an object.
        /// </summary>
        public JsonValue With(string name, JsonValue value)
        {
            JsonValue made = Object();
            for (int i = 0; i < _names.Count; i++)
            {
                made.Set(_names[i], _items[i]);
            }
            made.Set(name, value);
            return made;
        }

        /// <summary>Makes an object without members.</summary>
        public static JsonValue Object() =>
            new JsonValue(JsonKind.Object) { _indices = new(), _names = new(), _items = new() };

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
                    JsonValue made = Object();
                    reader.BeginObject();
                    for (string name = reader.NextName(); name != null; name = reader.NextName())
                    {
                        made.Set(name, Read(reader));
                    }
                    return made;
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
                    for (int i = 0; i < _names.Count; i++)
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
        public string AsString(string fallback = "") => _kind == JsonKind.String ? _text : fallback;

        /// <summary>True or false. Nothing else counts as either.</summary>
        public bool AsBool(bool fallback = false) => _kind == JsonKind.Boolean ? _isTrue : fallback;

        /// <summary>Returns the value as JSON.</summary>
        public override string ToString()
        {
            var writer = new JsonWriter();
            Write(writer);
            return writer.ToString();
        }

        // While it is made.
        private void Set(string name, JsonValue value)
        {
            if (_indices.TryGetValue(name, out int index))
            {
                _items[index] = value ?? Null;
                return;
            }
            _indices.Add(name, _items.Count);
            _names.Add(name);
            _items.Add(value ?? Null);
        }

        private static JsonValue OfInteger(bool isNegative, ulong magnitude) =>
            new JsonValue(JsonKind.Number)
            {
                _isInteger = true,
                _isNegative = isNegative,
                _magnitude = magnitude,
            };

        private static JsonValue OfItems(List<JsonValue> items)
        {
            for (int i = 0; i < items.Count; i++)
            {
                items[i] ??= Null;
            }
            return new JsonValue(JsonKind.Array) { _items = items };
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
    }
}
