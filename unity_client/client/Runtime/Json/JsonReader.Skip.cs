// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway.Json
{
    public partial class JsonReader
    {
        /// <summary>
        /// Passes over one value of any kind. Brackets must pair, nesting and strings must end. Whether what
        /// is inside is JSON in every detail is not looked at, which makes this several times as fast as
        /// reading.
        /// </summary>
        public virtual void Skip()
        {
            switch (Next())
            {
                case JsonKind.Object:
                case JsonKind.Array:
                    SkipNested(_depth);
                    break;
                case JsonKind.String:
                    SkipString();
                    break;
                case JsonKind.Number:
                    ScanNumber("a number");
                    break;
                default:
                    if (!TakeLiteral("null") && !TakeLiteral("true") && !TakeLiteral("false"))
                    {
                        throw Unexpected("a value");
                    }
                    break;
            }
        }

        private void SkipNested(int outer)
        {
            while (_position < _end)
            {
                switch (_buffer[_position])
                {
                    case (byte)'"':
                        SkipString();
                        continue;
                    case (byte)'{':
                    case (byte)'[':
                        Enter(_buffer[_position] == (byte)'[');
                        _position++;
                        continue;
                    case (byte)'}':
                    case (byte)']':
                        if (_levels[_depth].IsArray != (_buffer[_position] == (byte)']'))
                        {
                            throw Unexpected(_levels[_depth].IsArray ? "a ]" : "a }");
                        }
                        _depth--;
                        _position++;
                        if (_depth == outer)
                        {
                            return;
                        }
                        continue;
                    default:
                        _position++;
                        continue;
                }
            }
            throw Unexpected("the end of an object or array");
        }

        private void SkipString()
        {
            _position++;
            _position = ClosingQuote() + 1;
        }
    }
}
