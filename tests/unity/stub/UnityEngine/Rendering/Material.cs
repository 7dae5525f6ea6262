// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;

namespace UnityEngine
{
    public sealed class Shader : Object
    {
        internal Shader(string name)
        {
            Rename(name);
        }

        public static Shader Find(string name)
        {
            return new Shader(name);
        }

        public static int PropertyToID(string name)
        {
            return name.GetHashCode();
        }
    }

    public class Material : Object
    {
        private readonly Dictionary<int, Color> _colors = new Dictionary<int, Color>();
        private readonly Dictionary<int, Texture> _textures = new Dictionary<int, Texture>();
        private readonly Dictionary<int, float> _floats = new Dictionary<int, float>();

        public Material(Shader shader)
        {
            this.shader = shader;
            color = Color.white;
        }

        public Material(Material source)
            : this(source.shader)
        {
            color = source.color;
            mainTexture = source.mainTexture;
        }

        public Shader shader { get; set; }

        public Color color { get; set; }

        public Texture mainTexture { get; set; }

        public Vector2 mainTextureScale { get; set; }

        public Vector2 mainTextureOffset { get; set; }

        public int renderQueue { get; set; }

        public bool HasProperty(string name)
        {
            return true;
        }

        public void SetColor(string name, Color value)
        {
            _colors[Shader.PropertyToID(name)] = value;
        }

        public Color GetColor(string name)
        {
            Color value;
            return _colors.TryGetValue(Shader.PropertyToID(name), out value) ? value : color;
        }

        public void SetTexture(string name, Texture value)
        {
            _textures[Shader.PropertyToID(name)] = value;
        }

        public Texture GetTexture(string name)
        {
            Texture value;
            _textures.TryGetValue(Shader.PropertyToID(name), out value);
            return value;
        }

        public void SetFloat(string name, float value)
        {
            _floats[Shader.PropertyToID(name)] = value;
        }

        public float GetFloat(string name)
        {
            float value;
            _floats.TryGetValue(Shader.PropertyToID(name), out value);
            return value;
        }
    }
}
