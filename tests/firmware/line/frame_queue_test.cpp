// Tests Frame and FrameQueue. A FrameQueue passes complete frames from interrupts to the main loop.
#include "firmware/line/frame_queue.hpp"

#include <gtest/gtest.h>

namespace ex9000 {
namespace {

/// Assembles a frame of one byte and queues it. Returns false if another frame is already waiting; the
/// assembled frame is then lost.
bool put(FrameQueue& queue, std::uint8_t byte) {
  Frame& frame = queue.assembling();
  frame.offset = 0;
  frame.size = 1;
  frame.storage[0] = byte;
  return queue.complete_in_interrupt();
}

TEST(FrameQueue, IsEmptyAtFirst) {
  const FrameQueue queue;
  EXPECT_FALSE(queue.has_frame());
}

TEST(FrameQueue, AFrameWaitsUntilItIsDropped) {
  FrameQueue queue;
  ASSERT_TRUE(put(queue, 0x11));
  ASSERT_TRUE(queue.has_frame());
  EXPECT_EQ(queue.waiting().bytes()[0], 0x11);
  queue.drop_in_main_loop();
  EXPECT_FALSE(queue.has_frame());
}

TEST(FrameQueue, TheWaitingFrameDoesNotChangeWhileTheNextOneIsAssembled) {
  FrameQueue queue;
  ASSERT_TRUE(put(queue, 0x11));
  queue.assembling().storage[0] = 0x22;
  EXPECT_EQ(queue.waiting().bytes()[0], 0x11);
}

TEST(FrameQueue, AFrameThatIsBeingAssembledKeepsItsBufferWhenTheWaitingOneIsDropped) {
  FrameQueue queue;
  ASSERT_TRUE(put(queue, 0x11));
  const Frame& open = queue.assembling();
  queue.drop_in_main_loop();
  EXPECT_EQ(&queue.assembling(), &open);
}

TEST(FrameQueue, AFrameThatEndsWhileAnotherWaitsIsLost) {
  FrameQueue queue;
  ASSERT_TRUE(put(queue, 0x11));
  EXPECT_FALSE(put(queue, 0x22));
  EXPECT_FALSE(put(queue, 0x33));
  EXPECT_EQ(queue.waiting().bytes()[0], 0x11);
  queue.drop_in_main_loop();
  EXPECT_FALSE(queue.has_frame());
  ASSERT_TRUE(put(queue, 0x44));
  EXPECT_EQ(queue.waiting().bytes()[0], 0x44);
}

TEST(FrameQueue, HandsOverEveryFrameIfThePreviousOneIsDropped) {
  FrameQueue queue;
  for (unsigned i = 1; i <= 300; ++i) {
    ASSERT_TRUE(put(queue, static_cast<std::uint8_t>(i)));
    EXPECT_EQ(queue.waiting().bytes()[0], static_cast<std::uint8_t>(i));
    queue.drop_in_main_loop();
  }
}

TEST(Frame, ItsBytesDoNotIncludeATurnAroundByte) {
  Frame frame;
  frame.storage[1] = 0x55;
  frame.offset = 1;
  frame.size = 1;
  EXPECT_EQ(frame.bytes().size, 1U);
  EXPECT_EQ(frame.bytes()[0], 0x55);
}

}  // namespace
}  // namespace ex9000
