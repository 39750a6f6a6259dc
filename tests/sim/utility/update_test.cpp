// `ex9000 update` with simulated modules.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <utility>

#include "tests/firmware/update/messages.hpp"
#include "tests/sim/utility/plant.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::utility {
namespace {

using update::Buffer;

constexpr std::uint16_t kVersion = 0x0123;
const std::string kRuns = "runs D01.23, which it confirms after 60 s\n";

/// Whether a frame to address 5 has this function at this register.
bool is(const Data& frame, std::uint8_t function, unsigned address) {
  return frame[1] == function && Bytes{frame.data(), frame.size()}.word(2) == address;
}
bool is_block(const Data& frame, std::uint32_t offset) {
  return is(frame, 0x10, 0x2000) && Bytes{frame.data(), frame.size()}.double_word(7) == offset;
}

class Update : public testing::Test {
 protected:
  /// 79 blocks, the last one in part.
  const Buffer image_ = update::image_of(10'000);

  Buffer file() const {
    Buffer content = update::info_of(image_, kVersion, update::kActivateWhenComplete);
    for (std::uint32_t offset = 0; offset < image_.size(); offset += update::kBlockSize) {
      const Buffer block = update::block_of(image_, offset);
      content.insert(content.end(), block.begin(), block.end());
    }
    return content;
  }
  std::string write(const Buffer& content) const {
    const std::string path = directory_.path() + "/update.ex9fw";
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(content.data()), static_cast<std::streamsize>(content.size()));
    return path;
  }
  /// Of the module at address 5, unless there are `more` words.
  int update(Plant& plant, const std::string& modules = "5", const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"update", "port", modules, write(file())};
    words.insert(words.end(), more.begin(), more.end());
    return plant.run(words);
  }
  void succeeds(Plant& plant) {
    EXPECT_EQ(update(plant), 0) << plant.error();
    EXPECT_EQ(plant.output(), "5: " + kRuns);
  }
  void fails(Plant& plant, const std::string& result) {
    EXPECT_EQ(update(plant), 1) << plant.error();
    EXPECT_NE(plant.output().find("5: FAILED: " + result), std::string::npos)
        << plant.output() << plant.error();
  }
  static std::vector<std::uint32_t> blocks(const Plant& plant) {
    std::vector<std::uint32_t> offsets;
    for (const Data& frame : plant.sent) {
      if (is(frame, 0x10, 0x2000)) {
        offsets.push_back(Bytes{frame.data(), frame.size()}.double_word(7) / update::kBlockSize);
      }
    }
    return offsets;
  }
  static long count(const Plant& plant, std::uint8_t function, unsigned address) {
    return std::count_if(plant.sent.begin(), plant.sent.end(),
                         [&](const Data& frame) { return is(frame, function, address); });
  }

  system::Directory directory_;
};

TEST_F(Update, AModuleGetsTheBlocksOfTheFileAndStartsTheImage) {
  Plant plant({"EX9042D-M@05"});
  succeeds(plant);
  const std::vector<std::uint32_t> sent = blocks(plant);
  ASSERT_EQ(sent.size(), 79U);
  EXPECT_EQ(sent.back(), 78U);
  EXPECT_EQ(count(plant, 0x10, 0x1000), 1);
  EXPECT_NE(plant.error().find("5: 51 %\n"), std::string::npos) << plant.error();
}

TEST_F(Update, WaitsUntilTheModuleHasConfirmedTheImage) {
  Plant plant({"EX9042D-M@05"});
  EXPECT_EQ(update(plant, "5", {"--wait"}), 0);
  EXPECT_EQ(plant.output(), "5: runs D01.23, confirmed\n");
  plant.act("1 reset");
  succeeds(plant);
  EXPECT_EQ(count(plant, 0x06, 0x1013), 1) << "the image that it runs is a new one again";
}

TEST_F(Update, AModuleIsReachedByItsSerialNumber) {
  Plant plant({"EX9042D-M@05,serial=1F3A", "EX9042D-M@05,serial=0001"});
  EXPECT_EQ(update(plant, "0D001F3A"), 0);
  EXPECT_EQ(plant.output(), "0D001F3A: " + kRuns);
  for (const Data& frame : plant.sent) {
    EXPECT_EQ(Data(frame.begin(), frame.begin() + 7), (Data{0xFD, 0x46, 0x08, 0x0D, 0x00, 0x1F, 0x3A}));
  }
}

TEST_F(Update, AnInterruptedTransferContinues) {
  Plant plant({"EX9042D-M@05"});
  plant.sends = [](const Data& frame) {
    return is_block(frame, 40 * update::kBlockSize) ? throw Interrupted() : true;
  };
  EXPECT_EQ(update(plant), 130);
  EXPECT_NE(
      plant.error().find("stopped: the modules keep what they have received; the same command continues\n"),
      std::string::npos)
      << plant.error();
  plant.sends = [](const Data& /*frame*/) { return true; };
  succeeds(plant);
  EXPECT_EQ(blocks(plant).front(), 40U);
}

TEST_F(Update, AModuleThatLosesItsPowerContinuesAtTheBeginningOfASector) {
  Plant plant({"EX9042D-M@05"});
  plant.sends = [&](const Data& frame) {
    if (is_block(frame, 40 * update::kBlockSize)) {
      plant.act("1 power off");
    }
    return true;
  };
  fails(plant, "gives no reply; check address, rate, format, protocol (Modbus) and wires");
  plant.sends = [](const Data& /*frame*/) { return true; };
  plant.act("1 power on");
  succeeds(plant);
  EXPECT_EQ(blocks(plant).front(), 32U);
}

TEST_F(Update, AModuleThatWasResetGetsTheBeginAgain) {
  Plant plant({"EX9042D-M@05"});
  bool was_reset = false;
  plant.sends = [&](const Data& frame) {
    if (is_block(frame, 40 * update::kBlockSize) && !std::exchange(was_reset, true)) {
      plant.act("1 reset");
      return false;
    }
    return true;
  };
  succeeds(plant);
  EXPECT_EQ(count(plant, 0x10, 0x1000), 2);
}

/// Of the first requests of each kind, three or four are lost, or the replies to them.
TEST_F(Update, EachRequestIsRepeatedThreeTimes) {
  const std::pair<std::uint8_t, unsigned> kRequests[] = {{0x03, 0x0122}, {0x10, 0x1000}, {0x10, 0x2000}};
  for (const auto& [function, address] : kRequests) {
    for (const bool request_too : {false, true}) {
      for (const unsigned lost : {3U, 4U}) {
        SCOPED_TRACE(testing::Message() << address << " " << request_too << " " << lost);
        Plant plant({"EX9042D-M@05"});
        unsigned left = lost;
        plant.sends = [&, function = function, address = address](const Data& frame) {
          plant.act("fault off all");
          if (!is(frame, function, address) || left == 0) {
            return true;
          }
          --left;
          plant.act("1 fault lost-reply every reply");
          return !request_too;
        };
        if (lost == 3) {
          succeeds(plant);
        } else {
          fails(plant, "gives no reply; check");
        }
      }
    }
  }
}

TEST_F(Update, AnActivationSurvivesALostRequestAndALostReply) {
  for (const bool request_too : {false, true}) {
    Plant plant({"EX9042D-M@05"});
    bool lost = false;
    plant.sends = [&](const Data& frame) {
      if (!is(frame, 0x06, 0x1013) || std::exchange(lost, true)) {
        return true;
      }
      plant.act("1 fault lost-reply for 10ms");
      return !request_too;
    };
    succeeds(plant);
    EXPECT_EQ(count(plant, 0x06, 0x1013), request_too ? 2 : 1);
  }
}

TEST_F(Update, NoiseAndEchoAreSkipped) {
  for (const char* fault : {"fault inserted-bytes 0.001", "fault bit-errors 0.0001"}) {
    SCOPED_TRACE(fault);
    Plant plant({"EX9042D-M@05"});
    plant.echoes = true;
    plant.act(fault);
    succeeds(plant);
  }
}

TEST_F(Update, RefusalsAreReported) {
  struct Row {
    std::uint8_t function;
    unsigned address;
    const char* exception;
    const char* result;
  };
  constexpr Row kRows[] = {
      {0x10, 0x1000, "04", "refuses the update: exception 04 (server device failure)"},
      {0x10, 0x2000, "01",
       "refuses the block at 0: exception 01 (illegal function), in the state 1 (receiving)"},
      {0x10, 0x2000, "03", "refuses its blocks; restart it, and start again"},
      {0x10, 0x2000, "04", "refuses the block at 0: exception 04 (server device failure), in the state 1"},
      {0x10, 0x2000, "06", "refuses the block at 0: exception 06 (server device busy), in the state 1"},
      {0x06, 0x1013, "01", "refuses to activate the image: exception 01 (illegal function); start again"},
      {0x03, 0x1010, "02",
       "refuses to read the registers of updates: exception 02 (illegal data address); its"},
  };
  for (const Row& row : kRows) {
    SCOPED_TRACE(row.result);
    Plant plant({"EX9042D-M@05"});
    plant.sends = [&](const Data& frame) {
      plant.act("fault off all");
      if (is(frame, row.function, row.address)) {
        plant.act("1 fault exception " + std::string(row.exception) + " every reply");
      }
      return true;
    };
    fails(plant, row.result);
  }
}

TEST_F(Update, AFileForAnotherModuleIsRefusedBeforeAnythingIsSent) {
  Plant plant({"EX9043D-M@05"});
  fails(plant, "has the signature '9043DM.pico'; the file is for '9042DM.pico'");
  EXPECT_EQ(count(plant, 0x10, 0x1000), 0);
}

TEST_F(Update, AModuleThatPermitsNoUpdatesIsRefused) {
  Plant plant({"EX9042D-M@05"});
  plant.act("1 init on");  // permits to change register 0x0254
  EXPECT_EQ(plant.run({"send", "port", "05 06 0254 0000"}), 0) << plant.error();
  plant.act("1 init off");
  fails(plant, "permits no updates; write 1 to register 0x0254 while INIT* is active");
}

TEST_F(Update, AnImageOnTrialIsLeftAlone) {
  Plant plant({"EX9042D-M@05"});
  succeeds(plant);
  fails(plant, "still tries an image; start again in a minute, when it has confirmed that one");
}

TEST_F(Update, AnImageThatIsTakenBackIsReported) {
  Plant plant({"EX9042D-M@05,fault=bad-image"});
  fails(plant, "has taken the image back and runs D01.00: it did not prove itself");
}

TEST_F(Update, AnImageThatIsTakenBackWhileItIsOnTrialIsReported) {
  Plant plant({"EX9042D-M@05"});
  unsigned reads = 0;
  plant.sends = [&](const Data& frame) {
    reads += is(frame, 0x03, 0x0300) ? 1 : 0;
    if (reads == 1 && is(frame, 0x03, 0x1010)) {
      plant.act("1 reset");
      ++reads;
    }
    return true;
  };
  EXPECT_EQ(update(plant, "5", {"--wait"}), 1);
  EXPECT_EQ(plant.output(), "5: FAILED: has taken the image back and runs D01.00: it did not prove itself\n");
}

TEST_F(Update, AModuleThatDoesNotComeBackIsReported) {
  Plant plant({"EX9042D-M@05"});
  bool activated = false;
  plant.sends = [&](const Data& frame) {
    if (activated) {
      plant.act("1 power off");
    }
    activated = activated || is(frame, 0x06, 0x1013);
    return true;
  };
  fails(plant, "gives no reply any more; start again when it answers");
}

TEST_F(Update, SeveralModulesActivateTogetherWhenAllHaveTheImage) {
  Plant plant({"EX9042D-M@05", "EX9042D-M@06", "EX9042D-M@07,serial=1F3A"});
  EXPECT_EQ(update(plant, "5-6,0D001F3A", {"--wait"}), 0) << plant.error();
  EXPECT_EQ(plant.output(),
            "5: runs D01.23, confirmed\n6: runs D01.23, confirmed\n0D001F3A: runs D01.23, confirmed\n");
}

TEST_F(Update, NothingIsSentIfOneModuleCannotGetTheImage) {
  Plant plant({"EX9042D-M@05", "EX9043D-M@06"});
  EXPECT_EQ(update(plant, "5,6"), 1);
  EXPECT_EQ(plant.output().find("5: not updated, because another module has failed: nothing has been sent\n"
                                "6: FAILED: has the signature"),
            0U)
      << plant.output();
  EXPECT_EQ(count(plant, 0x10, 0x1000), 0);
}

TEST_F(Update, NoModuleActivatesIfOneHasNotReceivedAll) {
  Plant plant({"EX9042D-M@05", "EX9042D-M@06"});
  plant.sends = [&](const Data& frame) { return frame[0] != 6 || !is_block(frame, 1280); };
  EXPECT_EQ(update(plant, "5,6"), 1);
  EXPECT_EQ(plant.output().find("5: not updated, because another module has failed: the modules keep"), 0U)
      << plant.output();
  EXPECT_EQ(count(plant, 0x06, 0x1013), 0);
  plant.sends = [](const Data& /*frame*/) { return true; };
  EXPECT_EQ(update(plant, "5,6"), 0);
  EXPECT_EQ(plant.output(), "5: " + kRuns + "6: " + kRuns);
}

TEST_F(Update, TheResultOfEachModuleIsReported) {
  Plant plant({"EX9042D-M@05,fault=bad-image", "EX9042D-M@06"});
  EXPECT_EQ(update(plant, "5,6"), 1);
  EXPECT_EQ(plant.output().find("5: FAILED: has taken"), 0U) << plant.output();
  EXPECT_NE(plant.output().find("\n6: " + kRuns), std::string::npos) << plant.output();
}

TEST_F(Update, WrongArgumentsAreRefused) {
  const std::pair<std::vector<std::string>, const char*> kRows[] = {
      {{"5"}, "expected ex9000 update PORT MODULES FILE"},
      {{"port", "0", "FILE"}, "'0': expected an address from 1 to 247, or a serial number of 8 hex digits"},
      {{"port", "248", "FILE"}, "'248': expected an address"},
      {{"port", "0D00", "FILE"}, "'0D00': expected an address"},
      {{"port", "5,5", "FILE"}, "'5' is there twice; name each module once"},
      {{"port", "4-6,5", "FILE"}, "'5' is there twice; name each module once"},
      {{"tcp:host", "5", "FILE"}, "'tcp:host': expected tcp:HOST:PORT or modbus-tcp:HOST[:PORT]"},
      {{"modbus-tcp:host:x", "5", "FILE"}, "'modbus-tcp:host:x': expected tcp:HOST:PORT or"},
      {{"port", "5", "FILE", "--baud", "300"}, "--baud: '300': expected"},
      {{"port", "5", "/missing"}, "/missing: No such file or directory; name a file that you can read"},
      {{"modbus-tcp:host", "0D001F3A", "FILE"},
       "0D001F3A: Modbus TCP carries no request by serial number; name"},
  };
  const std::string path = write(file());
  for (auto [words, problem] : kRows) {
    SCOPED_TRACE(problem);
    Plant plant({"EX9042D-M@05"});
    std::replace(words.begin(), words.end(), std::string("FILE"), path);
    words.insert(words.begin(), "update");
    EXPECT_NE(plant.run(words), 0);
    EXPECT_EQ(plant.error().find("ex9000: " + std::string(problem)), 0U) << plant.error();
    EXPECT_EQ(plant.error().find('\n'), plant.error().size() - 1);
    EXPECT_TRUE(plant.sent.empty());
  }
}

TEST_F(Update, ADamagedFileIsRefused) {
  const Buffer good = file();
  const auto changed = [&](std::size_t at) {
    Buffer content = good;
    content[at] ^= 1U;
    return content;
  };
  const std::pair<Buffer, const char*> kRows[] = {
      {{}, "has 0 bytes, not 32 and 136 for each block; build or copy it again"},
      {{good.begin(), good.end() - 1}, "has 10775 bytes, not 32 and 136 for each block"},
      {{good.begin(), good.end() - 136}, "has another length or CRC of the image than it says"},
      {changed(6), "has no signature like 9042DM.pico"},
      {changed(12), "gives the image 16787216 bytes, not 1 to 126976"},
      {changed(15), "has another length or CRC of the image than it says"},
      {changed(20), "has another length or CRC of the image than it says"},
      {changed(32 + 136), "has a damaged block at 128"},
      {changed(32 + 7), "has a damaged block at 0"},
      {changed(32 + 135), "has a damaged block at 0"},
  };
  for (const auto& [content, problem] : kRows) {
    SCOPED_TRACE(problem);
    Plant plant({"EX9042D-M@05"});
    const std::string path = write(content);
    EXPECT_EQ(plant.run({"update", "port", "5", path}), 2);
    EXPECT_EQ(plant.error().find("ex9000: " + path + ": " + problem), 0U) << plant.error();
  }
}

}  // namespace
}  // namespace ex9000::utility
