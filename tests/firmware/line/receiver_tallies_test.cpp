// Tests what the receiver counts for Modbus function 08 (wire.md D1) and for the line tallies
// (firmware/extensions.md).
#include "tests/firmware/line/receiver_bench.hpp"

namespace ex9000 {
namespace {

TEST_F(ReceiverTest, CountsNothingBeforeAnythingIsReceived) {
  listen(Protocol::ModbusRtu);
  EXPECT_EQ(counts(), (Counts{0, 0, 0, 0, 0}));
}

TEST_F(ReceiverTest, AFrameForThisModuleIsABusMessageAndAServerMessage) {
  listen(Protocol::ModbusRtu);
  frame(kChannel0On);
  EXPECT_EQ(counts(), (Counts{1, 0, 1, 0, 0}));
}

TEST_F(ReceiverTest, AFrameForAnotherModuleIsOnlyABusMessage) {
  listen(Protocol::ModbusRtu);
  frame(kGuideExample);
  EXPECT_EQ(counts(), (Counts{1, 0, 0, 0, 0}));
}

TEST_F(ReceiverTest, AHostOkIsAServerMessageWithoutAReply) {
  listen(Protocol::ModbusRtu);
  frame(kHostOk);
  EXPECT_EQ(counts(), (Counts{1, 0, 1, 1, 0}));
}

TEST_F(ReceiverTest, AWrongCrcIsABusError) {
  listen(Protocol::ModbusRtu);
  frame({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3B});
  EXPECT_EQ(counts(), (Counts{0, 1, 0, 0, 0}));
}

TEST_F(ReceiverTest, AFrameOfLessThan4BytesIsABusError) {
  listen(Protocol::ModbusRtu);
  frame({0x01});
  frame({0x01, 0x05, 0x00});
  EXPECT_EQ(counts(), (Counts{0, 2, 0, 0, 0}));
}

TEST_F(ReceiverTest, AFrameOfMoreThan256BytesIsOneBusError) {
  listen(Protocol::ModbusRtu);
  frame(FrameBytes(257, 0x55));
  frame(FrameBytes(600, 0x55));
  EXPECT_EQ(counts(), (Counts{0, 2, 0, 0, 0}));
}

TEST_F(ReceiverTest, AFrameWithFramingErrorsOrBreaksIsOneBusError) {
  listen(Protocol::ModbusRtu);
  for (const ByteStatus status : {ByteStatus::FramingError, ByteStatus::Break}) {
    byte(0x01);
    byte(0x05, status);
    byte(0x00, status);
    frame({0x00, 0xFF, 0x00, 0x8C, 0x3A});
    EXPECT_EQ(counts(), (Counts{0, 1, 0, 0, 0}));
  }
}

TEST_F(ReceiverTest, AFrameThatIsLostBecauseOfAnOverrunIsABusErrorAndAnOverrun) {
  listen(Protocol::ModbusRtu);
  byte(0x01);
  byte(0x05, ByteStatus::Overrun);
  byte(0x00, ByteStatus::Overrun);
  frame({0x00, 0xFF, 0x00, 0x8C, 0x3A});
  EXPECT_EQ(counts(), (Counts{0, 1, 0, 0, 1}));
}

TEST_F(ReceiverTest, AFrameThatArrivesWhileTheQueueIsFullIsCountedAsAnOverrun) {
  listen(Protocol::ModbusRtu);
  frame(kChannel0On);
  counts();
  frame(kChannel0On);
  const Counts counted = counts();
  EXPECT_EQ(counted.bus_messages, 1U);
  EXPECT_EQ(counted.bus_errors, 0U);
  EXPECT_EQ(counted.overruns, 1U);
}

TEST_F(ReceiverTest, CountsEveryFrameOnce) {
  listen(Protocol::ModbusRtu);
  for (int i = 0; i < 300; ++i) {
    frame(kChannel0On);
    EXPECT_TRUE(took_frame());
    frame(kGuideExample);
    frame({0xFF});
  }
  EXPECT_EQ(counts(), (Counts{600, 300, 300, 0, 0}));
}

TEST_F(ReceiverTest, AnOpenFrameIsNotCounted) {
  listen(Protocol::ModbusRtu);
  bytes(kChannel0On);
  EXPECT_EQ(counts(), (Counts{0, 0, 0, 0, 0}));
}

TEST_F(ReceiverTest, InBothProtocolsAFramingErrorOrABreakDamagesAByteButAnOverrunDoesNot) {
  for (const Protocol protocol : {Protocol::Ascii, Protocol::ModbusRtu}) {
    listen(protocol);
    receiver_.tallies().clear();
    byte('$', ByteStatus::FramingError);
    byte('$', ByteStatus::Break);
    byte('$', ByteStatus::Overrun);
    byte('$');
    silence();
    EXPECT_EQ(receiver_.tallies().damaged_bytes(), 2U);
    receiver_.tallies().clear();
    EXPECT_EQ(receiver_.tallies().damaged_bytes(), 0U);
  }
}

TEST_F(ReceiverTest, AFrameThatIsLostBecauseTheQueueIsFullIsCountedOnce) {
  listen(Protocol::Ascii);
  text("$01M\r$01F\r");
  EXPECT_EQ(receiver_.tallies().lost_frames(), 1U);
}

TEST_F(ReceiverTest, InAsciiEachCompleteFrameIsABusMessageOrABusError) {
  listen(Protocol::Ascii, true);
  text("$01MD2\r");  // correct checksum
  EXPECT_EQ(counts(), (Counts{1, 0, 1, 0, 0}));
  text("$02MD3\r");  // for another module
  EXPECT_EQ(counts(), (Counts{1, 0, 0, 0, 0}));
  // A host OK, a broadcast `#**` that is lost because the queue is full, and a broadcast that is not a
  // command.
  text("~**D2\r#**77\r$**78\r");
  EXPECT_EQ(counts(), (Counts{3, 0, 2, 2, 1}));
  text("$01MD3\r$0\r$01M78901234567890123456789012345\r");  // wrong checksum; no checksum; too long
  EXPECT_EQ(counts(), (Counts{0, 3, 0, 0, 0}));
  byte('$');
  byte('0', ByteStatus::Overrun);
  text("1M\r");
  EXPECT_EQ(counts(), (Counts{0, 1, 0, 0, 1}));
}

}  // namespace
}  // namespace ex9000
