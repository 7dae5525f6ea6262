// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine
{
    public class Renderer : Component
    {
        private Material _material;
        private bool _enabled = true;

        public bool enabled
        {
            get { return _enabled; }
            set { _enabled = value; }
        }

        public Material material
        {
            get { return _material ?? (_material = new Material(Shader.Find("Standard"))); }
            set { _material = value; }
        }

        public Material sharedMaterial
        {
            get { return _material; }
            set { _material = value; }
        }

        /// <summary>As of a cube with sides of 1, which is not turned.</summary>
        public Bounds bounds
        {
            get { return new Bounds(transform.position, transform.lossyScale); }
        }

        public Rendering.ShadowCastingMode shadowCastingMode { get; set; }

        public bool receiveShadows { get; set; }
    }

    public class MeshRenderer : Renderer
    {
    }

    public sealed class LineRenderer : Renderer
    {
        private Vector3[] _positions = new Vector3[0];

        public int positionCount
        {
            get { return _positions.Length; }
            set { System.Array.Resize(ref _positions, value); }
        }

        public float startWidth { get; set; }

        public float endWidth { get; set; }

        public float widthMultiplier { get; set; }

        public Color startColor { get; set; }

        public Color endColor { get; set; }

        public bool useWorldSpace { get; set; }

        public bool loop { get; set; }

        public void SetPosition(int index, Vector3 position)
        {
            _positions[index] = position;
        }

        public Vector3 GetPosition(int index)
        {
            return _positions[index];
        }

        public void SetPositions(Vector3[] positions)
        {
            System.Array.Copy(positions, _positions, Mathf.Min(positions.Length, _positions.Length));
        }

        public int GetPositions(Vector3[] positions)
        {
            int count = Mathf.Min(positions.Length, _positions.Length);
            System.Array.Copy(_positions, positions, count);
            return count;
        }
    }
}
