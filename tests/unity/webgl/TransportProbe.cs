// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Text;
using System.Threading;
using Ros2Gateway;
using Ros2Gateway.Unity;

/// <summary>
/// Lives as a player does: polls the transport and tells what it hears, a line each. Sends so many frames as soon
/// as it can, and closes on hearing "close".
/// usage: TransportProbe.exe ADDRESS MAX_MESSAGE_BYTES FRAMES
/// </summary>
internal sealed class TransportProbe : ITransportListener
{
    private readonly WebGlTransport _transport;
    private readonly byte[] _frame = new byte[20000];
    private int _left;
    private bool _isOver;
    private bool _isInside;
    private int _sentInPoll;
    private int _mostInPoll;

    private TransportProbe(int maxMessageBytes, int frames)
    {
        _transport = new WebGlTransport(maxMessageBytes);
        _left = frames;
        for (int i = 0; i < _frame.Length; i++)
        {
            _frame[i] = (byte)'x';
        }
    }

    public void OnOpen()
    {
        Enter("open");
        Send();
        Leave();
    }

    public void OnFrame(byte[] buffer, int count)
    {
        string text = Encoding.UTF8.GetString(buffer, 0, count);
        Enter("frame " + (count > 100 ? count + " bytes" : text));
        if (text == "close")
        {
            _transport.Close(4001, "as told");
        }
        if (text == "dispose")
        {
            _transport.Dispose();
            _isOver = true;
        }
        Leave();
    }

    public void OnProgress()
    {
    }

    public void OnOversized(long bytes)
    {
        Enter("oversized " + bytes);
        Leave();
    }

    public void OnSent()
    {
        _sentInPoll += 1; // may come within another call, and within TrySend
        Send();
    }

    public void OnClosed(int code, string reason)
    {
        Enter("closed " + code + " " + reason);
        _isOver = true;
        Leave();
    }

    private static void Main(string[] arguments)
    {
        var probe = new TransportProbe(int.Parse(arguments[1]), int.Parse(arguments[2]));
        probe._transport.Open(new Uri(arguments[0]), probe);
        while (!probe._isOver)
        {
            probe._sentInPoll = 0;
            probe._transport.Poll();
            probe._mostInPoll = Math.Max(probe._mostInPoll, probe._sentInPoll);
            Thread.Sleep(2);
        }
        // Nothing may come any more.
        probe._transport.Poll();
        probe._transport.Close(1000, "");
        probe._transport.Dispose();
        Console.WriteLine("over, at most {0} frames a poll", probe._mostInPoll);
    }

    private void Send()
    {
        if (_left == 0)
        {
            return;
        }
        _left -= 1; // before, because OnSent may come within
        if (!_transport.TrySend(_frame, _frame.Length))
        {
            _left += 1;
        }
    }

    private void Enter(string words)
    {
        if (_isInside)
        {
            Console.WriteLine("calls overlap");
        }
        _isInside = true;
        if (words != null)
        {
            Console.WriteLine(words);
        }
    }

    private void Leave()
    {
        _isInside = false;
    }
}
