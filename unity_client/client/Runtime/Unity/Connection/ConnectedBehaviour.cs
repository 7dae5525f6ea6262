// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// The base of components that use a connection: the one that was chosen, else one of the scene, else any. It
    /// may come later than the component, in another scene as well, and go earlier: then another takes its place. After
    /// a choice, and for what <see cref="MovesRobots"/>, that is only one to the same address: another address may be
    /// another robot.
    /// </summary>
    public abstract class ConnectedBehaviour : MonoBehaviour
    {
        private const float WarnSeconds = 1; // a scene that is loaded next to this one has its connection by then

        [SerializeField]
        [Tooltip("Empty: the connection of the scene")]
        private GatewayConnection _connection;

        private GatewayConnection _bound;
        private string _gateway = ""; // the address of the last that was used. Empty before the first
        private bool _isListening;

        /// <summary>
        /// The connection that is used. Null without one. A new value is used at once, and null lets the
        /// component look for one by itself.
        /// </summary>
        public GatewayConnection Connection
        {
            get => _bound != null ? _bound : _connection;

            set
            {
                _connection = value;
                _gateway = ""; // the caller knows which robot is meant
                Choose();
            }
        }

        /// <summary>
        /// Whether it moves robots, or may. When its connection is destroyed it then waits for another to the same
        /// address, or for <see cref="Connection"/> to be set.
        /// </summary>
        protected internal virtual bool MovesRobots => false;

        /// <summary>Whether there is a connection, made or not. From Bind to Unbind.</summary>
        protected bool IsBound { get; private set; }

        // a reload of scripts in Play makes an empty text of null
        private string OnlyGateway => MovesRobots && _gateway.Length > 0 ? _gateway : null;

        /// <summary>
        /// Begins to use a connection: the moment to subscribe and to advertise. Each is followed by one
        /// <see cref="Unbind"/>.
        /// </summary>
        protected abstract void Bind(GatewayConnection connection);

        /// <summary>
        /// Uses a connection no longer: it is about to be another, is being destroyed, or this component is
        /// disabled.
        /// </summary>
        protected abstract void Unbind(GatewayConnection connection);

        /// <summary>Looks for a connection. Overriders call it, last.</summary>
        protected virtual void OnEnable()
        {
            _isListening = true;
            LiveConnections.Enter(this);
            Choose();
            if (!IsBound)
            {
                StartCoroutine(WarnIfAlone());
            }
        }

        /// <summary>Lets go of the connection. Overriders call it, first.</summary>
        protected virtual void OnDisable()
        {
            _isListening = false;
            LiveConnections.Leave(this);
            LetGo();
        }

        /// <summary>Takes the best connection that there is now.</summary>
        internal void Choose()
        {
            if (!_isListening)
            {
                return;
            }
            if (IsBound)
            {
                _gateway = _bound.Gateway;
            }
            GatewayConnection best = LiveConnections.Best(this, _connection, _bound, OnlyGateway);
            if (IsBound && best == _bound && best != null)
            {
                return;
            }
            bool wasBound = IsBound;
            LetGo();
            if (!_isListening || IsBound)
            {
                return; // by who was told of that
            }
            if (best != null)
            {
                _bound = best;
                _gateway = best.Gateway;
                IsBound = true;
                Bind(best);
            }
            else if (wasBound && isActiveAndEnabled)
            {
                StartCoroutine(WarnIfAlone());
            }
        }

        /// <summary>Tells that a listener of this component has thrown, which is to harm no other.</summary>
        /// <param name="times">How often by now.</param>
        internal void ReportFault(string where, Exception error, long times)
        {
            if (IsBound)
            {
                _bound.Client.ReportFault(where + " of " + FaultLog.Name(this), error, times);
            }
            else
            {
                FaultLog.Write(this, where, error, times);
            }
        }

        private void LetGo()
        {
            if (IsBound)
            {
                GatewayConnection former = _bound; // it may be destroyed, and can be used all the same
                IsBound = false;
                _bound = null;
                Unbind(former);
            }
        }

        private IEnumerator WarnIfAlone()
        {
            yield return new WaitForSecondsRealtime(WarnSeconds);
            if (_isListening && !IsBound)
            {
                string only = LiveConnections.Only(_connection, null, OnlyGateway);
                Debug.LogWarning(
                    GetType().Name + " on " + name + " finds no Gateway Connection" + (only == null
                        ? ": add one to the scene"
                        : " to " + only + " any more: add it, or set Connection to another"), this);
            }
        }
    }
}
