// SPDX-License-Identifier: Apache-2.0
using System;
using NUnit.Framework;
using Ros2Gateway.Json;
using Ros2Gateway.Maps;
using Ros2Gateway.Messages.NavMsgs;

namespace Ros2Gateway.Tests
{
    [TestFixture]
    public sealed class OccupancyGridTests
    {
        [Test]
        public void CellsHaveTheColoursOfAMap()
        {
            OccupancyGridPixels pixels = new(OccupancyGridColors.Map);
            Assert.IsNull(pixels.Draw(Grid(3, 2, 0, 100, -1, 50, 101, -128)));
            Assert.AreEqual(3, pixels.Width);
            Assert.AreEqual(2, pixels.Height);
            CollectionAssert.AreEqual(new byte[] { 255, 255, 255, 255 }, Pixel(pixels, 0));
            CollectionAssert.AreEqual(new byte[] { 0, 0, 0, 255 }, Pixel(pixels, 1));
            CollectionAssert.AreEqual(new byte[] { 112, 137, 134, 255 }, Pixel(pixels, 2));
            CollectionAssert.AreEqual(new byte[] { 128, 128, 128, 255 }, Pixel(pixels, 3));
            CollectionAssert.AreEqual(new byte[] { 0, 160, 0, 255 }, Pixel(pixels, 4));
            CollectionAssert.AreEqual(Pixel(pixels, 2), Pixel(pixels, 5));
        }

        [Test]
        public void ACostmapIsClearWhereItIsFree()
        {
            OccupancyGridPixels pixels = new(OccupancyGridColors.Costmap);
            Assert.IsNull(pixels.Draw(Grid(5, 1, 0, -1, 98, 99, 100)));
            Assert.AreEqual(0, Pixel(pixels, 0)[3]);
            Assert.AreEqual(0, Pixel(pixels, 1)[3]);
            CollectionAssert.AreEqual(new byte[] { 255, 0, 0, 160 }, Pixel(pixels, 2));
            CollectionAssert.AreEqual(new byte[] { 0, 255, 255, 200 }, Pixel(pixels, 3));
            CollectionAssert.AreEqual(new byte[] { 255, 0, 255, 200 }, Pixel(pixels, 4));
        }

        [Test]
        public void ThinWallsSurviveWhereCellsShareAPixel()
        {
            OccupancyGridMsg grid = Grid(2 * OccupancyGridPixels.MaxSide + 1, 3, new sbyte[3 * (2 * OccupancyGridPixels.MaxSide + 1)]);
            grid.data[grid.data.Length - 2] = 100; // the upper row, the last but one of its cells
            OccupancyGridPixels pixels = new(OccupancyGridColors.Map);
            Assert.IsNull(pixels.Draw(grid));
            Assert.AreEqual(3, pixels.CellsPerPixel);
            Assert.AreEqual(1, pixels.Height);
            Assert.LessOrEqual(pixels.Width, OccupancyGridPixels.MaxSide);
            Assert.AreEqual(0, Pixel(pixels, pixels.Width - 1)[0]);
            Assert.AreEqual(255, Pixel(pixels, 0)[0]);
        }

        [Test]
        public void WhatDoesNotFitTogetherIsSaid()
        {
            OccupancyGridPixels pixels = new(OccupancyGridColors.Map);
            StringAssert.Contains("have 5 cells, must have 3 by 2", pixels.Draw(Grid(3, 2, 1, 2, 3, 4, 5)));
            StringAssert.Contains("no cells: 0 by 2", pixels.Draw(Grid(0, 2)));
            OccupancyGridMsg huge = Grid(1, 1, 1);
            huge.info.width = huge.info.height = uint.MaxValue;
            StringAssert.Contains("must have 4294967295 by 4294967295", pixels.Draw(huge));
            foreach (float resolution in new[] { 0, -1, float.NaN, float.PositiveInfinity })
            {
                OccupancyGridMsg grid = Grid(1, 1, 1);
                grid.info.resolution = resolution;
                StringAssert.Contains("resolution", pixels.Draw(grid));
            }
            OccupancyGridMsg empty = Grid(1, 1, 1);
            empty.data = null;
            StringAssert.Contains("no data", pixels.Draw(empty));
            empty.info = null;
            StringAssert.Contains("no info", pixels.Draw(empty));
        }

        [Test]
        [Category("Gateway")]
        [Category("Inflates")]
        public void AMapAsAPictureHasTheCellsOfTheArray()
        {
            using (Live picturesClient = Live.Connected())
            using (Live arraysClient = Live.Connected())
            {
                OccupancyGridMsg fromPicture = null, fromArray = null;
                picturesClient.Client.Subscribe<OccupancyGridMsg>("/map", map => fromPicture = map, AsPicture());
                arraysClient.Client.Subscribe<OccupancyGridMsg>("/map", map => fromArray = map);
                picturesClient.Until(() => fromPicture != null, "for the picture");
                arraysClient.Until(() => fromArray != null, "for the array");
                Assert.Greater(fromArray.data.Length, 1000);
                CollectionAssert.AreEqual(fromArray.data, fromPicture.data);
                Assert.AreEqual(fromArray.info.width, fromPicture.info.width);
                Assert.AreEqual(fromArray.info.resolution, fromPicture.info.resolution);
                Assert.AreEqual(fromArray.info.origin.position.x, fromPicture.info.origin.position.x);
                Assert.AreEqual(fromArray.header.frame_id, fromPicture.header.frame_id);
                Assert.Less(picturesClient.Client.BytesReceived, arraysClient.Client.BytesReceived);
            }
        }

        [Test]
        [Category("Gateway")]
        [Category("Inflates")]
        public void OneSubscriptionMayAskForAPictureWhereAnotherDoesNot()
        {
            using Live live = Live.Connected();
            OccupancyGridMsg plain = null, fromPicture = null;
            Subscription<OccupancyGridMsg> before = live.Client.Subscribe<OccupancyGridMsg>("/map", map => plain = map);
            live.Until(() => plain != null, "for the array");
            sbyte[] cells = plain.data;
            plain = null;
            live.Client.Subscribe<OccupancyGridMsg>("/map", map => fromPicture = map, AsPicture());
            live.Until(() => plain != null && fromPicture != null, "for the map to come to both");
            CollectionAssert.AreEqual(cells, plain.data);
            CollectionAssert.AreEqual(cells, fromPicture.data);
            Assert.AreEqual(0, before.Unreadable);
        }

        [Test]
        public void CellsThatAreNeitherArrayNorPictureAreToldOf()
        {
            JsonReader reader = new() { PackedInt8s = OccupancyGridPng.Cells };
            byte[] text = System.Text.Encoding.UTF8.GetBytes("{\"data\":\"AAAA\"}");
            reader.Reset(text, 0, text.Length);
            JsonFormatException error = Assert.Throws<JsonFormatException>(() => new OccupancyGridMsg().Read(reader));
            StringAssert.Contains(
                "data: expected an array or a PNG, but the image cannot be read: it is not a PNG", error.Message);
        }

        private static SubscribeOptions AsPicture()
        {
            SubscribeOptions options = new();
            OccupancyGridPng.Ask(options);
            return options;
        }

        private static OccupancyGridMsg Grid(uint width, uint height, params sbyte[] cells)
        {
            OccupancyGridMsg grid = new() { data = cells };
            grid.info.width = width;
            grid.info.height = height;
            grid.info.resolution = 0.05f;
            return grid;
        }

        private static byte[] Pixel(OccupancyGridPixels pixels, int index)
        {
            byte[] pixel = new byte[4];
            Array.Copy(pixels.Pixels, 4 * index, pixel, 0, 4);
            return pixel;
        }
    }
}
