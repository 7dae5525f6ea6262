// SPDX-License-Identifier: Apache-2.0
using System.Collections;
using System.Collections.Generic;
using UnityEngine.Stage;

namespace UnityEngine
{
    public class Transform : Component, IEnumerable
    {
        private readonly List<Transform> _children = new List<Transform>();
        private Transform _parent;
        private Vector3 _localPosition;
        private Quaternion _localRotation = Quaternion.identity;
        private Vector3 _localScale = Vector3.one;

        protected Transform()
        {
        }

        public Transform parent
        {
            get
            {
                MainThread.Check("get_parent");
                return _parent;
            }

            set
            {
                SetParent(value, true);
            }
        }

        public Transform root
        {
            get { return _parent == null ? this : _parent.root; }
        }

        public int childCount
        {
            get { return _children.Count; }
        }

        public Vector3 localPosition
        {
            get
            {
                MainThread.Check("get_localPosition");
                return _localPosition;
            }

            set
            {
                MainThread.Check("set_localPosition");
                _localPosition = value;
                hasChanged = true;
            }
        }

        public Quaternion localRotation
        {
            get
            {
                MainThread.Check("get_localRotation");
                return _localRotation;
            }

            set
            {
                MainThread.Check("set_localRotation");
                _localRotation = value;
                hasChanged = true;
            }
        }

        public Vector3 localScale
        {
            get
            {
                MainThread.Check("get_localScale");
                return _localScale;
            }

            set
            {
                MainThread.Check("set_localScale");
                _localScale = value;
                hasChanged = true;
            }
        }

        public Vector3 position
        {
            get
            {
                MainThread.Check("get_position");
                return _parent == null ? _localPosition : _parent.TransformPoint(_localPosition);
            }

            set
            {
                MainThread.Check("set_position");
                localPosition = _parent == null ? value : _parent.InverseTransformPoint(value);
            }
        }

        public Quaternion rotation
        {
            get
            {
                MainThread.Check("get_rotation");
                return _parent == null ? _localRotation : _parent.rotation * _localRotation;
            }

            set
            {
                MainThread.Check("set_rotation");
                localRotation = _parent == null ? value : Quaternion.Inverse(_parent.rotation) * value;
            }
        }

        public Vector3 lossyScale
        {
            get { return _parent == null ? _localScale : Vector3.Scale(_parent.lossyScale, _localScale); }
        }

        public Vector3 eulerAngles
        {
            get { return rotation.eulerAngles; }
            set { rotation = Quaternion.Euler(value); }
        }

        public Vector3 localEulerAngles
        {
            get { return localRotation.eulerAngles; }
            set { localRotation = Quaternion.Euler(value); }
        }

        public Vector3 forward
        {
            get { return rotation * Vector3.forward; }
            set { rotation = Quaternion.LookRotation(value); }
        }

        public Vector3 right
        {
            get { return rotation * Vector3.right; }
        }

        public Vector3 up
        {
            get { return rotation * Vector3.up; }
        }

        public bool hasChanged { get; set; }

        internal List<Transform> Children
        {
            get { return _children; }
        }

        public void SetParent(Transform p)
        {
            SetParent(p, true);
        }

        public void SetParent(Transform parent, bool worldPositionStays)
        {
            MainThread.Check("SetParent");
            if (parent == _parent || parent == this)
            {
                return;
            }
            Vector3 oldPosition = position;
            Quaternion oldRotation = rotation;
            bool wasActive = Owner.activeInHierarchy;
            if (_parent != null && parent == null)
            {
                gameObject.MoveTo(gameObject.scene); // it stays in the scene of its parents
            }
            if (_parent != null)
            {
                _parent._children.Remove(this);
            }
            _parent = parent;
            if (_parent != null)
            {
                _parent._children.Add(this);
            }
            if (worldPositionStays)
            {
                position = oldPosition;
                rotation = oldRotation;
            }
            if (Owner.activeInHierarchy != wasActive)
            {
                ActivityChanged();
            }
        }

        public void SetPositionAndRotation(Vector3 position, Quaternion rotation)
        {
            this.rotation = rotation;
            this.position = position;
        }

        public void Translate(Vector3 translation)
        {
            Translate(translation, Space.Self);
        }

        public void Translate(Vector3 translation, Space relativeTo)
        {
            position += relativeTo == Space.World ? translation : TransformDirection(translation);
        }

        public void Rotate(Vector3 eulers)
        {
            Rotate(eulers, Space.Self);
        }

        public void Rotate(Vector3 eulers, Space relativeTo)
        {
            Quaternion turn = Quaternion.Euler(eulers);
            rotation = relativeTo == Space.Self ? rotation * turn : turn * rotation;
        }

        public void Rotate(float xAngle, float yAngle, float zAngle)
        {
            Rotate(new Vector3(xAngle, yAngle, zAngle), Space.Self);
        }

        public void LookAt(Transform target)
        {
            LookAt(target.position);
        }

        public void LookAt(Vector3 worldPosition)
        {
            rotation = Quaternion.LookRotation(worldPosition - position);
        }

        public Vector3 TransformPoint(Vector3 position)
        {
            Vector3 local = _localPosition + _localRotation * Vector3.Scale(_localScale, position);
            return _parent == null ? local : _parent.TransformPoint(local);
        }

        public Vector3 InverseTransformPoint(Vector3 position)
        {
            Vector3 local = _parent == null ? position : _parent.InverseTransformPoint(position);
            Vector3 turned = Quaternion.Inverse(_localRotation) * (local - _localPosition);
            return new Vector3(turned.x / _localScale.x, turned.y / _localScale.y, turned.z / _localScale.z);
        }

        public Vector3 TransformDirection(Vector3 direction)
        {
            return rotation * direction;
        }

        public Vector3 InverseTransformDirection(Vector3 direction)
        {
            return Quaternion.Inverse(rotation) * direction;
        }

        public Transform GetChild(int index)
        {
            return _children[index];
        }

        public Transform Find(string n)
        {
            foreach (Transform child in _children)
            {
                int slash = n.IndexOf('/');
                if (child.NameOf() == (slash < 0 ? n : n.Substring(0, slash)))
                {
                    return slash < 0 ? child : child.Find(n.Substring(slash + 1));
                }
            }
            return null;
        }

        public bool IsChildOf(Transform parent)
        {
            return this == parent || _parent != null && _parent.IsChildOf(parent);
        }

        public IEnumerator GetEnumerator()
        {
            return _children.ToArray().GetEnumerator();
        }

        internal IEnumerable<Transform> Hierarchy()
        {
            yield return this;
            foreach (Transform child in _children.ToArray())
            {
                foreach (Transform below in child.Hierarchy())
                {
                    yield return below;
                }
            }
        }

        internal void TakeOver(Transform other)
        {
            _parent = other._parent;
            if (_parent != null)
            {
                _parent._children[_parent._children.IndexOf(other)] = this;
            }
            foreach (Transform child in other._children)
            {
                child._parent = this;
                _children.Add(child);
            }
            _localPosition = other._localPosition;
            _localRotation = other._localRotation;
            _localScale = other._localScale;
        }

        internal override void ActivityChanged()
        {
            foreach (Transform transform in Hierarchy())
            {
                transform.Owner.ActivityChangedExceptTransform();
            }
        }

        internal override void Die()
        {
            if (_parent != null)
            {
                _parent._children.Remove(this);
            }
            base.Die();
        }
    }

    public sealed class RectTransform : Transform
    {
        public Vector2 anchorMin { get; set; }

        public Vector2 anchorMax { get; set; }

        public Vector2 anchoredPosition { get; set; }

        public Vector2 sizeDelta { get; set; }

        public Vector2 pivot { get; set; }

        /// <summary>Without what anchors that are apart would add.</summary>
        public Rect rect
        {
            get { return new Rect(-sizeDelta.x * pivot.x, -sizeDelta.y * pivot.y, sizeDelta.x, sizeDelta.y); }
        }

        public Vector2 offsetMin
        {
            get { return anchoredPosition - Vector2.Scale(sizeDelta, pivot); }

            set
            {
                Vector2 max = offsetMax;
                sizeDelta = max - value;
                anchoredPosition = value + Vector2.Scale(sizeDelta, pivot);
            }
        }

        public Vector2 offsetMax
        {
            get { return anchoredPosition + Vector2.Scale(sizeDelta, Vector2.one - pivot); }

            set
            {
                Vector2 min = offsetMin;
                sizeDelta = value - min;
                anchoredPosition = min + Vector2.Scale(sizeDelta, pivot);
            }
        }
    }

    public enum Space
    {
        World = 0,
        Self = 1,
    }
}
