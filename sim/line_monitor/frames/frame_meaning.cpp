#include "sim/line_monitor/frames/frame_meaning.hpp"

#include <algorithm>
#include <numeric>
#include <string_view>

#include "firmware/dcon/commands.hpp"
#include "firmware/line/crc16.hpp"
#include "firmware/line/rtu_frames.hpp"
#include "firmware/modbus/functions.hpp"
#include "firmware/registers/bits.hpp"
#include "firmware/registers/words.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

constexpr std::string_view kDelimiters = "#$%@~";
constexpr std::string_view kLeads = "!>?";

bool printable(std::uint8_t byte) { return byte >= 0x20 && byte <= 0x7E; }

constexpr std::size_t kChecksumDigits = 2;

std::string escaped(std::uint8_t byte) {
  switch (byte) {
    case '\r':
      return "\\r";
    case '\n':
      return "\\n";
    case 0x00:
      return "\\0";
    default:
      return {static_cast<char>(byte)};
  }
}

struct DconRequest {
  const dcon::Command* command = nullptr;  ///< null: no matching command
  bool checksum = false;                   ///< the last two characters are a checksum, correct or not
};

DconRequest dcon_request_of(const std::string& text) {
  const bool broadcast = text.compare(1, 2, "**") == 0;
  // The checksum is optional, so each command is possible with and without two more characters.
  for (const std::size_t checksum : {std::size_t{0}, kChecksumDigits}) {
    for (const dcon::Command& command : dcon::kCommands) {
      const dcon::Dispatch& row = command.dispatch;
      const bool keyed = row.key != dcon::kNoKey && row.key != dcon::kBroadcastKey;
      const std::size_t lead = keyed ? 4 : 3;
      if (text[0] != row.delimiter || broadcast != (row.key == dcon::kBroadcastKey) ||
          text.size() < lead + checksum || (keyed && text[3] != row.key)) {
        continue;
      }
      const std::size_t args = text.size() - lead - checksum;
      if (args >= row.fewest_args && args <= row.most_args) {
        return {&command, checksum != 0};
      }
    }
  }
  return {};
}

bool checksum_is_right(const std::string& text) {
  const auto checksum = text.end() - kChecksumDigits;
  return std::string(checksum, text.end()) == hex_byte_text(std::accumulate(text.begin(), checksum, 0U));
}

/// Modules ignore these before a delimiter (wire.md section 3): 00 from a turn-around, LF after CR.
bool is_skipped(std::uint8_t byte) { return byte == 0x00 || byte == '\n'; }

/// The first byte that is not skipped if it is a delimiter, else the beginning.
FrameBytes::const_iterator dcon_begin(const FrameBytes& bytes) {
  const auto first = std::find_if_not(bytes.begin(), bytes.end(), is_skipped);
  const bool delimits =
      first != bytes.end() && kDelimiters.find(static_cast<char>(*first)) != std::string_view::npos;
  return delimits ? first : bytes.begin();
}

/// Without skipped bytes before a delimiter and without CR.
std::string dcon_text(const FrameBytes& bytes) {
  return {dcon_begin(bytes), bytes.end() - (bytes.back() == '\r' ? 1 : 0)};
}

std::string dcon_request(const FrameBytes& bytes) {
  const std::string text = dcon_text(bytes);
  if (text.size() < 3) {
    return "";
  }
  const dcon::Command* command = dcon_request_of(text).command;
  if (command == nullptr) {
    return "unknown command";
  }
  const std::string error = check_error(bytes, Speaker::Master);
  return std::string(command->syntax) + ": " + std::string(command->meaning) +
         (error.empty() ? "" : ", " + error);
}

std::string dcon_reply(const FrameBytes& bytes) {
  if (bytes == FrameBytes{'!', '\r'}) {
    return "ignored: the timeout status is set";
  }
  return bytes.front() == '?' ? "rejected" : "reply";
}

/// A function of `listed` can access the row, and on at least one model the address is in it.
template <class Row>
bool lies_in(const Row& row, registers::Functions listed, unsigned address) {
  return (row.functions & listed) != 0 &&
         std::any_of(std::begin(kModels), std::end(kModels), [&](const Model& model) {
           return meets(model, row.needs) && address - row.first < registers::width_of(row.width, model);
         });
}

/// `request`: without the CRC, and with a function code up to 10 (hex).
std::string row_meaning(Bytes request) {
  if (modbus::is_host_ok(request)) {
    return ", host OK";
  }
  const unsigned function = request[1];
  const unsigned address = request.word(2);
  const auto listed =
      static_cast<registers::Functions>(function == 0x10 ? registers::kWriteRegisters : 1U << function);
  for (const auto& entry : registers::kBitRegisters) {
    if (lies_in(entry.row, listed, address)) {
      return ", " + std::string(entry.meaning);
    }
  }
  for (const auto& entry : registers::kWordRegisters) {
    if (lies_in(entry.row, listed, address)) {
      return ", " + std::string(entry.meaning);
    }
  }
  return ", unknown address";
}

constexpr std::size_t kShortestModbus = 4;

std::string modbus_check_error(const FrameBytes& bytes) {
  if (is_arbitration(bytes)) {
    return "";
  }
  if (bytes.size() < kShortestModbus) {
    const bool noise = bytes.size() == 1 && bytes[0] < 0x20;  // for example an LF after CR
    return noise ? "" : "too short for a frame";
  }
  return crc16({bytes.data(), bytes.size()}).value() == 0 ? "" : "wrong CRC";
}

/// `who`: the receiver or the sender. `bytes`: after the address, with any byte in its place.
std::string modbus_meaning(const std::string& who, const FrameBytes& bytes, Speaker speaker) {
  constexpr unsigned kExceptionBit = 0x80;
  constexpr std::size_t kExceptionSize = 5;
  const unsigned function = bytes[1];
  const bool exception =
      speaker == Speaker::Module && (function & kExceptionBit) != 0 && bytes.size() == kExceptionSize;
  const unsigned code = exception ? function & ~kExceptionBit : function;
  const auto* row = std::find_if(std::begin(modbus::kFunctions), std::end(modbus::kFunctions),
                                 [code](const modbus::Function& f) { return f.row.code == code; });
  const std::string name =
      row == std::end(modbus::kFunctions) ? "function " + hex_byte_text(code) : std::string(row->name);
  if (speaker == Speaker::Module) {
    return who + name + (exception ? ", exception " + hex_byte_text(bytes[2]) : ", reply");
  }
  if (bytes.size() < 8 || row == std::end(modbus::kFunctions) || function > 0x10 || function == 0x08) {
    return who + name;
  }
  const Bytes request{bytes.data(), bytes.size() - 2};
  const unsigned value = request.word(4);
  const bool single = function == 5 || function == 6;
  return who + name + " " + hex_word_text(request.word(2)) +
         (single ? " = " + hex_word_text(value) : " x " + std::to_string(value)) + row_meaning(request);
}

/// extensions.md, scan; empty: unknown. `bytes`: function 46 at address FD, with its CRC.
std::string scan_meaning(const FrameBytes& bytes, Speaker speaker) {
  constexpr std::size_t kFoundSize = 10;
  const bool has_number = bytes.size() >= kFoundSize;
  const std::string number = has_number ? hex_text({bytes.begin() + 3, bytes.begin() + 7}, "") : "";
  switch (bytes[2]) {
    case modbus::kFirstRound:
      return "scan, first round";
    case modbus::kNextRound:
      return "scan, next round";
    case modbus::kFound:
      return has_number ? "scan: " + number + " at address " + hex_byte_text(bytes[7]) : "";
    case modbus::kNobodyLeft:
      return "scan: nobody is left";
    case modbus::kRequestByNumber:
    case modbus::kReplyByNumber:
      return has_number ? modbus_meaning(number + ": ", {bytes.begin() + modbus::kNumberPrefix, bytes.end()},
                                         speaker)
                        : "";
    default:
      return "";
  }
}

std::string modbus_meaning(const FrameBytes& bytes, Speaker speaker) {
  std::string error = modbus_check_error(bytes);
  if (is_arbitration(bytes)) {
    return "arbitration of a scan: a byte in " + std::to_string(bytes.size()) + " windows";
  }
  if (bytes.size() < kShortestModbus || !error.empty()) {
    return error;
  }
  if (bytes[0] == modbus::kScanAddress && bytes[1] == modbus::kScanFunction) {
    if (std::string scan = scan_meaning(bytes, speaker); !scan.empty()) {
      return scan;
    }
  }
  return modbus_meaning(bytes[0] == 0 ? "all modules: " : hex_byte_text(bytes[0]) + ": ", bytes, speaker);
}

}  // namespace

bool is_arbitration(const FrameBytes& bytes) {
  return !bytes.empty() && std::all_of(bytes.begin(), bytes.end(),
                                       [](std::uint8_t byte) { return byte == modbus::kZeroInWindow; });
}

bool looks_like_dcon(const FrameBytes& bytes) {
  if (bytes.empty()) {
    return false;
  }
  const auto begin = dcon_begin(bytes);
  const char first = static_cast<char>(*begin);
  if (kDelimiters.find(first) == std::string_view::npos && kLeads.find(first) == std::string_view::npos) {
    return false;
  }
  const auto text_end = bytes.back() == '\r' ? bytes.end() - 1 : bytes.end();
  return std::all_of(begin, text_end, printable);
}

bool was_dcon(const FrameBytes& bytes) {
  return looks_like_dcon(bytes) || (!bytes.empty() && looks_like_dcon({bytes.front()}) &&
                                    bytes.back() == '\r' && !modbus_check_error(bytes).empty());
}

std::string shown(const FrameBytes& bytes) {
  if (!looks_like_dcon(bytes)) {
    return hex_text(bytes, " ");
  }
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += escaped(byte);
  }
  return text;
}

std::string check_error(const FrameBytes& bytes, Speaker speaker) {
  if (!was_dcon(bytes)) {
    return modbus_check_error(bytes);
  }
  if (!looks_like_dcon(bytes)) {
    return "contains characters that are not printable";
  }
  if (speaker == Speaker::Module) {
    return "";  // the module's setting decides whether the last two characters are a checksum
  }
  const std::string text = dcon_text(bytes);
  return dcon_request_of(text).checksum && !checksum_is_right(text) ? "wrong checksum" : "";
}

std::string meaning(const FrameBytes& bytes, Speaker speaker) {
  if (!was_dcon(bytes)) {
    return modbus_meaning(bytes, speaker);
  }
  if (!looks_like_dcon(bytes)) {
    return check_error(bytes, speaker);
  }
  return speaker == Speaker::Master ? dcon_request(bytes) : dcon_reply(bytes);
}

}  // namespace ex9000::sim
