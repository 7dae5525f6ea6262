// SPDX-License-Identifier: Apache-2.0
using System;
using System.Reflection.Emit;
using NUnit.Framework;

namespace Ros2Gateway.Stage.Tests
{
    [TestFixture]
    [Category("Jit")]
    public class JitTest
    {
        [Test]
        public void Code_is_made_at_run_time()
        {
            var method = new DynamicMethod("two", typeof(int), Type.EmptyTypes);
            ILGenerator code = method.GetILGenerator();
            code.Emit(OpCodes.Ldc_I4_2);
            code.Emit(OpCodes.Ret);
            Assert.AreEqual(2, ((Func<int>)method.CreateDelegate(typeof(Func<int>)))());
        }
    }
}
