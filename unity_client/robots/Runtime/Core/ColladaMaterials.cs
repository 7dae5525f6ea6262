// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Xml;
using Ros2Gateway.Shapes;

namespace Ros2Gateway.Robots
{
    /// <summary>The colours of a COLLADA file. Each is looked for once.</summary>
    internal sealed class ColladaMaterials
    {
        private readonly Dictionary<string, XmlElement> _byId;
        private readonly Func<XmlElement, string, XmlElement> _referred;
        private readonly Dictionary<XmlElement, Rgba?> _colors = new(); // of materials
        private readonly Dictionary<XmlElement, Dictionary<string, XmlElement>> _bound
            = new(); // by instances of geometries

        /// <param name="referred">The target of an element's attribute.</param>
        internal ColladaMaterials(Dictionary<string, XmlElement> byId, Func<XmlElement, string, XmlElement> referred)
        {
            _byId = byId;
            _referred = referred;
        }

        /// <summary>
        /// The colour, in diffuse light, of the material that an instance binds to a name, else of that with the name as
        /// its id. Null if it has none, or a texture.
        /// </summary>
        /// <param name="instance">May be null.</param>
        internal Rgba? Color(string name, XmlElement instance)
        {
            XmlElement material;
            if ((instance == null || !Bound(instance).TryGetValue(name, out material))
                && !_byId.TryGetValue(name, out material))
            {
                return null;
            }
            if (!_colors.TryGetValue(material, out Rgba? color))
            {
                color = _colors[material] = Read(material);
            }
            return color;
        }

        private Dictionary<string, XmlElement> Bound(XmlElement instance)
        {
            if (_bound.TryGetValue(instance, out Dictionary<string, XmlElement> bound))
            {
                return bound;
            }
            bound = _bound[instance] = new Dictionary<string, XmlElement>();
            XmlElement bind = XmlTree.Child(instance, "bind_material");
            XmlElement technique = bind == null ? null : XmlTree.Child(bind, "technique_common");
            if (technique != null)
            {
                foreach (XmlElement binding in XmlTree.Children(technique, "instance_material"))
                {
                    bound[binding.GetAttribute("symbol")] = _referred(binding, "target");
                }
            }
            return bound;
        }

        private Rgba? Read(XmlElement material)
        {
            XmlElement effect = XmlTree.Child(material, "instance_effect");
            XmlElement at = effect == null ? null : _referred(effect, "url");
            foreach (string name in new[] { "profile_COMMON", "technique", null, "diffuse", "color" })
            {
                at = at == null ? null : name == null ? Shading(at) : XmlTree.Child(at, name);
            }
            if (at == null)
            {
                return null;
            }
            float[] parts = ColladaNumbers.Floats(at.InnerText, 3, "<color>");
            return Rgba.Of(parts[0], parts[1], parts[2], 1);
        }

        private static XmlElement Shading(XmlElement technique)
        {
            foreach (XmlElement child in XmlTree.Children(technique))
            {
                if (XmlTree.Child(child, "diffuse") != null)
                {
                    return child; // phong, lambert or blinn
                }
            }
            return null;
        }
    }
}
