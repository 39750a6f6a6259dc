#include "sim/utility/scan/scan.hpp"

#include <algorithm>
#include <set>

#include "firmware/model/baud.hpp"
#include "sim/text/values.hpp"
#include "sim/utility/device/fact.hpp"
#include "sim/utility/scan/fast_scan.hpp"

namespace ex9000::utility {

namespace {

/// What cannot be read stays unknown.
void read_identity(FoundModule& found, Device device) {
  try {
    found.identity = identify(device);
    const auto last_reset =
        std::find_if(facts.begin(), facts.end(), [](const Fact& fact) { return fact.name == "last reset"; });
    found.last_reset = last_reset->read(device, *kModels);
  } catch (const Failed&) {
    found.garbled = found.identity.model_text.empty() && found.identity.name.empty();
  }
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
    module.mode = line_.mode();
    module.speaks = speaks;
    module.address = address;
    return module;
  }

  void modbus() {
    std::set<std::uint8_t> known;
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
      if (is_modbus_address(address) && known.count(address) == 0) {
        modbus_at(address);
      }
    }
  }

  void modbus_at(std::uint8_t address) {
    const Addressee to = at_address(address);
    const bool replies = !line_.modbus().exchange(to, harmless_request(), search_.patience).empty();
    if (!replies && line_.modbus().heard() != Heard::Noise) {
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
    const std::string digits = sim::hex_byte_text(address);
    const auto reply = line_.dcon().ask("$" + digits + "2", search_.patience);
    if (!reply && line_.dcon().heard() != Heard::Noise) {
      return false;
    }
    FoundModule found = module(Speaks::Ascii, address);
    found.checksum = line_.dcon().checksum();
    found.garbled = !reply;
    if (reply) {
      if (const std::string stored = reply->substr(std::min<std::size_t>(1, reply->size()), 2);
          (*reply)[0] == '!' && stored != digits && stored.size() == 2) {
        found.stored_address = sim::parse_hex_byte(stored);
      }
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
