// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using System.Xml;

namespace Ros2Gateway.Robots
{
    /// <summary>XML as a tree of elements: what is common to all that robots describe themselves by.</summary>
    internal static class XmlTree
    {
        /// <summary>For documents of anybody's.</summary>
        internal static XmlReaderSettings Settings
        {
            get
            {
                return new XmlReaderSettings
                {
                    DtdProcessing = DtdProcessing.Prohibit, // entities may grow without bound, or open files
                    XmlResolver = null,
                    IgnoreComments = true,
                    IgnoreProcessingInstructions = true,
                    IgnoreWhitespace = true,
                };
            }
        }

        /// <summary>Reads a whole document.</summary>
        /// <exception cref="XmlException">It is not XML.</exception>
        internal static XmlElement Root(XmlReader reader)
        {
            XmlDocument document = new() { XmlResolver = null };
            document.Load(reader);
            return document.DocumentElement;
        }

        /// <summary>The first element of a name below another, or null.</summary>
        internal static XmlElement Child(XmlElement element, string name)
        {
            foreach (XmlElement child in Children(element, name))
            {
                return child;
            }
            return null;
        }

        /// <summary>The elements of a name below another.</summary>
        internal static IEnumerable<XmlElement> Children(XmlElement element, string name)
        {
            foreach (XmlElement child in Children(element))
            {
                if (child.Name == name)
                {
                    yield return child;
                }
            }
        }

        /// <summary>All elements below another.</summary>
        internal static IEnumerable<XmlElement> Children(XmlElement element)
        {
            for (XmlNode child = element.FirstChild; child != null; child = child.NextSibling)
            {
                XmlElement found = child as XmlElement;
                if (found != null)
                {
                    yield return found;
                }
            }
        }
    }
}
