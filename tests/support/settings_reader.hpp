// A master that asks a module for all its settings, in either protocol, and checks the frames of its replies.
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

/// How a module is spoken to.
struct Manner {
  Protocol protocol;
  std::uint8_t address;
  bool checksum;

  /// One that has come up with these settings.
  static Manner of(const Settings& settings) {
    return {settings.protocol, settings.address, (settings.format & kFormatChecksum) != 0};
  }
  static Manner init_mode() { return {Protocol::Ascii, 0, false}; }

  /// What of `request`, ASCII without checksum and CR or Modbus without CRC, goes on the line.
  [[nodiscard]] std::vector<std::uint8_t> framed(const std::vector<std::uint8_t>& request) const;
};

class SettingsReader {
 public:
  using Bytes = std::vector<std::uint8_t>;
  /// Puts a frame on the line and returns what comes back; nothing where nothing does.
  using Exchange = std::function<Bytes(const Bytes& frame)>;

  SettingsReader(const Model& model, Manner manner, Exchange exchange)
      : model_(model), manner_(manner), exchange_(std::move(exchange)) {}

  /// All of them; none where the module does not answer. Modbus does not tell the data format: it is taken
  /// from here. Throws std::out_of_range where a reply is too short for what it is to.
  std::optional<Settings> read(std::uint8_t format);

  /// The reply to a command by its delimiter and what is behind its address, without checksum and CR.
  std::string ask(const std::string& command);
  /// The reply to a Modbus request without its address and CRC; with its address.
  Bytes ask(const Bytes& request);

 private:
  std::optional<Settings> read_ascii();
  std::optional<Settings> read_modbus(std::uint8_t format);

  const Model& model_;
  Manner manner_;
  Exchange exchange_;
};

/// Two hex digits of a text.
std::uint8_t hex_byte(const std::string& text, std::size_t at);

}  // namespace ex9000
