#include "sim/utility/device/find.hpp"

#include <algorithm>
#include <initializer_list>

#include "firmware/model/baud.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::utility {

namespace {

constexpr std::chrono::milliseconds kPatience{200};
constexpr std::size_t kSerialNumberDigits = 8;

bool is_serial_number(const std::string& text) {
  return text.size() == kSerialNumberDigits &&
         text.find_first_not_of("0123456789ABCDEFabcdef") == std::string::npos;
}

bool replies_in_modbus(MasterLine& line, const Addressee& to, Time patience) {
  constexpr unsigned kTries = 2;
  const Time began = line.connection().now();
  for (unsigned i = 0; i < kTries; ++i) {
    if (!line.modbus().exchange(to, harmless_request(), patience).empty()) {
      if (i != 0) {
        line.connection().drop_late_replies(began);
      }
      return true;
    }
  }
  return false;
}

std::string harmless_command(std::uint8_t address) { return "$" + sim::hex_byte_text(address) + "M"; }

bool replies_in_ascii(MasterLine& line, std::uint8_t address, std::initializer_list<bool> checksums,
                      Time patience) {
  line.connection().send({'\r'});  // ends what the bytes of a Modbus request may have begun
  const Time began = line.connection().now();
  bool repeated = false;
  for (const bool checksum : checksums) {
    line.dcon().set_checksum(checksum);
    if (is_reply_of(line.dcon().ask(harmless_command(address), patience), address)) {
      if (repeated) {
        line.connection().drop_late_replies(began);
      }
      return true;
    }
    repeated = true;
  }
  return false;
}

bool replies_in_any_ascii(MasterLine& line, std::uint8_t address, Time patience) {
  const bool first = line.dcon().checksum();
  return replies_in_ascii(line, address, {first, !first, first, !first}, patience);
}

/// What the line has shown, and what to look at.
std::string advice(Heard heard) {
  switch (heard) {
    case Heard::Noise:
      return ", but bytes that are none: several modules with this address, noise, or A and B swapped; try "
             "'ex9000 scan'";
    case Heard::Echo:
      return ", only the echo of the request: the adapter works; check the supply, the wires behind it, and "
             "the address";
    case Heard::Nothing:
      break;
  }
  return ", nor anything else; check the supply, the wires A and B, and the address, or look for it with "
         "'ex9000 scan'";
}

/// What else may be: the evidence is a reply in another mode.
std::string other_mode(MasterLine& line, const Addressee& to, std::uint8_t address, Speaks speaks,
                       Time patience) {
  if (!line.has_modes()) {
    return "";
  }
  const hal::SerialMode given = line.mode();
  std::string found;
  for (const LineFormat format : {LineFormat::k8N1, LineFormat::k8E1, LineFormat::k8O1}) {
    if (format != LineFormat::k8N1 && !line.connection().has_formats()) {
      break;
    }
    for (auto rate = kBaudRates.rbegin(); rate != kBaudRates.rend() && found.empty(); ++rate) {
      const hal::SerialMode mode{*rate, format};
      if (mode == given) {
        continue;
      }
      line.set_mode(mode);
      if ((speaks != Speaks::Ascii && to.request[0] != 0 && replies_in_modbus(line, to, patience)) ||
          (speaks != Speaks::Modbus && to.by_address() && replies_in_any_ascii(line, address, patience))) {
        found = sim::mode_text(*rate, format);
      }
    }
  }
  line.set_mode(given);
  return found;
}

}  // namespace

sim::Words expand_modules(const sim::Words& texts) {
  sim::Words modules;
  for (const std::string& text : sim::parts_of(sim::joined(texts, ","), ',')) {
    const std::size_t dash = text.find('-');
    if (is_serial_number(text)) {
      modules.push_back(parse_addressee(text).name);
      continue;
    }
    const unsigned first = parse_address(text.substr(0, dash));
    const unsigned last = dash == std::string::npos ? first : parse_address(text.substr(dash + 1));
    if (first > last) {
      sim::fail("'" + text + "': expected FIRST-LAST, as 1-32");
    }
    for (unsigned address = first; address <= last; ++address) {
      modules.push_back(std::to_string(address));
    }
  }
  for (const std::string& module : modules) {
    if (std::count(modules.begin(), modules.end(), module) > 1) {
      sim::fail("'" + module + "' is there twice; name each module once");
    }
  }
  return modules;
}

bool is_reply_of(const std::optional<std::string>& reply, std::uint8_t address) {
  return reply && reply->compare(1, 2, sim::hex_byte_text(address)) == 0;
}

bool Device::replies() {
  const Time patience = patience_.value_or(kPatience);
  return speaks_modbus() ? replies_in_modbus(*line_, module_->addressee(), patience)
                         : replies_in_ascii(*line_, address_, {checksum_, checksum_}, patience);
}

bool is_free(MasterLine& line, std::uint8_t address) {
  constexpr unsigned kTries = 3;
  const bool checksum = line.dcon().checksum();
  bool free = true;
  for (unsigned i = 0; i < kTries && free; ++i) {
    if (is_modbus_address(address)) {
      free = line.modbus().exchange(at_address(address), harmless_request(), kPatience).empty() &&
             line.modbus().heard() != Heard::Noise;
    }
    if (free && line.carries_all()) {
      line.connection().send({'\r'});
      line.dcon().set_checksum(i % 2 != 0);
      free = !line.dcon().ask(harmless_command(address), kPatience) && line.dcon().heard() != Heard::Noise;
    }
  }
  line.dcon().set_checksum(checksum);
  return free;
}

const Request& harmless_request() {
  static const Request request{{0x46, 0x00}, {0x46, 0x00}, 6};
  return request;
}

std::uint8_t parse_address(const std::string& text) {
  constexpr unsigned kMost = 255;
  if (text.size() > 2 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) {
    return sim::parse_hex_byte(text.substr(2));
  }
  const auto address = sim::whole_number(text, kMost);
  if (!address) {
    sim::fail("'" + text +
              "': expected an address, 0 to 255 or 0x00 to 0xFF, or a serial number of 8 hex digits");
  }
  return static_cast<std::uint8_t>(*address);
}

Device find_device(Environment& environment, MasterLine& line, const std::string& text, Speaks speaks,
                   Time patience) {
  const bool by_number = is_serial_number(text);
  const std::uint8_t address = by_number ? 0 : parse_address(text);
  const Addressee to = by_number ? parse_addressee(text) : at_address(address);
  if (by_number && !line.carries_all()) {
    sim::fail(text + ": Modbus TCP carries no request by serial number; name an address, or another port");
  }
  if (by_number && speaks == Speaks::Ascii) {
    sim::fail(text + ": a request by serial number is one of Modbus; name an address, or leave out --ascii");
  }
  if (!line.carries_all() && speaks == Speaks::Ascii) {
    sim::fail("--ascii: Modbus TCP carries no DCON; name another port");
  }
  const bool may_be_modbus = speaks != Speaks::Ascii && (by_number || address != 0);
  if (may_be_modbus && replies_in_modbus(line, to, patience)) {
    return Device::in_modbus(line, to);
  }
  const Heard asked_in_modbus = may_be_modbus ? line.modbus().heard() : Heard::Nothing;
  const bool may_be_ascii = speaks != Speaks::Modbus && !by_number && line.carries_all();
  if (may_be_ascii && replies_in_any_ascii(line, address, patience)) {
    return Device::in_ascii(line, address);
  }
  const Heard heard = may_be_ascii ? std::max(asked_in_modbus, line.dcon().heard()) : asked_in_modbus;
  const std::string mode = sim::mode_text(line.mode().baud, line.mode().format);
  if (line.has_modes()) {
    environment.error << text << ": no reply at " << mode << "; trying all other modes, for half a minute"
                      << std::endl;
  }
  const std::string other = other_mode(line, to, address, speaks, patience);
  throw Failed(text + ": no reply at " + mode +
               (!other.empty() ? ", but one at " + other + "; set --baud and --format" : advice(heard)));
}

}  // namespace ex9000::utility
