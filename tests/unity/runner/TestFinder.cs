// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Collections.Generic;
using System.Linq;
using System.Reflection;
using NUnit.Framework;
using UnityEngine.TestTools;

namespace Ros2Gateway.Runner
{
    /// <summary>Finds tests by the attributes that NUnit 2.6, NUnit 3 and Unity's Test Framework
    /// share.</summary>
    public static class TestFinder
    {
        private const BindingFlags Members =
            BindingFlags.Instance | BindingFlags.Static | BindingFlags.Public | BindingFlags.NonPublic;

        public static IList<TestCase> Find(Assembly assembly)
        {
            var tests = new List<TestCase>();
            var names = new Dictionary<string, int>();
            foreach (Type type in assembly.GetTypes().OrderBy(t => t.FullName, StringComparer.Ordinal))
            {
                if (type.IsAbstract || type.ContainsGenericParameters)
                {
                    continue;
                }
                foreach (Fixture fixture in Fixtures(type))
                {
                    foreach (TestCase test in type.GetMethods(Members).SelectMany(m => Cases(fixture, m)))
                    {
                        int count;
                        names.TryGetValue(test.Name, out count);
                        names[test.Name] = count + 1;
                        if (count > 0)
                        {
                            test.Name += "#" + (count + 1);
                        }
                        tests.Add(test);
                    }
                }
            }
            return tests;
        }

        private static IEnumerable<Fixture> Fixtures(Type type)
        {
            TestFixtureAttribute[] attributes = Attributes<TestFixtureAttribute>(type).ToArray();
            return attributes.Length == 0
                ? new[] { new Fixture(type, null) }
                : attributes.Select(a => new Fixture(type, a.Arguments)).ToArray();
        }

        private static IEnumerable<TestCase> Cases(Fixture fixture, MethodInfo method)
        {
            foreach (TestCaseAttribute attribute in Attributes<TestCaseAttribute>(method))
            {
                TestCase test = Case(fixture, method, attribute.Arguments, attribute.TestName);
                test.ExpectsResult = attribute.HasExpectedResult;
                test.ExpectedResult = attribute.ExpectedResult;
                test.SkipReason = test.SkipReason ?? (attribute.Ignore ? attribute.IgnoreReason : null);
                yield return test;
            }
            foreach (TestCaseSourceAttribute source in Attributes<TestCaseSourceAttribute>(method))
            {
                foreach (object item in Items(source.SourceType ?? fixture.Type, source.SourceName, fixture))
                {
                    yield return FromSource(fixture, method, item);
                }
            }
            if (Attributes<TestAttribute>(method).Any() || Attributes<UnityTestAttribute>(method).Any())
            {
                foreach (object[] arguments in Combinations(method.GetParameters()))
                {
                    yield return Case(fixture, method, arguments, null);
                }
            }
        }

        private static TestCase FromSource(Fixture fixture, MethodInfo method, object item)
        {
            var data = item as TestCaseData;
            if (data == null)
            {
                // an array is the arguments, unless an array is what the only parameter takes
                ParameterInfo[] parameters = method.GetParameters();
                bool single = parameters.Length == 1 && parameters[0].ParameterType.IsInstanceOfType(item);
                object[] arguments = single ? new[] { item } : item as object[] ?? new[] { item };
                return Case(fixture, method, arguments, null);
            }
            TestCase test = Case(fixture, method, data.Arguments, data.TestName);
            test.ExpectsResult = data.HasExpectedResult;
            test.ExpectedResult = data.Result;
            return test;
        }

        private static TestCase Case(Fixture fixture, MethodInfo method, object[] arguments, string name)
        {
            ParameterInfo[] parameters = method.GetParameters();
            var test = new TestCase
            {
                Fixture = fixture,
                Method = method,
                Arguments = arguments.Select((a, i) => Arguments.Converted(a, parameters, i)).ToArray(),
                Name = fixture.Type.Name + "." + (name ?? method.Name + Arguments.Words(arguments)),
            };
            foreach (MemberInfo member in new MemberInfo[] { fixture.Type, method })
            {
                foreach (CategoryAttribute category in Attributes<CategoryAttribute>(member))
                {
                    test.Categories.Add(category.Name);
                }
                foreach (IgnoreAttribute ignore in Attributes<IgnoreAttribute>(member))
                {
                    test.SkipReason = string.IsNullOrEmpty(ignore.Reason) ? "ignored" : ignore.Reason;
                }
                foreach (ExplicitAttribute attribute in Attributes<ExplicitAttribute>(member))
                {
                    test.SkipReason = string.IsNullOrEmpty(attribute.Reason) ? "explicit" : attribute.Reason;
                }
                foreach (TimeoutAttribute timeout in Attributes<TimeoutAttribute>(member))
                {
                    test.TimeoutMs = (int)timeout.Properties["Timeout"];
                }
            }
            return test;
        }

        private static IEnumerable Items(Type type, string name, Fixture fixture)
        {
            MemberInfo member = type.GetMember(name, Members | BindingFlags.FlattenHierarchy).Single();
            var field = member as FieldInfo;
            if (field != null)
            {
                return (IEnumerable)field.GetValue(field.IsStatic ? null : fixture.Instance);
            }
            MethodInfo method = member as MethodInfo ?? ((PropertyInfo)member).GetGetMethod(true);
            return (IEnumerable)method.Invoke(method.IsStatic ? null : fixture.Instance, null);
        }

        private static IEnumerable<object[]> Combinations(ParameterInfo[] parameters)
        {
            IEnumerable<object[]> combinations = new[] { new object[0] };
            foreach (ParameterInfo parameter in parameters)
            {
                ValuesAttribute values = parameter.GetCustomAttributes(typeof(ValuesAttribute), false)
                    .Cast<ValuesAttribute>().Single();
                object[] choices = values.GetData(parameter).Cast<object>().ToArray();
                combinations = combinations.SelectMany(
                    start => choices.Select(choice => start.Concat(new[] { choice }).ToArray())).ToArray();
            }
            return combinations;
        }

        private static IEnumerable<T> Attributes<T>(MemberInfo member)
        {
            return member.GetCustomAttributes(typeof(T), true).Cast<T>();
        }
    }
}
