// The DCON (ASCII) command set, one row a command - wire.md section 4.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/bytes.hpp"
#include "firmware/model/model.hpp"
#include "firmware/request/outcome.hpp"
#include "firmware/request/reply.hpp"
#include "firmware/request/state.hpp"
#include "firmware/table.hpp"

namespace ex9000::dcon {

/// Judges the arguments of one command, writes the reply without checksum and CR, and says what is to be
/// done. A pure function of request and state. `args` are the characters behind address and key; their number
/// fits the row.
using Handler = Refusal (*)(const State& state, Bytes args, Outcome& outcome, Reply& reply);

// configuration_commands.cpp
Refusal set_configuration(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal read_configuration(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal read_reset_status(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal read_version(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal read_name(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal set_name(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal read_protocol(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal set_protocol(const State& state, Bytes args, Outcome& outcome, Reply& reply);
// channel_commands.cpp
Refusal take_sample(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal read_sample(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal read_channels(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal read_channels_short(const State& state, Bytes args, Outcome& outcome, Reply& reply);
// output_commands.cpp
Refusal set_output_group(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal set_outputs(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal read_preset_value(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal store_preset_value(const State& state, Bytes args, Outcome& outcome, Reply& reply);
// input_commands.cpp
Refusal read_counter(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal clear_latches(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal clear_counter(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal read_latches(const State& state, Bytes args, Outcome& outcome, Reply& reply);
// watchdog_commands.cpp
Refusal host_ok(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal read_status(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal clear_status(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal read_watchdog(const State& state, Bytes args, Outcome& outcome, Reply& reply);
Refusal set_watchdog(const State& state, Bytes args, Outcome& outcome, Reply& reply);

constexpr char kNoKey = 0;
constexpr char kBroadcastKey = '*';

/// What the module itself needs of a row.
struct Dispatch {
  char delimiter = 0;
  char key = kNoKey;  ///< the character behind the address; kBroadcastKey: the address is `**`
  std::uint8_t fewest_args = 0;
  std::uint8_t most_args = 0;
  Needs needs = Needs::Nothing;
  Handler handler = nullptr;
};

enum class Access : std::uint8_t { Read, Write, Store };

/// A row: what people read, and what the module needs. The texts are not referred to by the module, so an
/// image does not carry them.
struct Command {
  std::string_view id;      ///< stable, for coverage and cross-reference
  std::string_view syntax;  ///< as the manuals write it
  std::string_view reply;   ///< the valid one; empty: none
  std::string_view meaning;
  std::string_view range;  ///< of the arguments
  Access access;           ///< Store: the reply leaves when the EEPROM holds it
  bool needs_init;         ///< marked (I); `%` only where baud rate or checksum change
  Dispatch dispatch;
};

inline constexpr auto kCommands = table<Command>({
    {"set-configuration",
     "%AANNTTCCFF",
     "!NN",
     "set address, baud rate, checksum and counter edge",
     "NN: the new address 00-FF (01-F7 while Modbus is stored); TT: 40, or 24; CC: 03-0A, FF: 00, 40, 80 or "
     "C0, both from the next reset on; (I) only to change CC or the checksum",
     Access::Store,
     true,
     {'%', kNoKey, 8, 8, Needs::Nothing, set_configuration}},
    {"sample",
     "#**",
     "",
     "all modules: take a synchronized sample",
     "",
     Access::Write,
     false,
     {'#', kBroadcastKey, 0, 0, Needs::Nothing, take_sample}},
    {"set-output-group",
     "#AABBDD",
     ">",
     "set a group of outputs, or one",
     "BB: 00 or 0A outputs 0-7, 0B outputs 8 and up, DD: their bits; BB: 1c or Ac output c, Bc output 8+c, "
     "DD: 00 off, 01 on",
     Access::Write,
     false,
     {'#', kNoKey, 4, 4, Needs::Outputs, set_output_group}},
    {"read-counter",
     "#AAN",
     "!AA(5 decimal digits)",
     "read a counter",
     "N: channel, from 0",
     Access::Read,
     false,
     {'#', kNoKey, 1, 1, Needs::Inputs, read_counter}},
    {"read-configuration",
     "$AA2",
     "!AATTCCFF",
     "read the stored configuration",
     "",
     Access::Read,
     false,
     {'$', '2', 0, 0, Needs::Nothing, read_configuration}},
    {"read-sample",
     "$AA4",
     "!S(First)(Second)00",
     "read the synchronized sample; S is 1 the first time",
     "",
     Access::Read,
     false,
     {'$', '4', 0, 0, Needs::Nothing, read_sample}},
    {"read-reset-status",
     "$AA5",
     "!AAS",
     "read and clear the reset status",
     "",
     Access::Read,
     false,
     {'$', '5', 0, 0, Needs::Nothing, read_reset_status}},
    {"read-channels",
     "$AA6",
     "!(First)(Second)00",
     "read inputs and outputs",
     "",
     Access::Read,
     false,
     {'$', '6', 0, 0, Needs::Nothing, read_channels}},
    {"read-version",
     "$AAF",
     "!AA(Version)",
     "read the firmware version",
     "",
     Access::Read,
     false,
     {'$', 'F', 0, 0, Needs::Nothing, read_version}},
    {"read-name",
     "$AAM",
     "!AA(Name)",
     "read the module's name",
     "",
     Access::Read,
     false,
     {'$', 'M', 0, 0, Needs::Nothing, read_name}},
    {"clear-latches",
     "$AAC",
     "!AA",
     "clear both latches of all channels",
     "",
     Access::Write,
     false,
     {'$', 'C', 0, 0, Needs::Inputs, clear_latches}},
    {"clear-counter",
     "$AACN",
     "!AA",
     "clear a counter",
     "N: channel, from 0",
     Access::Write,
     false,
     {'$', 'C', 1, 1, Needs::Inputs, clear_counter}},
    {"read-latches",
     "$AALS",
     "!(First)(Second)00",
     "read the latches",
     "S: 1 latch high, 0 latch low",
     Access::Read,
     false,
     {'$', 'L', 1, 1, Needs::Inputs, read_latches}},
    {"read-protocol",
     "$AAP",
     "!AA10 or !AA11",
     "read the stored protocol: 10 ASCII, 11 Modbus RTU",
     "",
     Access::Read,
     false,
     {'$', 'P', 0, 0, Needs::Modbus, read_protocol}},
    {"set-protocol",
     "$AAPN",
     "!AA",
     "set the protocol, from the next reset on",
     "N: 0 ASCII, 1 Modbus RTU (wants a stored address of 01-F7)",
     Access::Store,
     true,
     {'$', 'P', 1, 1, Needs::Modbus, set_protocol}},
    {"read-channels-short",
     "@AA",
     ">(First)(Second)",
     "read inputs and outputs",
     "",
     Access::Read,
     false,
     {'@', kNoKey, 0, 0, Needs::Nothing, read_channels_short}},
    {"set-outputs",
     "@AA(Data)",
     ">",
     "set all outputs",
     "Data: a hex number, bit 0 is output 0; 1 digit for up to 4 outputs, 2 or 1 for up to 8, 4 or 2 above",
     Access::Write,
     false,
     {'@', kNoKey, 1, 4, Needs::Outputs, set_outputs}},
    {"set-name",
     "~AAO(Name)",
     "!AA",
     "set the module's name",
     "Name: 1-6 characters 0x20-0x7E, 1-7 on the EX9068D-M and EX9068AD-M",
     Access::Store,
     false,
     {'~', 'O', 1, kMaxNameLength, Needs::Nothing, set_name}},
    {"host-ok",
     "~**",
     "",
     "all modules: the host is alive; restarts the host watchdog",
     "",
     Access::Write,
     false,
     {'~', kBroadcastKey, 0, 0, Needs::Nothing, host_ok}},
    {"read-status",
     "~AA0",
     "!AASS",
     "read the host watchdog's status",
     "",
     Access::Read,
     false,
     {'~', '0', 0, 0, Needs::Nothing, read_status}},
    {"clear-status",
     "~AA1",
     "!AA",
     "clear the timeout status",
     "",
     Access::Store,
     false,
     {'~', '1', 0, 0, Needs::Nothing, clear_status}},
    {"read-watchdog",
     "~AA2",
     "!AAEVV",
     "read the host watchdog's enable and timeout",
     "",
     Access::Read,
     false,
     {'~', '2', 0, 0, Needs::Nothing, read_watchdog}},
    {"set-watchdog",
     "~AA3EVV",
     "!AA",
     "set the host watchdog",
     "E: 0 off, 1 on; VV: timeout 01-FF in units of 0.1 s",
     Access::Store,
     false,
     {'~', '3', 3, 3, Needs::Nothing, set_watchdog}},
    {"read-preset-value",
     "~AA4V",
     "!AA(First)(Second)",
     "read the power-on or safe value",
     "V: P power-on value, S safe value",
     Access::Read,
     false,
     {'~', '4', 1, 1, Needs::Outputs, read_preset_value}},
    {"store-preset-value",
     "~AA5V",
     "!AA",
     "store the outputs as power-on or safe value",
     "V: P power-on value, S safe value",
     Access::Store,
     false,
     {'~', '5', 1, 1, Needs::Outputs, store_preset_value}},
});

}  // namespace ex9000::dcon
