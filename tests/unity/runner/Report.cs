// SPDX-License-Identifier: Apache-2.0
using System.Globalization;
using System.Linq;
using System.Text;

namespace Ros2Gateway.Runner
{
    /// <summary>Results as lines: JSON for pytest, words for people.</summary>
    public static class Report
    {
        public static string Listed(TestCase test)
        {
            string categories = string.Join(",", test.Categories.Select(Quoted).ToArray());
            return "{\"name\":" + Quoted(test.Name) + ",\"categories\":[" + categories + "]}";
        }

        public static string Line(TestResult result)
        {
            return "{\"name\":" + Quoted(result.Name)
                + ",\"outcome\":" + Quoted(result.Outcome.ToString().ToLowerInvariant())
                + ",\"message\":" + Quoted(result.Message)
                + ",\"output\":" + Quoted(result.Output)
                + ",\"last\":" + (result.IsLast ? "true" : "false")
                + ",\"seconds\":" + result.Seconds.ToString("0.####", CultureInfo.InvariantCulture) + "}";
        }

        public static string Words(TestResult result)
        {
            string line = result.Outcome.ToString().ToLowerInvariant().PadRight(8) + result.Name;
            if (result.Outcome == Outcome.Passed)
            {
                return line;
            }
            string details = (result.Message + "\n" + result.Output).Trim();
            return line + "\n    " + details.Replace("\n", "\n    ");
        }

        private static string Quoted(string text)
        {
            var quoted = new StringBuilder("\"");
            foreach (char c in text ?? "")
            {
                if (c == '"' || c == '\\')
                {
                    quoted.Append('\\').Append(c);
                }
                else if (c < ' ' || c > '~')
                {
                    quoted.Append("\\u").Append(((int)c).ToString("x4"));
                }
                else
                {
                    quoted.Append(c);
                }
            }
            return quoted.Append('"').ToString();
        }
    }
}
