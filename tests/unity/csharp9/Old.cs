// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text; // CS8019

internal sealed class Old
{
    private readonly Random _random = new Random(); // IDE0090
    private string _text;

    internal Old() // IDE0021
    {
        _text = "";
    }

    internal int Next
    {
        get { return _random.Next(); }
    } // IDE0025

    internal string Text
    {
        get { return _text; }
        set { _text = value; }
    } // IDE0027
    // IDE0027

    internal static int Parse(string text)
    {
        int parsed; // IDE0018
        if (int.TryParse(text, out parsed))
        {
            return parsed;
        }
        int unused; // CS0168
        return default(int); // IDE0034
    }

    internal static int Twice(int value) // IDE0022
    {
        return 2 * value;
    }

    internal void Reset()
    {
        if (_text == null) // IDE0074
        {
            _text = "";
        }
        _text = _text ?? ""; // IDE0074
        using (IDisposable one = null) // IDE0063
        {
            one.Dispose();
        }
    }

    internal static string Name(int kind) // IDE0066
    {
        switch (kind)
        {
            case 0:
                return "none";
            default:
                throw new ArgumentException(nameof(kind));
        }
    }
}
