// SPDX-License-Identifier: Apache-2.0
using System.Reflection;
using System.Threading;
using NUnit.Framework;
using Ros2Gateway.Pictures;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public sealed class BackgroundDecoderTests
    {
        private const int TimeoutMilliseconds = 60000;

        [Test]
        public void APictureIsDecodedOnAnotherThread()
        {
            BackgroundDecoder decoder = new();
            decoder.Offer(SmallPictures.RedAboveBlue(), "jpeg");
            DecodedPicture picture = Next(decoder);
            Assert.IsNull(picture.Error);
            Assert.IsFalse(picture.IsOther);
            Assert.AreEqual(SmallPictures.Width, picture.Width);
            Assert.AreEqual(SmallPictures.Height, picture.Height);
            Assert.AreEqual("jpeg", picture.Format);
            CollectionAssert.AreEqual(SmallPictures.RedAboveBlue(), picture.Compressed());
            CollectionAssert.AreEqual(new byte[] { 0, 0, 254, 255 }, First(picture.Pixels, 4));
            Assert.IsNull(decoder.Take(), "each is taken once");
        }

        [Test]
        public void OfManyPicturesTheNewestIsShownAndTheOthersAreCounted()
        {
            const int Pictures = 200;
            BackgroundDecoder decoder = new();
            int taken = 0;
            for (int i = 1; i <= Pictures; i++)
            {
                decoder.Offer(SmallPictures.RedAboveBlue(), i.ToString());
            }
            string last = "";
            while (last != Pictures.ToString())
            {
                DecodedPicture picture = Next(decoder);
                Assert.Greater(int.Parse(picture.Format), last == "" ? 0 : int.Parse(last), "none comes late");
                last = picture.Format;
                taken++;
                decoder.GiveBack(picture);
            }
            Assert.AreEqual(Pictures, taken + decoder.Skipped);
        }

        [Test]
        public void WhatIsNoBaselineJpegIsHandedBack()
        {
            BackgroundDecoder decoder = new();
            decoder.Offer(SmallPictures.Progressive(), "jpeg");
            DecodedPicture picture = Next(decoder);
            Assert.IsTrue(picture.IsOther);
            Assert.IsNull(picture.Error);
            CollectionAssert.AreEqual(SmallPictures.Progressive(), picture.Compressed());
            decoder.GiveBack(picture);
            decoder.Offer(new byte[] { 1, 2, 3 }, "png");
            picture = Next(decoder);
            Assert.IsTrue(picture.IsOther);
            CollectionAssert.AreEqual(new byte[] { 1, 2, 3 }, picture.Compressed());
            decoder.GiveBack(picture);
            decoder.Offer(null, "nothing");
            Assert.AreEqual(0, Next(decoder).Compressed().Length);
        }

        [Test]
        public void ADamagedPictureIsAnErrorAndTheNextIsRight()
        {
            BackgroundDecoder decoder = new();
            decoder.Offer(First(SmallPictures.RedAboveBlue(), 300), "jpeg");
            DecodedPicture picture = Next(decoder);
            Assert.AreEqual("the data end within the picture (byte 300)", picture.Error);
            Assert.AreEqual(0, picture.Width);
            decoder.GiveBack(picture);
            decoder.Offer(SmallPictures.RedAboveBlue(), "jpeg");
            picture = Next(decoder);
            Assert.IsNull(picture.Error);
            Assert.AreEqual(SmallPictures.Width, picture.Width);
        }

        [Test]
        public void AFaultOfTheDecoderIsAnErrorAndTheNextPictureIsRight()
        {
            BackgroundDecoder decoder = new();
            FieldInfo field = typeof(BackgroundDecoder).GetField("_jpeg", BindingFlags.NonPublic | BindingFlags.Instance);
            object jpeg = field.GetValue(decoder);
            field.SetValue(decoder, null); // no picture is known that it would throw at
            decoder.Offer(SmallPictures.RedAboveBlue(), "jpeg");
            DecodedPicture picture = Next(decoder);
            StringAssert.StartsWith("the decoder failed: NullReferenceException", picture.Error);
            decoder.GiveBack(picture);
            field.SetValue(decoder, jpeg);
            decoder.Offer(SmallPictures.RedAboveBlue(), "jpeg");
            Assert.IsNull(Next(decoder).Error);
        }

        [Test]
        public void BuffersAreUsedAgain()
        {
            BackgroundDecoder decoder = new();
            decoder.Offer(SmallPictures.RedAboveBlue(), "jpeg");
            DecodedPicture first = Next(decoder);
            byte[] pixels = first.Pixels;
            decoder.GiveBack(first);
            for (int i = 0; i < 10; i++)
            {
                decoder.Offer(SmallPictures.RedAboveBlue(), "jpeg");
                DecodedPicture next = Next(decoder);
                Assert.AreSame(pixels, next.Pixels);
                decoder.GiveBack(next);
            }
        }

        private static DecodedPicture Next(BackgroundDecoder decoder)
        {
            DecodedPicture picture = null;
            bool isThere = SpinWait.SpinUntil(() => (picture = decoder.Take()) != null, TimeoutMilliseconds);
            Assert.IsTrue(isThere, "waited in vain for a picture");
            return picture;
        }

        private static byte[] First(byte[] bytes, int count)
        {
            System.Array.Resize(ref bytes, count);
            return bytes;
        }
    }
}
