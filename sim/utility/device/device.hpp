// A module on the line, in the protocol that it speaks.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/utility/master_line/master_line.hpp"
#include "sim/utility/modbus/module.hpp"

namespace ex9000::utility {

/// The module refuses what its model, its firmware or its protocol does not have.
struct Absent : Failed {
  using Failed::Failed;
};

/// The number in hex digits of a reply. Throws Failed if it has others.
std::uint32_t hex_number(const std::string& digits);

/// The functions throw Absent, Failed, or what Connection throws.
class Device {
 public:
  /// The line must live as long.
  static Device in_modbus(MasterLine& line, const Addressee& to);
  /// With or without a checksum, as the DCON master of the line at present.
  static Device in_ascii(MasterLine& line, std::uint8_t address);

  [[nodiscard]] bool speaks_modbus() const { return module_.has_value(); }
  /// For people: its address or its serial number.
  [[nodiscard]] const std::string& name() const { return name_; }
  /// Of one that speaks ASCII.
  [[nodiscard]] std::uint8_t address() const { return address_; }
  [[nodiscard]] bool checksum() const { return checksum_; }
  MasterLine& line() { return *line_; }
  /// For a reply, in place of those of Module and DconMaster.
  void set_patience(Time patience) { patience_ = patience; }
  /// Asked twice for something harmless.
  bool replies();

  // --- Modbus ---

  Module& module() { return *module_; }
  Answer read(const Request& request);
  void write(const Request& request);

  // --- ASCII ---

  /// `command`: with `AA` for the address, for example `$AA2`. Returns what follows `!AA`, or `!` or `>` if
  /// `reply` is that.
  std::string ask(const std::string& command, const std::string& reply = "!AA");
  /// Of one that speaks ASCII: INIT* was tied to GND at the reset, so it answers at 00 until the next one.
  [[nodiscard]] bool in_init() const { return in_init_; }
  void set_in_init(bool in_init) { in_init_ = in_init; }
  /// The module has taken another address.
  void moves_to(std::uint8_t address);

  // --- extension registers, in both protocols ---

  unsigned extension(unsigned address);
  std::uint32_t long_extension(unsigned address);
  void write_extension(unsigned address, unsigned value);

 private:
  explicit Device(MasterLine& line) : line_(&line) {}

  MasterLine* line_;
  std::string name_;
  std::optional<Module> module_;
  std::uint8_t address_ = 0;
  bool checksum_ = false;
  bool in_init_ = false;
  std::optional<Time> patience_;
};

/// What a module is.
struct Identity {
  const Model* model = nullptr;  ///< null: unknown
  std::string model_text;        ///< for people, also of an unknown one
  std::string version;           ///< empty: not readable
  std::string name;
  std::optional<std::uint32_t> serial_number;
};

/// Throws Absent if the module does not tell it.
std::string name_in_modbus(Device& device);

/// Reads no more than it must, and nothing with a side effect.
Identity identify(Device& device);

}  // namespace ex9000::utility
