// A master that reads the settings of a module in ASCII or Modbus RTU and checks the frames of the replies.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000 {

/// The protocol and the address of a module, and whether its DCON frames have a checksum.
struct FrameFormat {
  Protocol protocol;
  std::uint8_t address;
  bool checksum;

  /// Returns the values of a module that has started with these settings and is not in INIT mode.
  static FrameFormat of(const Settings& settings) {
    return {settings.protocol, settings.address, (settings.format & kFormatChecksum) != 0};
  }
  static FrameFormat init_mode() { return {Protocol::Ascii, 0, false}; }

  /// Returns `request` as a frame. `request` is ASCII without checksum and CR, or Modbus without CRC.
  [[nodiscard]] std::vector<std::uint8_t> framed(const std::vector<std::uint8_t>& request) const;
};

class SettingsReader {
 public:
  using Bytes = std::vector<std::uint8_t>;
  /// Sends a frame and returns the reply. Returns an empty vector if there is no reply.
  using Exchange = std::function<Bytes(const Bytes& frame)>;

  /// `number_of_board`: the serial number that the module has if none is stored.
  SettingsReader(const Model& model, FrameFormat frame_format, Exchange exchange,
                 std::uint32_t number_of_board = 0)
      : model_(model),
        frame_format_(frame_format),
        exchange_(std::move(exchange)),
        number_of_board_(number_of_board) {}

  /// Reads the settings. Returns nullopt if the first reply is missing or has a wrong length. Throws
  /// std::out_of_range or std::invalid_argument if a later reply is missing or lacks a number. No Modbus
  /// register contains the whole data format, so with Modbus the result contains the argument `format`
  /// instead.
  std::optional<Settings> read(std::uint8_t format);

  /// Sends a DCON command. `command` consists of the delimiter and the text after the address. Returns the
  /// reply without checksum and CR; empty if the reply is missing or too short.
  std::string ask(const std::string& command);
  /// Sends a Modbus request. `request` does not contain the address and the CRC. Returns the reply with its
  /// address and without its CRC; empty if the reply is missing or too short.
  Bytes ask(const Bytes& request);

 private:
  std::optional<Settings> read_ascii();
  std::optional<Settings> read_modbus(std::uint8_t format);
  [[nodiscard]] std::uint32_t stored(std::uint32_t number) const {
    return number == number_of_board_ ? 0 : number;
  }

  const Model& model_;
  FrameFormat frame_format_;
  Exchange exchange_;
  std::uint32_t number_of_board_;
};

/// Returns the value of the two hex digits at position `at`. Throws std::out_of_range or
/// std::invalid_argument if there is no hex digit at this position.
std::uint8_t hex_byte(const std::string& text, std::size_t at);

}  // namespace ex9000
