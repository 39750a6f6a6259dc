#include "sim/utility/scan/scan.hpp"

#include <algorithm>
#include <set>

#include "firmware/model/baud.hpp"
#include "sim/text/values.hpp"
#include "sim/utility/device/fact.hpp"
#include "sim/utility/scan/fast_scan.hpp"

namespace ex9000::utility {

namespace {

/// What cannot be read stays unknown. The first reply may be one of several modules, and the next ones are
/// not.
void read_identity(FoundModule& found, Device device) {
  try {
    found.identity = identify(device);
    const auto last_reset =
        std::find_if(facts.begin(), facts.end(), [](const Fact& fact) { return fact.name == "last reset"; });
    found.last_reset = last_reset->read(device, *kModels);
  } catch (const Failed&) {
    const Heard heard =
        device.speaks_modbus() ? device.line().modbus().heard() : device.line().dcon().heard();
    found.garbled = heard == Heard::Noise;
  }
}

/// In the reply to `$002`: not the address of the request, if the module is in INIT mode.
std::optional<std::uint8_t> stored_address_in(const std::string& reply, std::uint8_t address) {
  constexpr std::size_t kSize = 9;  // !AATTCCFF
  if (address != 0 || reply.size() != kSize || reply[0] != '!' ||
      reply.find_first_not_of("0123456789ABCDEF", 1) != std::string::npos || reply.compare(1, 2, "00") == 0) {
    return std::nullopt;
  }
  return sim::parse_hex_byte(reply.substr(1, 2));
}

class Scan {
 public:
  Scan(MasterLine& line, const Search& search, const std::function<void(const FoundModule&)>& found,
       const std::function<void(std::size_t, std::size_t)>& progress)
      : line_(line), search_(search), found_(found), progress_(progress) {
    for (unsigned address = search.first; address <= search.last; ++address) {
      addresses_.push_back(static_cast<std::uint8_t>(address));
    }
    const std::size_t modbus = search.speaks == Speaks::Ascii ? 0 : search.fast ? 1 : 1 + addresses_.size();
    const std::size_t ascii = search.speaks == Speaks::Modbus || search.fast ? 0 : 2 * addresses_.size();
    of_ = search.modes.size() * (modbus + ascii);
  }

  void run() {
    for (const hal::SerialMode mode : search_.modes) {
      line_.set_mode(mode);
      if (search_.speaks != Speaks::Ascii) {
        modbus();
      }
      if (search_.speaks != Speaks::Modbus && !search_.fast && line_.carries_all()) {
        std::set<std::uint8_t> known;
        ascii(false, known);
        ascii(true, known);
      }
    }
    progress_(of_, of_);
  }

 private:
  void step() { progress_(std::min(done_++, of_), of_); }

  [[nodiscard]] FoundModule module(Speaks speaks, std::uint8_t address) const {
    FoundModule module;
    if (line_.has_modes()) {
      module.mode = line_.mode();
    }
    module.speaks = speaks;
    module.address = address;
    return module;
  }

  void modbus() {
    std::multiset<std::uint8_t> known;
    step();
    if (line_.carries_all()) {
      for (const Scanned& scanned : fast_scan(line_, search_.patience)) {
        FoundModule found = module(Speaks::Modbus, scanned.address);
        read_identity(found, Device::in_modbus(line_, with_serial_number(scanned.serial_number)));
        found.identity.serial_number = scanned.serial_number;
        found.garbled = false;
        known.insert(scanned.address);
        found_(found);
      }
    }
    for (const std::uint8_t address : addresses_) {
      if (search_.fast) {
        break;
      }
      step();
      if (is_modbus_address(address) && known.count(address) < 2) {
        modbus_at(address, known.count(address) == 1);
      }
    }
  }

  /// `known`: one module with this address has been found. Another one shows itself only by bytes that
  /// collide.
  void modbus_at(std::uint8_t address, bool known) {
    const Addressee to = at_address(address);
    const unsigned tries = known ? 3 : 1;  // noise comes once
    bool replies = false;
    for (unsigned i = 0; i < tries && !replies; ++i) {
      replies = !line_.modbus().exchange(to, harmless_request(), search_.patience).empty();
    }
    if (replies ? known : line_.modbus().heard() != Heard::Noise) {
      return;
    }
    FoundModule found = module(Speaks::Modbus, address);
    found.garbled = !replies;
    if (replies) {
      read_identity(found, Device::in_modbus(line_, to));
    }
    found_(found);
  }

  /// `known`: addresses of modules that have replied in this mode.
  void ascii(bool checksum, std::set<std::uint8_t>& known) {
    line_.connection().send({'\r'});  // ends what the bytes of a Modbus request may have begun
    line_.dcon().set_checksum(checksum);
    for (const std::uint8_t address : addresses_) {
      step();
      if (known.count(address) == 0 && ascii_at(address)) {
        known.insert(address);
      }
    }
  }

  bool ascii_at(std::uint8_t address) {
    const auto reply = line_.dcon().ask("$" + sim::hex_byte_text(address) + "2", search_.patience);
    if (!reply && line_.dcon().heard() != Heard::Noise) {
      return false;
    }
    FoundModule found = module(Speaks::Ascii, address);
    found.checksum = line_.dcon().checksum();
    // A module in INIT mode answers at 00 with its own address.
    found.garbled = !reply || (address != 0 && !is_reply_of(reply, address));
    if (reply && !found.garbled) {
      found.stored_address = stored_address_in(*reply, address);
      read_identity(found, Device::in_ascii(line_, address));
    }
    found_(found);
    return reply.has_value();
  }

  MasterLine& line_;
  const Search& search_;
  const std::function<void(const FoundModule&)>& found_;
  const std::function<void(std::size_t, std::size_t)>& progress_;
  std::vector<std::uint8_t> addresses_;
  std::size_t done_ = 0;
  std::size_t of_ = 0;
};

}  // namespace

std::vector<hal::SerialMode> all_modes() {
  constexpr std::uint32_t kFactoryRate = baud_rate(kFactoryBaudCode);
  std::vector<hal::SerialMode> modes;
  for (const LineFormat format : {LineFormat::k8N1, LineFormat::k8E1, LineFormat::k8O1}) {
    modes.push_back({kFactoryRate, format});
    for (auto rate = kBaudRates.rbegin(); rate != kBaudRates.rend(); ++rate) {
      if (*rate != kFactoryRate) {
        modes.push_back({*rate, format});
      }
    }
  }
  return modes;
}

void scan(MasterLine& line, const Search& search, const std::function<void(const FoundModule& module)>& found,
          const std::function<void(std::size_t done, std::size_t of)>& progress) {
  Scan(line, search, found, progress).run();
}

}  // namespace ex9000::utility
