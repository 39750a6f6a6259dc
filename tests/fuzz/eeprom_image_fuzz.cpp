// Starts a module with arbitrary EEPROM content. The module must start, and must then store settings and load
// them after a reset.
//
// Byte 0 of the input selects the model. The bits of byte 1 have these meanings:
//
//     bit 2      INIT* is connected to GND
//     bit 3      the memory does not acknowledge until the module has started
//     bit 4, 5   the target corrects the layout, the length and the check of the first (bit 4) or the second
//                (bit 5) copy
//
// The following bytes are the content of the memory from address 0. Memory after these bytes is erased.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/virtual_line/line/line.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/oracles/reference/dcon_check.hpp"
#include "tests/support/stored_settings.hpp"

namespace ex9000::fuzz {
namespace {

constexpr std::size_t kHeader = 2;

/// The expected state of the module after its start.
struct Expected {
  Settings settings;
  bool unreadable = false;
};

Expected expected_of(const Model& model, const std::uint8_t* memory, bool answers) {
  if (!answers || place_that_counts(model, memory) == kStoredMemory) {
    const bool blank = std::all_of(kStoredPlaces.begin(), kStoredPlaces.end(), [&](std::size_t place) {
      return StoredCopy(model, memory, place).is_blank();
    });
    return {Settings::factory(model), !answers || !blank};
  }
  return {settings_from(model, memory), false};
}

class Trial {
 public:
  Trial(const Model& model, std::uint8_t flags, const std::uint8_t* contents, std::size_t size)
      : model_(model),
        line_({sim::factory_fresh(model)}, sim::kPaced,
              [this](std::uint8_t byte, ByteStatus) { heard_.push_back(byte); }),
        module_(line_.module(0)) {
    std::vector<std::uint8_t>& memory = module_.memory().contents();
    std::copy_n(contents, std::min(size, memory.size()), memory.begin());
    constexpr std::array<std::uint8_t, kStoredPlaces.size()> kSealed{0x10, 0x20};
    for (std::size_t place = 0; place < kStoredPlaces.size(); ++place) {
      if ((flags & kSealed[place]) != 0) {
        StoredCopy::seal(model, memory.data(), kStoredPlaces[place]);
      }
    }
    module_.set_init((flags & 4U) != 0);
    fails_ = (flags & 8U) != 0;
    module_.memory().fail(fails_);
  }

  void run() {
    const Expected expected = expected_of(model_, module_.memory().contents().data(), !fails_);
    come_up_with(expected.settings);
    require(module_.module().settings_unreadable() == expected.unreadable,
            "unreadable settings are distinguished from an erased memory");
    module_.memory().fail(false);
    tells(expected.settings);
    store_something();
    wait_for_leftovers();
    const Settings before = state().settings;
    come_up_with(before);
    tells(before);
  }

 private:
  [[nodiscard]] const State& state() const { return module_.module().state(); }

  void wait(std::chrono::milliseconds time) { line_.wires().run_until(line_.clock().virtual_now() + time); }

  /// Waits until no store is pending. The host watchdog can expire at any time, and the module then stores
  /// that the watchdog is disabled and that the timeout status is set. If the settings change during the
  /// wait, waits again.
  void wait_for_leftovers() {
    Settings before;
    do {
      before = state().settings;
      wait(std::chrono::milliseconds(1500));
    } while (state().settings != before);
  }

  void come_up_with(const Settings& settings) {
    module_.power(false);
    module_.power(true);
    const auto starts = line_.clock().virtual_now();
    while (!module_.module().listening()) {  // wire.md D13
      require(line_.clock().virtual_now() < starts + std::chrono::milliseconds(100),
              "a module listens within 100 ms of a reset");
      wait(std::chrono::milliseconds(1));
    }
    const bool init = module_.init_asserted();
    const InForce& in_force = state().in_force;
    require(state().settings == settings,
            "the module uses the newest valid copy, or else the factory settings");
    require(state().outputs == (settings.timeout_status ? settings.safe_value : settings.power_on_value),
            "outputs start with the power-on value, or with the safe value after a timeout");
    require(in_force.init_mode == init && in_force.address == (init ? 0 : settings.address) &&
                in_force.baud_code == (init ? 0x06 : settings.baud_code) &&
                in_force.protocol == (init ? Protocol::Ascii : settings.protocol) &&
                in_force.checksum == (!init && (settings.format & 0x40U) != 0),
            "the stored settings or, in INIT mode, the settings of INIT mode are in force");
  }

  [[nodiscard]] bool speaks_modbus() const { return state().in_force.protocol == Protocol::ModbusRtu; }

  /// Sends the request with its check, and returns the reply without it.
  std::vector<std::uint8_t> ask(std::vector<std::uint8_t> request) {
    heard_.clear();
    line_.master().set_mode(module_.mode());
    request = with_crc(std::move(request));
    line_.master().send(request.data(), request.size());
    wait(std::chrono::milliseconds(400));
    require(heard_.size() > 4, "the module replies");
    return {heard_.begin(), heard_.end() - 2};
  }
  std::string ask(const std::string& delimiter, const std::string& body) {
    heard_.clear();
    line_.master().set_mode(module_.mode());
    std::string text = delimiter + reference::hex(state().in_force.address, 2) + body;
    const std::size_t check = state().in_force.checksum ? 2 : 0;
    text += (check != 0 ? reference::check_of(text) : "") + "\r";
    line_.master().send(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    wait(std::chrono::milliseconds(800));
    require(heard_.size() >= 4 + check, "the module replies");
    return {heard_.begin(), heard_.end() - 1 - static_cast<std::ptrdiff_t>(check)};
  }

  void tells(const Settings& settings) {
    if (speaks_modbus()) {
      const auto reply = ask({settings.address, 0x03, 0x01, 0xE4, 0x00, 0x02});
      require(reply.size() == 7 && reply[4] == settings.address && reply[6] == settings.baud_code,
              "the module returns the stored address and baud rate");
      return;
    }
    require(ask("$", "2") == "!" + reference::hex(settings.address, 2) + "40" +
                                 reference::hex(settings.baud_code, 2) + reference::hex(settings.format, 2),
            "the module returns the stored configuration");
    const Bytes name = settings.name.bytes();
    require(ask("$", "M").substr(3) == std::string(name.data, name.data + name.size),
            "the module returns the stored name");
  }

  void store_something() {
    if (speaks_modbus()) {
      const auto next = static_cast<std::uint8_t>(state().settings.address % 247 + 1);
      const std::uint8_t own = state().in_force.address;
      require(ask({own, 0x06, 0x01, 0xE4, 0x00, next}).size() == 6 && state().settings.address == next,
              "an address is stored");
      return;
    }
    const bool is_pump = state().settings.name == Name(std::string_view("pump"));
    const std::string name = is_pump ? "fan" : "pump";
    require(ask("~", "O" + name).size() == 3 && state().settings.name == Name(std::string_view(name)),
            "a name is stored");
  }

  const Model& model_;
  std::vector<std::uint8_t> heard_;
  sim::Line line_;
  sim::SimulatedModule& module_;
  bool fails_ = false;
};

}  // namespace
}  // namespace ex9000::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ex9000::fuzz;
  if (size >= kHeader) {
    const ex9000::Model& model = ex9000::kModels[data[0] % std::size(ex9000::kModels)];
    Trial(model, data[1], data + kHeader, size - kHeader).run();
  }
  return 0;
}
