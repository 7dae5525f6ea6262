// SPDX-License-Identifier: Apache-2.0
using System;
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>Reads frames, and brings each to what waits for it. One frame at a time, on any thread.</summary>
    internal sealed class Inbox
    {
        private static readonly JsonMembers Envelope = new(
            "op", "topic", "id", "service", "action", "msg", "values", "args", "result", "status", "level", "code",
            "request", "value", "ros_time", "changes");

        private enum Key
        {
            Op, Topic, Id, Service, Action, Msg, Values, Args, Result, Status, Level, Code, Request, Value, RosTime, Changes,
        }

        private const int Absent = -1;

        private const int NameCharacters = 128; // of what a peer sends, in words of ours
        private const int ErrorTextCharacters = 1024; // of a peer's own words: a paragraph

        private readonly GatewayClient _client;
        private readonly JsonReader _jsonReader = new();
        private readonly JsonReader _secondJsonReader = new();
        private readonly JsonReader _cborReader = new CborReader();
        private readonly JsonReader _secondCborReader = new CborReader();

        // The frame at hand
        private JsonReader _reader;
        private JsonReader _second; // for what is read twice, or later
        private byte[] _buffer;
        private int _count;
        private string _op;
        private string _topic;
        private string _id;
        private string _name; // of the service or action
        private string _level;
        private string _code;
        private string _request;
        private double _value;
        private double _rosSeconds;
        private bool _result;
        private int _status;
        private int _payloadAt; // the start of msg, values, args or changes
        private bool _isDelivered;

        internal Inbox(GatewayClient client) => _client = client;

        /// <summary>Reads one frame. A fault in it becomes an event, never an exception.</summary>
        internal void Read(byte[] buffer, int count)
        {
            Forget();
            _buffer = buffer;
            _count = count;
            bool isCbor = CborReader.Begins(buffer, count);
            _reader = isCbor ? _cborReader : _jsonReader;
            _second = isCbor ? _secondCborReader : _secondJsonReader;
            try
            {
                _reader.Reset(buffer, 0, count);
                ReadEnvelope();
                Dispatch();
            }
            catch (JsonFormatException error)
            {
                _client.Reports.Error(_op ?? "", Where() + "a frame cannot be read: " + error.Message);
            }
            _buffer = null;
        }

        private void ReadEnvelope()
        {
            _reader.BeginObject();
            int member = JsonMembers.Unknown;
            while (_reader.NextMember(Envelope, ref member))
            {
                switch ((Key)member)
                {
                    case Key.Op:
                        _op = _reader.ReadString();
                        break;
                    case Key.Topic:
                        _topic = _reader.ReadString();
                        break;
                    case Key.Id:
                        _id = ReadId();
                        break;
                    case Key.Service:
                    case Key.Action:
                        _name = _reader.ReadString();
                        break;
                    case Key.Msg:
                        // The way of nearly all frames: the message is read where it stands, and once.
                        if (_op != "publish" || _topic == null)
                        {
                            SkipPayload();
                            break;
                        }
                        _isDelivered = true;
                        if (!Deliver(_reader.Position))
                        {
                            return; // it is told, and the reader stands anywhere
                        }
                        break;
                    case Key.Values:
                    case Key.Args:
                    case Key.Changes:
                        SkipPayload();
                        break;
                    case Key.Result:
                        _result = ReadFlag();
                        break;
                    case Key.Status:
                        _status = _reader.ReadInt32();
                        break;
                    case Key.Level:
                        _level = _reader.ReadString();
                        break;
                    case Key.Code:
                        _code = _reader.ReadString();
                        break;
                    case Key.Request:
                        _request = _reader.ReadString();
                        break;
                    case Key.Value:
                        _value = ReadNumber();
                        break;
                    case Key.RosTime:
                        _rosSeconds = ReadSeconds();
                        break;
                    default:
                        _reader.Skip();
                        break;
                }
            }
            _reader.End();
        }

        private void Dispatch()
        {
            switch (_op)
            {
                case "publish":
                    if (!_isDelivered)
                    {
                        DeliverLate();
                    }
                    break;
                case "status":
                    OnStatus();
                    break;
                case "service_response":
                    OnServiceResponse();
                    break;
                case "call_service":
                    _client.Providers.OnCall(Names.Absolute(Need(_name, "service")), Need(_id, "id"), Payload());
                    break;
                case "action_feedback":
                    _client.Goals.OnFeedback(_id, Payload());
                    break;
                case "action_result":
                    OnActionResult();
                    break;
                case "control":
                case "acquire_control":
                case "release_control":
                    _client.Publishers.Driving?.OnFrame(_op, Whole());
                    goto default;
                case null:
                    throw new JsonFormatException("op is missing", "", 0);
                default:
                    if (_client.Requests.IsPending(_id))
                    {
                        _client.Requests.Answer(_id, Whole());
                    }
                    else
                    {
                        OnUnasked();
                    }
                    break;
            }
        }

        // To all but the last by their own reader. The last goes on where the frame's reader stands.
        // False if that one cannot read it.
        private bool Deliver(int at)
        {
            Subscription[] subscriptions = _client.Subscriptions.Of(_topic);
            if (subscriptions.Length == 0)
            {
                _reader.Skip(); // it was on its way when the last one ended
                return true;
            }
            _reader.PackedInt8s = _second.PackedInt8s = PackedInt8s(subscriptions);
            for (int i = 0; i < subscriptions.Length - 1; i++)
            {
                _second.Reset(_buffer, at, _count - at);
                try
                {
                    subscriptions[i].Deliver(_second);
                }
                catch (Exception error)
                {
                    Unreadable(subscriptions[i], error);
                }
            }
            Subscription last = subscriptions[subscriptions.Length - 1];
            try
            {
                last.Deliver(_reader);
                return true;
            }
            catch (Exception error)
            {
                Unreadable(last, error);
                return false;
            }
        }

        // The gateway sends one form to all.
        private static Func<byte[], sbyte[]> PackedInt8s(Subscription[] subscriptions)
        {
            foreach (Subscription subscription in subscriptions)
            {
                if (subscription.Options.PackedInt8s != null)
                {
                    return subscription.Options.PackedInt8s;
                }
            }
            return null;
        }

        // A server that sends msg before topic, as JSON allows.
        private void DeliverLate()
        {
            Need(_topic, "topic");
            JsonReader payload = Payload();
            int at = payload.Position;
            Subscription[] subscriptions = _client.Subscriptions.Of(_topic);
            payload.PackedInt8s = PackedInt8s(subscriptions);
            foreach (Subscription subscription in subscriptions)
            {
                payload.Reset(_buffer, at, _count - at);
                try
                {
                    subscription.Deliver(payload);
                }
                catch (Exception error)
                {
                    Unreadable(subscription, error);
                }
            }
        }

        // Mostly a JsonFormatException. But a class of the application's may throw anything while it reads.
        private void Unreadable(Subscription subscription, Exception error)
        {
            subscription.Unreadable++;
            _client.Reports.Error("subscribe", subscription.Topic + ": a message cannot be read as "
                + subscription.Type + ": " + error.Message);
        }

        private void OnStatus()
        {
            if (_request == "unsubscribe" && _code == "not_found")
            {
                return; // a refused or forgotten request needs no end
            }
            string text = _payloadAt == Absent ? "" : Truncate(Payload().ReadString(), ErrorTextCharacters);
            string topic = _id == null ? null : _client.Subscriptions.TopicOf(_id) ?? _client.Publishers.TopicOf(_id);
            if (topic != null && !text.Contains(topic))
            {
                text = topic + ": " + text;
            }
            if (_request == "cancel_transform" && _code == "not_found")
            {
                return; // the same for a lookup
            }
            if (_level != "error")
            {
                _client.Transforms.OnWarning(_id, text);
            }
            else if (_client.Transforms.OnRefused(_id, text))
            {
                return;
            }
            if (_level == "error" && _client.Requests.IsPending(_id))
            {
                _client.Requests.Fail(_id, text);
                return;
            }
            if (_level == "error" && _id != null)
            {
                if (_client.Publishers.Driving?.OnUnknown(_id, text) == true)
                {
                    return;
                }
                if (_client.Publishers.OnRefused(_id, _request ?? "", _code ?? "", text))
                {
                    return;
                }
            }
            EventLevel level = _level == "error" ? EventLevel.Error
                : _level == "info" ? EventLevel.Info : EventLevel.Warning;
            _client.Reports.Tell(level, text, _code ?? "", _request ?? "");
        }

        private void OnServiceResponse()
        {
            if (_result)
            {
                _client.Requests.Answer(_id, Payload());
            }
            else
            {
                _client.Requests.Fail(_id, ErrorText("the call failed"));
            }
        }

        private void OnActionResult()
        {
            if (_result)
            {
                _client.Goals.OnResult(_id, (GoalStatus)_status, Payload());
            }
            else
            {
                _client.Goals.Fail(_id, ErrorText("the goal failed"));
            }
        }

        // A frame that the gateway sends by itself, or an answer that came too late.
        private void OnUnasked()
        {
            switch (_op)
            {
                case "pong":
                    _client.OnPong(_value, _rosSeconds);
                    break;
                case "hello":
                    _client.OnHello(JsonValue.Read(Whole()));
                    break;
                case "graph":
                    _client.GraphWatch.OnFrame(Whole());
                    break;
                case "lookup_transform":
                    _client.Transforms.OnFrame(_id, Whole());
                    break;
                default:
                    if (_id == null && !_op.EndsWith("control", StringComparison.Ordinal))
                    {
                        _client.Reports.Tell(
                            EventLevel.Warning,
                            "a frame with unknown op '" + Truncate(_op, NameCharacters) + "' was ignored",
                            "client",
                            "");
                    }
                    break;
            }
        }

        private JsonReader Payload()
        {
            if (_payloadAt == Absent)
            {
                throw new JsonFormatException("values are missing", "", 0);
            }
            _second.Reset(_buffer, _payloadAt, _count - _payloadAt);
            return _second;
        }

        private JsonReader Whole()
        {
            _second.Reset(_buffer, 0, _count);
            return _second;
        }

        private string ErrorText(string otherwise)
        {
            if (_payloadAt == Absent)
            {
                return otherwise;
            }
            JsonReader payload = Payload();
            return payload.Kind == JsonKind.String ? payload.ReadString() : otherwise;
        }

        private void SkipPayload()
        {
            _payloadAt = _reader.Position;
            _reader.Skip();
        }

        private bool ReadFlag()
        {
            if (_reader.Kind == JsonKind.Boolean)
            {
                return _reader.ReadBool();
            }
            _reader.Skip();
            return false;
        }

        private string ReadId()
        {
            if (_reader.Kind == JsonKind.String)
            {
                return _reader.ReadString();
            }
            _reader.Skip(); // ours are strings
            return null;
        }

        private double ReadNumber()
        {
            if (_reader.Kind == JsonKind.Number)
            {
                return _reader.ReadFloat64();
            }
            _reader.Skip();
            return double.NaN;
        }

        private double ReadSeconds()
        {
            JsonValue time = JsonValue.Read(_reader);
            return time["sec"].AsDouble(0) + time["nanosec"].AsDouble(0) * 1e-9;
        }

        private string Need(string value, string name)
        {
            if (value == null)
            {
                throw new JsonFormatException(name + " is missing", "", 0);
            }
            return value;
        }

        private string Where() => _topic == null ? "" : Truncate(_topic, NameCharacters) + ": ";

        // Only a part of a peer's text is repeated.
        private static string Truncate(string text, int characters) =>
            text.Length <= characters ? text : text.Substring(0, characters) + "...";

        private void Forget()
        {
            _op = null;
            _topic = null;
            _id = null;
            _name = null;
            _level = null;
            _code = null;
            _request = null;
            _value = double.NaN;
            _rosSeconds = 0;
            _result = false;
            _status = 0;
            _payloadAt = Absent;
            _isDelivered = false;
        }
    }
}
