// SPDX-License-Identifier: Apache-2.0
using System;
using System.IO;
using System.Text;
using Ros2Gateway.Pictures;

/// <summary>
/// Answers lines on standard input, each "decode", a space and a JPEG as base64, with its own line. "="
/// and, as base64, width and height (four bytes each, lowest first) and the pixels. Or "!" and the text of the
/// JpegFormatException, "not supported: " before it if it is that. Or "?" and any other exception. An empty line
/// asks for the answers so far. One decoder reads all pictures.
/// </summary>
internal static class JpegProbe
{
    private static readonly JpegDecoder Decoder = new JpegDecoder();
    private static byte[] _pixels;

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
            output.WriteLine(Answer(Convert.FromBase64String(line.Substring(line.IndexOf(' ') + 1))));
        }
        output.Flush();
        return 0;
    }

    private static string Answer(byte[] jpeg)
    {
        // bytes behind the picture, so that reading beyond it shows
        byte[] longer = new byte[jpeg.Length + 4];
        jpeg.CopyTo(longer, 0);
        longer[jpeg.Length] = 0xFF;
        longer[jpeg.Length + 1] = 0xD9;
        try
        {
            Decoder.Decode(longer, jpeg.Length, ref _pixels);
        }
        catch (JpegNotSupportedException error)
        {
            return "!" + Text("not supported: " + error.Message);
        }
        catch (JpegFormatException error)
        {
            return "!" + Text(error.Message);
        }
        catch (Exception error)
        {
            return "?" + Text(error.ToString());
        }
        int bytes = 4 * Decoder.Width * Decoder.Height;
        byte[] answer = new byte[8 + bytes];
        BitConverter.GetBytes(Decoder.Width).CopyTo(answer, 0);
        BitConverter.GetBytes(Decoder.Height).CopyTo(answer, 4);
        Array.Copy(_pixels, 0, answer, 8, bytes);
        return "=" + Convert.ToBase64String(answer);
    }

    private static string Text(string words)
    {
        return Convert.ToBase64String(Encoding.UTF8.GetBytes(words));
    }
}
