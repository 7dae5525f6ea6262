// SPDX-License-Identifier: Apache-2.0
using NUnit.Framework;

namespace Ros2Gateway.Tests
{
    /// <summary>Transforms of the simulated robot, through a live gateway.</summary>
    [TestFixture]
    [Category("Gateway")]
    public sealed class TransformWatchTests
    {
        [Test]
        public void APoseThatNeverChangesIsNeverOld()
        {
            using (Live live = Live.Connected())
            using (TransformWatch watch = live.Client.WatchTransform("base_link", "base_scan"))
            {
                Pose<Flu> pose;
                double age;
                live.Until(() => watch.TryGet(out pose, out age), "for the transform");
                Assert.IsNull(watch.Problem);
                watch.TryGet(out pose, out age);
                Assert.AreEqual(0, age);
                Assert.AreEqual(0.122, pose.position.z, 1e-9);
                Assert.AreEqual(1, pose.orientation.w, 1e-9);
            }
        }

        [Test]
        public void APoseThatIsPublishedComesAgainAndAgain()
        {
            using (Live live = Live.Connected())
            using (TransformWatch watch = live.Client.WatchTransform("odom", "base_link"))
            {
                Pose<Flu> pose;
                double age = 0, before = 0;
                int renewed = 0;
                live.Until(() => renewed >= 3, "for three poses", () =>
                {
                    live.Client.Pump();
                    bool isKnown = watch.TryGet(out pose, out age);
                    renewed += isKnown && age < before ? 1 : 0;
                    before = isKnown ? age : 0;
                });
            }
        }

        [Test]
        public void AFrameThatNobodyKnowsIsToldInTheGatewaysWords()
        {
            using (Live live = Live.Connected())
            using (TransformWatch watch = live.Client.WatchTransform("base_link", "bas_scan"))
            {
                Pose<Flu> pose;
                double age;
                StringAssert.Contains("not known yet", watch.Problem);
                live.Until(() => watch.Problem.Contains("bas_scan"), "for the warning");
                Assert.IsFalse(watch.TryGet(out pose, out age));
            }
        }

        [Test]
        public void ItIsRestoredWithTheConnectionAndSaysMeanwhileThatThereIsNone()
        {
            using (Live live = Live.Connected(Live.Rogue, "/through"))
            using (TransformWatch watch = live.Client.WatchTransform("base_link", "base_scan"))
            {
                Pose<Flu> pose;
                double age = 0;
                live.Until(() => watch.TryGet(out pose, out age), "for the transform");
                bool wasLost = false;
                live.Client.StateChanged += state => wasLost |= watch.Problem == "not connected";
                live.Client.Request("cut", null, null);
                live.Until(() => wasLost, "for the loss");
                Assert.IsTrue(watch.TryGet(out pose, out age), "what was known stays");
                live.Until(() => watch.Problem == null, "for the transform again");
            }
        }

        [Test]
        public void AWatchThatIsOneTooManyIsAskedForAgainAndComesWhenThereIsRoom()
        {
            using Live live = Live.Connected();
            TransformWatch[] watches = new TransformWatch[16];
            for (int i = 0; i < watches.Length; i++)
            {
                watches[i] = live.Client.WatchTransform("odom", "base_link");
            }
            TransformWatch late = live.Client.WatchTransform("base_link", "base_scan");
            live.Until(() => late.Problem != null && late.Problem.Contains("at most 16"), "for the refusal");
            watches[3].Dispose();
            live.Until(() => late.Problem == null, "for the transform");
            Assert.AreEqual(1, live.Events.FindAll(happened => happened.Text.Contains("at most 16")).Count);
        }

        [Test]
        public void AWatchThatHasEndedIsAskedForNoMore()
        {
            using Live live = Live.Connected();
            TransformWatch watch = live.Client.WatchTransform("odom", "base_link");
            Pose<Flu> pose;
            double age = 0;
            live.Until(() => watch.TryGet(out pose, out age), "for the transform");
            watch.Dispose();
            watch.Dispose();
            // as many as the gateway takes, again and again: it would refuse the 17th if one was left
            for (int round = 0; round < 3; round++)
            {
                TransformWatch[] watches = new TransformWatch[16];
                for (int i = 0; i < watches.Length; i++)
                {
                    watches[i] = live.Client.WatchTransform("odom", "base_link");
                }
                live.Until(() => System.Array.TrueForAll(watches, w => w.Problem == null), "for all of them");
                foreach (TransformWatch one in watches)
                {
                    one.Dispose();
                }
            }
            Assert.IsFalse(live.Heard("at most"), string.Join(" | ", live.Events));
        }
    }
}
