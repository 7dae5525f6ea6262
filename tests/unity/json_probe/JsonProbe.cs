// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Text;
using Ros2Gateway;
using Ros2Gateway.Json;
using Ros2Gateway.Messages;

/// <summary>
/// Answers lines on standard input, each an operation, a space and its argument as base64, with a line of
/// its own: "=" and the result as base64, or "!" and the text of the JsonFormatException, or "?" and any
/// other exception. An empty line asks for the answers so far.
/// </summary>
internal static class JsonProbe
{
    private const string Cbor = "cbor:";

    private static readonly JsonReader OfJson = new JsonReader();
    private static readonly JsonReader OfCbor = new CborReader();
    private static readonly Dictionary<string, Type> Classes = new Dictionary<string, Type>();
    private static JsonReader Reader = OfJson;
    private static readonly JsonWriter Writer = new JsonWriter();

    private static int Main()
    {
        var input = new StreamReader(Console.OpenStandardInput(), Encoding.ASCII);
        var output = new StreamWriter(Console.OpenStandardOutput(), new UTF8Encoding(false));
        output.NewLine = "\n";
        for (string line = input.ReadLine(); line != null; line = input.ReadLine())
        {
            if (line.Length == 0)
            {
                output.Flush();
                continue;
            }
            int space = line.IndexOf(' ');
            byte[] argument = Convert.FromBase64String(line.Substring(space + 1));
            output.WriteLine(Answer(line.Substring(0, space), argument));
        }
        output.Flush();
        return 0;
    }

    private static string Answer(string operation, byte[] argument)
    {
        Writer.Clear();
        try
        {
            Perform(operation, argument);
            return "=" + Convert.ToBase64String(Writer.Buffer, 0, Writer.Count);
        }
        catch (JsonFormatException error)
        {
            return "!" + Convert.ToBase64String(Encoding.UTF8.GetBytes(error.Message));
        }
        catch (Exception error)
        {
            return "?" + Convert.ToBase64String(Encoding.UTF8.GetBytes(error.ToString()));
        }
    }

    private static void Perform(string operation, byte[] argument)
    {
        // The text lies between other bytes, so that reading beyond it shows.
        byte[] buffer = new byte[argument.Length + 2];
        buffer[0] = (byte)'1';
        argument.CopyTo(buffer, 1);
        buffer[argument.Length + 1] = (byte)'1';
        bool isCbor = operation.StartsWith(Cbor, StringComparison.Ordinal);
        operation = isCbor ? operation.Substring(Cbor.Length) : operation;
        Reader = isCbor ? OfCbor : OfJson;
        Reader.Reset(buffer, 1, argument.Length);
        switch (operation)
        {
            case "tree":
                JsonValue value = JsonValue.Read(Reader);
                Reader.End();
                value.Write(Writer);
                break;
            case "skip":
                Reader.Skip();
                Reader.End();
                Writer.Null();
                break;
            case "float64": // JSON to bits
                double wide = Reader.ReadFloat64();
                Reader.End();
                Writer.Value(BitConverter.DoubleToInt64Bits(wide));
                break;
            case "float32":
                float narrow = Reader.ReadFloat32();
                Reader.End();
                Writer.Value(BitConverter.DoubleToInt64Bits(narrow));
                break;
            case "write64": // bits of a double to JSON
                Writer.Value(BitConverter.Int64BitsToDouble(BitConverter.ToInt64(argument, 0)));
                break;
            case "write32":
                Writer.Value(BitConverter.ToSingle(argument, 0));
                break;
            case "octets":
                byte[] octets = Reader.ReadBytes();
                Reader.End();
                Writer.Base64(octets);
                break;
            case "string":
                string text = Reader.ReadString();
                Reader.End();
                Writer.Value(text);
                break;
            case "culture":
                CultureInfo culture = (CultureInfo)CultureInfo.InvariantCulture.Clone();
                culture.NumberFormat.NegativeSign = "~";
                culture.NumberFormat.NumberDecimalSeparator = ",";
                System.Threading.Thread.CurrentThread.CurrentCulture = culture;
                Writer.Null();
                break;
            case "uint8s": Writer.Values(Widened(Reader.ReadBytes())); Reader.End(); break;
            case "bool": Writer.Value(Reader.ReadBool()); Reader.End(); break;
            case "bools": Writer.Values(Reader.ReadBools()); Reader.End(); break;
            case "int8": Writer.Value(Reader.ReadInt8()); Reader.End(); break;
            case "int8s": Writer.Values(Reader.ReadInt8s()); Reader.End(); break;
            case "int16": Writer.Value(Reader.ReadInt16()); Reader.End(); break;
            case "int16s": Writer.Values(Reader.ReadInt16s()); Reader.End(); break;
            case "int32": Writer.Value(Reader.ReadInt32()); Reader.End(); break;
            case "int32s": Writer.Values(Reader.ReadInt32s()); Reader.End(); break;
            case "int64": Writer.Value(Reader.ReadInt64()); Reader.End(); break;
            case "int64s": Writer.Values(Reader.ReadInt64s()); Reader.End(); break;
            case "uint8": Writer.Value(Reader.ReadUInt8()); Reader.End(); break;
            case "uint16": Writer.Value(Reader.ReadUInt16()); Reader.End(); break;
            case "uint16s": Writer.Values(Reader.ReadUInt16s()); Reader.End(); break;
            case "uint32": Writer.Value(Reader.ReadUInt32()); Reader.End(); break;
            case "uint32s": Writer.Values(Reader.ReadUInt32s()); Reader.End(); break;
            case "uint64": Writer.Value(Reader.ReadUInt64()); Reader.End(); break;
            case "uint64s": Writer.Values(Reader.ReadUInt64s()); Reader.End(); break;
            case "float32s": Writer.Values(Reader.ReadFloat32s()); Reader.End(); break;
            case "float64s": Writer.Values(Reader.ReadFloat64s()); Reader.End(); break;
            case "strings": Writer.Values(Reader.ReadStrings()); Reader.End(); break;
            default:
                int colon = operation.IndexOf(':'); // read:TYPE takes it over, new:TYPE has the defaults
                IMessage message = New(operation.Substring(colon + 1));
                if (operation.StartsWith("again:", StringComparison.Ordinal))
                {
                    // the length of a first message, that message, and the one that is read over it
                    int first = 4 + BitConverter.ToInt32(argument, 0);
                    Reader.Reset(argument, 4, first - 4);
                    message.Read(Reader);
                    Reader.Reset(argument, first, argument.Length - first);
                }
                if (!operation.StartsWith("new:", StringComparison.Ordinal))
                {
                    message.Read(Reader);
                    Reader.End();
                }
                message.Write(Writer);
                break;
        }
    }

    // Of all classes of the assembly: nobody registers them here.
    private static IMessage New(string type)
    {
        if (Classes.Count == 0)
        {
            foreach (Type one in typeof(MessageCatalogue).Assembly.GetTypes())
            {
                if (typeof(IMessage).IsAssignableFrom(one) && one.IsSerializable)
                {
                    Classes[((IMessage)Activator.CreateInstance(one)).RosType] = one;
                }
            }
        }
        return (IMessage)Activator.CreateInstance(Classes[MessageCatalogue.Resolve(type)]);
    }

    private static int[] Widened(byte[] octets)
    {
        return Array.ConvertAll(octets, one => (int)one);
    }
}
