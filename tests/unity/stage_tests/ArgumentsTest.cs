// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;
using NUnit.Framework;

namespace Ros2Gateway.Stage.Tests
{
    [TestFixture]
    public class ArgumentsTest
    {
        private static IEnumerable<TestCaseData> Sums()
        {
            yield return new TestCaseData(1, 2).Returns(3);
            yield return new TestCaseData(2, 2).Returns(4).SetName("two and two");
        }

        [TestCase(1, 2.5)]
        [TestCase(3, 4)]
        public void Numbers_are_converted(byte small, double large)
        {
            Assert.Less(small, large);
        }

        [TestCase("a\"\n", ExpectedResult = 3)]
        [TestCase("", ExpectedResult = 0)]
        public int Results_are_compared(string text)
        {
            return text.Length;
        }

        [TestCaseSource("Sums")]
        public int Sources_give_arguments(int a, int b)
        {
            return a + b;
        }

        [Test]
        public void Values_are_combined([Values(1, 2)] int a, [Values("x", "y")] string b)
        {
            Assert.IsTrue(a > 0 && b.Length == 1);
        }

        [Test]
        [Ignore("on purpose")]
        public void Ignored_tests_do_not_run()
        {
            Assert.Fail();
        }
    }
}
