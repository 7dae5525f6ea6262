// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway.Pictures
{
    /// <summary>
    /// The headers of a JPEG (ISO/IEC 10918-1, annex B): tables, size, components, scans.
    /// </summary>
    internal sealed class JpegHeaders
    {
        internal const int StartOfScan = 0xDA;
        internal const int EndOfImage = 0xD9;

        private const int StartOfImage = 0xD8;
        private const int Baseline = 0xC0;
        private const int Extended = 0xC1; // with 8 bits per sample, read like baseline
        private const int Progressive = 0xC2;
        private const int DefineHuffman = 0xC4;
        private const int ExtensionOfFrames = 0xC8;
        private const int DefineArithmetic = 0xCC;
        private const int LastStartOfFrame = 0xCF;
        private const int DefineQuantization = 0xDB;
        private const int DefineRestarts = 0xDD;
        private const int App0 = 0xE0;
        private const int App14 = 0xEE;
        private const int AdobeBytes = 12; // of the segment, to the colour transform
        private const int MaxComponents = 3; // four are CMYK, which printers take
        private const int Tables = 4;

        private readonly HuffmanTable[] _dc = Made();
        private readonly HuffmanTable[] _ac = Made();
        private readonly int[][] _quantization = new int[Tables][];
        private readonly bool[] _isDefined = new bool[3 * Tables]; // quantization, DC, AC
        private readonly JpegComponent[] _all = { new JpegComponent(), new JpegComponent(), new JpegComponent() };
        private readonly JpegComponent[] _scanned = new JpegComponent[MaxComponents];
        private byte[] _jpeg;
        private int _end;
        private bool _isJfif;
        private int _adobeTransform; // -1 where nothing is said

        internal JpegHeaders()
        {
            for (int i = 0; i < Tables; i++)
            {
                _quantization[i] = new int[64];
            }
        }

        internal int Width { get; private set; }

        internal int Height { get; private set; }

        /// <summary>The largest sampling factors.</summary>
        internal int Horizontal { get; private set; }

        internal int Vertical { get; private set; }

        /// <summary>How many components the picture has. 0 until they are read.</summary>
        internal int Count { get; private set; }

        /// <summary>The place of the size.</summary>
        internal int SizeAt { get; private set; }

        /// <summary>How many components the scan has.</summary>
        internal int ScannedCount { get; private set; }

        /// <summary>Units between two restart markers. 0 for none.</summary>
        internal int RestartInterval { get; private set; }

        /// <summary>Whether the components are red, green and blue.</summary>
        internal bool IsRgb
        {
            get
            {
                if (_isJfif || Count != 3)
                {
                    return false;
                }
                return _adobeTransform >= 0
                    ? _adobeTransform == 0
                    : _all[0].Id == 'R' && _all[1].Id == 'G' && _all[2].Id == 'B';
            }
        }

        internal JpegComponent Component(int index) => _all[index];

        internal JpegComponent Scanned(int index) => _scanned[index];

        internal static bool Begins(byte[] jpeg, int end) => end >= 4 && jpeg[0] == 0xFF && jpeg[1] == StartOfImage;

        /// <summary>Begins with another JPEG, whose last byte is before *end*.</summary>
        /// <returns>The place of the first marker's code.</returns>
        internal int Begin(byte[] jpeg, int end)
        {
            _jpeg = jpeg;
            _end = end;
            _isJfif = false;
            _adobeTransform = -1;
            Count = 0;
            RestartInterval = 0;
            Array.Clear(_isDefined, 0, _isDefined.Length);
            if (!Begins(jpeg, end))
            {
                throw new JpegFormatException("not a JPEG: it does not begin with FF D8", 0);
            }
            return Marker(2);
        }

        /// <summary>Reads segments up to the next scan.</summary>
        /// <param name="at">The place of a marker's code.</param>
        /// <returns>The start of the scan's data.</returns>
        internal int ReadToScan(int at)
        {
            while (true)
            {
                int code = _jpeg[at];
                if (code == EndOfImage)
                {
                    throw new JpegFormatException("the picture ends before all of it has come", at);
                }
                int length = at + 2 < _end ? (_jpeg[at + 1] << 8) | _jpeg[at + 2] : 0;
                int from = at + 3;
                int to = at + 1 + length;
                if (length < 2 || to > _end)
                {
                    throw new JpegFormatException(
                        "segment " + code.ToString("X2") + " is " + length + " bytes long, " + (_end - at - 1)
                        + " are there",
                        at);
                }
                if (code == StartOfScan)
                {
                    ReadScan(from, to);
                    return to;
                }
                ReadSegment(code, at, from, to);
                at = Marker(to);
            }
        }

        // A marker's code, which any number of FF may precede (B.1.1.2).
        private int Marker(int at)
        {
            int code = at;
            while (code < _end && _jpeg[code] == 0xFF)
            {
                code++;
            }
            if (code >= _end)
            {
                throw new JpegFormatException("the data end before the picture", _end);
            }
            if (code == at || _jpeg[code] == 0)
            {
                throw new JpegFormatException("expected a marker, found " + _jpeg[code].ToString("X2"), code);
            }
            return code;
        }

        private void ReadSegment(int code, int at, int from, int to)
        {
            switch (code)
            {
                case Baseline:
                case Extended:
                    ReadFrame(from, to);
                    break;
                case DefineHuffman:
                    ReadHuffmanTables(from, to);
                    break;
                case DefineQuantization:
                    ReadQuantizationTables(from, to);
                    break;
                case DefineRestarts:
                    Need(from, to, 2, "restart interval");
                    RestartInterval = Half(from);
                    break;
                case App0:
                    _isJfif |= Says(from, to, "JFIF");
                    break;
                case App14:
                    if (to - from >= AdobeBytes && Says(from, to, "Adobe"))
                    {
                        _adobeTransform = _jpeg[from + AdobeBytes - 1];
                    }
                    break;
                case Progressive:
                    throw new JpegNotSupportedException("a progressive JPEG, only baseline is read", at);
                case DefineArithmetic:
                    throw new JpegNotSupportedException("arithmetic coding, only Huffman's is read", at);
                default:
                    if (code > Progressive && code <= LastStartOfFrame && code != ExtensionOfFrames)
                    {
                        throw new JpegNotSupportedException(
                            "process " + code.ToString("X2") + ", only baseline is read", at);
                    }
                    break; // for others: comments, EXIF, colour profiles
            }
        }

        private void ReadFrame(int from, int to)
        {
            if (Count > 0)
            {
                throw new JpegFormatException("a second frame", from);
            }
            Need(from, to, 6, "frame");
            SizeAt = from + 1;
            Height = Half(from + 1);
            Width = Half(from + 3);
            int count = _jpeg[from + 5];
            if (_jpeg[from] != 8)
            {
                throw new JpegNotSupportedException(_jpeg[from] + " bits per sample, only 8 are read", from);
            }
            if (Height == 0 && Width > 0)
            {
                throw new JpegNotSupportedException("the height comes after the picture", from + 1);
            }
            if (Width == 0 || count == 0)
            {
                throw new JpegFormatException("a picture without pixels", from + 3);
            }
            if (count != 1 && count != MaxComponents)
            {
                throw new JpegNotSupportedException(count + " components, only 1 and 3 are read", from + 5);
            }
            Need(from, to, 6 + 3 * count, "frame of " + count + " components");
            Horizontal = Vertical = 1;
            for (int i = 0; i < count; i++)
            {
                ReadComponent(i, from + 6 + 3 * i, count == 1);
            }
            for (int i = 0; i < count; i++)
            {
                Measure(_all[i], from + 6 + 3 * i);
            }
            Count = count;
        }

        private void ReadComponent(int index, int at, bool isAlone)
        {
            JpegComponent component = _all[index];
            component.Id = _jpeg[at];
            component.Horizontal = _jpeg[at + 1] >> 4;
            component.Vertical = _jpeg[at + 1] & 15;
            component.QuantizationTable = _jpeg[at + 2];
            component.IsRead = false;
            if (component.Horizontal < 1 || component.Horizontal > 4
                || component.Vertical < 1 || component.Vertical > 4)
            {
                throw new JpegFormatException("sampling factors are 1 to 4, not " + component.Horizontal
                    + " and " + component.Vertical, at + 1);
            }
            if (isAlone)
            {
                component.Horizontal = component.Vertical = 1; // of itself. A scan of one has single blocks (A.2.2)
            }
            if (component.QuantizationTable >= Tables)
            {
                throw new JpegFormatException(
                    "quantization tables are 0 to 3, not " + component.QuantizationTable, at + 2);
            }
            for (int i = 0; i < index; i++)
            {
                if (_all[i].Id == component.Id)
                {
                    throw new JpegFormatException("two components " + component.Id, at);
                }
            }
            Horizontal = Math.Max(Horizontal, component.Horizontal);
            Vertical = Math.Max(Vertical, component.Vertical);
        }

        private void Measure(JpegComponent component, int at)
        {
            if (Horizontal % component.Horizontal != 0 || Vertical % component.Vertical != 0)
            {
                throw new JpegNotSupportedException("sampling factors that are not multiples", at + 1);
            }
            component.HorizontalScale = Horizontal / component.Horizontal;
            component.VerticalScale = Vertical / component.Vertical;
            component.Width = (Width + component.HorizontalScale - 1) / component.HorizontalScale;
            component.Height = (Height + component.VerticalScale - 1) / component.VerticalScale;
        }

        private void ReadHuffmanTables(int from, int to)
        {
            while (from < to)
            {
                Need(from, to, 1 + HuffmanTable.MaxLength, "Huffman table");
                int kind = _jpeg[from] >> 4;
                int number = _jpeg[from] & 15;
                if (kind > 1 || number >= Tables)
                {
                    throw new JpegFormatException("no such Huffman table, " + _jpeg[from].ToString("X2"), from);
                }
                _isDefined[(1 + kind) * Tables + number] = true;
                from = (kind == 0 ? _dc : _ac)[number].Read(_jpeg, from + 1, to);
            }
        }

        private void ReadQuantizationTables(int from, int to)
        {
            while (from < to)
            {
                int bytes = 1 + (_jpeg[from] >> 4);
                int number = _jpeg[from] & 15;
                if (bytes > 2 || number >= Tables)
                {
                    throw new JpegFormatException("no such quantization table, " + _jpeg[from].ToString("X2"), from);
                }
                Need(from, to, 1 + 64 * bytes, "quantization table");
                from++;
                for (int i = 0; i < 64; i++, from += bytes)
                {
                    _quantization[number][i] = bytes == 1 ? _jpeg[from] : Half(from);
                }
                _isDefined[number] = true;
            }
        }

        private void ReadScan(int from, int to)
        {
            if (Count == 0)
            {
                throw new JpegFormatException("a scan without a frame", from);
            }
            Need(from, to, 1, "scan");
            int count = _jpeg[from];
            if (count < 1 || count > Count)
            {
                throw new JpegFormatException("a scan of " + count + " components, the frame has " + Count, from);
            }
            Need(from, to, 4 + 2 * count, "scan of " + count + " components");
            int blocks = 0;
            for (int i = 0; i < count; i++)
            {
                _scanned[i] = ReadScanned(from + 1 + 2 * i);
                blocks += _scanned[i].Horizontal * _scanned[i].Vertical;
            }
            if (count > 1 && blocks > 10)
            {
                throw new JpegFormatException("units of " + blocks + " blocks, at most 10", from); // B.2.3
            }
            int at = from + 1 + 2 * count;
            if (_jpeg[at] != 0 || _jpeg[at + 1] != 63 || _jpeg[at + 2] != 0)
            {
                throw new JpegFormatException("a scan of some coefficients, in a baseline JPEG", at);
            }
            ScannedCount = count;
        }

        private JpegComponent ReadScanned(int at)
        {
            JpegComponent component = null;
            for (int i = 0; i < Count; i++)
            {
                component = _all[i].Id == _jpeg[at] ? _all[i] : component;
            }
            if (component == null)
            {
                throw new JpegFormatException("the frame has no component " + _jpeg[at], at);
            }
            if (component.IsRead)
            {
                throw new JpegFormatException("component " + _jpeg[at] + " comes twice", at);
            }
            int dc = _jpeg[at + 1] >> 4;
            int ac = _jpeg[at + 1] & 15;
            if (dc >= Tables || ac >= Tables || !_isDefined[Tables + dc] || !_isDefined[2 * Tables + ac])
            {
                // mostly Motion JPEG, which leaves out the usual ones
                throw new JpegNotSupportedException("Huffman tables that are not there", at + 1);
            }
            if (!_isDefined[component.QuantizationTable])
            {
                throw new JpegFormatException(
                    "quantization table " + component.QuantizationTable + " is not there", at);
            }
            component.IsRead = true;
            component.Dc = _dc[dc];
            component.Ac = _ac[ac];
            _quantization[component.QuantizationTable].CopyTo(component.Steps, 0);
            return component;
        }

        private void Need(int from, int to, int bytes, string what)
        {
            if (to - from < bytes)
            {
                throw new JpegFormatException(
                    "a " + what + " takes " + bytes + " bytes, its segment has " + (to - from), from);
            }
        }

        private bool Says(int from, int to, string text)
        {
            bool says = to - from >= text.Length;
            for (int i = 0; says && i < text.Length; i++)
            {
                says = _jpeg[from + i] == text[i];
            }
            return says;
        }

        private int Half(int at) => (_jpeg[at] << 8) | _jpeg[at + 1];

        private static HuffmanTable[] Made()
        {
            var tables = new HuffmanTable[Tables];
            for (int i = 0; i < Tables; i++)
            {
                tables[i] = new HuffmanTable();
            }
            return tables;
        }
    }
}
