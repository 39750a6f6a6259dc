// The DCON (ASCII) command set, one table row for each command - wire.md section 4 and extensions.md.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/model/model.hpp"
#include "firmware/request/exchange.hpp"

namespace ex9000::dcon {

/// Returns the refusal or None. If None, the handler has recorded in the outcome what the module must do, and
/// written the reply without checksum and CR; `#**` and `~**` get none. The arguments follow the address, or
/// the key (Dispatch::key). The caller has checked their number: `fewest_args` to `most_args`.
using Handler = Refusal (*)(Exchange& exchange);

// configuration_commands.cpp
Refusal set_configuration(Exchange& exchange);
Refusal read_configuration(Exchange& exchange);
Refusal read_reset_status(Exchange& exchange);
Refusal read_version(Exchange& exchange);
Refusal read_name(Exchange& exchange);
Refusal set_name(Exchange& exchange);
Refusal read_protocol(Exchange& exchange);
Refusal set_protocol(Exchange& exchange);
// channel_commands.cpp
Refusal take_sample(Exchange& exchange);
Refusal read_sample(Exchange& exchange);
Refusal read_channels(Exchange& exchange);
Refusal read_channels_short(Exchange& exchange);
// output_commands.cpp
Refusal set_output_group(Exchange& exchange);
Refusal set_outputs(Exchange& exchange);
Refusal read_preset_value(Exchange& exchange);
Refusal store_preset_value(Exchange& exchange);
// input_commands.cpp
Refusal read_counter(Exchange& exchange);
Refusal clear_latches(Exchange& exchange);
Refusal clear_counter(Exchange& exchange);
Refusal read_latches(Exchange& exchange);
// watchdog_commands.cpp
Refusal host_ok(Exchange& exchange);
Refusal read_status(Exchange& exchange);
Refusal clear_status(Exchange& exchange);
Refusal read_watchdog(Exchange& exchange);
Refusal set_watchdog(Exchange& exchange);
// extension_commands.cpp
Refusal read_extension(Exchange& exchange);
Refusal write_extension(Exchange& exchange);
Refusal read_response_delay(Exchange& exchange);
Refusal set_response_delay(Exchange& exchange);

constexpr char kNoKey = 0;
constexpr char kBroadcastKey = '*';

/// The mark (I) in wire.md section 4: when the command needs the configuration permission.
enum class Init : std::uint8_t {
  NotRequired,
  ToChangeLine,  ///< to change the baud code or the checksum
  Required,
};

struct Dispatch {
  char delimiter = 0;
  /// The character after the address. kNoKey: none. kBroadcastKey: none, and the address is `**`.
  char key = kNoKey;
  std::uint8_t fewest_args = 0;
  std::uint8_t most_args = 0;
  Needs needs = Needs::Nothing;
  Handler handler = nullptr;
  Init init = Init::NotRequired;
};

enum class Access : std::uint8_t { Read, Write, Store };

/// The texts are documentation; an image does not contain them.
struct Command {
  std::string_view id;      ///< never changes, because exports and tests refer to it
  std::string_view syntax;  ///< in the notation of the manuals
  std::string_view reply;   ///< reply to a valid command; empty if the module does not reply
  std::string_view meaning;
  std::string_view range;  ///< range of the arguments
  Access access;  ///< for exports; Store: may change settings; the module stores them before it replies
  Dispatch dispatch;
};

inline constexpr Command kCommands[] = {
    {"set-configuration",
     "%AANNTTCCFF",
     "!NN",
     "set address, baud rate, line format, checksum and counter edge",
     "NN: the new address 00-FF (01-F7 while Modbus is stored); TT: 40, or 24; CC: 03-0A, plus 40, 80 or "
     "C0 for the line formats 8N2, 8E1 and 8O1; FF: 00, 40, 80 or "
     "C0; a new CC or FF is in force from the next reset on; (I) only to change CC or the checksum",
     Access::Store,
     {'%', kNoKey, 8, 8, Needs::Nothing, set_configuration, Init::ToChangeLine}},
    {"sample",
     "#**",
     "",
     "all modules: take a synchronised sample",
     "",
     Access::Write,
     {'#', kBroadcastKey, 0, 0, Needs::Nothing, take_sample}},
    {"set-output-group",
     "#AABBDD",
     ">",
     "set a group of outputs or one output",
     "BB: 00 or 0A outputs 0-7, 0B outputs from 8 on, DD: their bits; BB: 1c or Ac output c, Bc output 8+c, "
     "DD: 00 off, 01 on",
     Access::Write,
     {'#', kNoKey, 4, 4, Needs::Outputs, set_output_group}},
    {"read-counter",
     "#AAN",
     "!AA(5 decimal digits)",
     "read a counter",
     "N: channel, from 0",
     Access::Read,
     {'#', kNoKey, 1, 1, Needs::Inputs, read_counter}},
    {"read-configuration",
     "$AA2",
     "!AATTCCFF",
     "read the stored configuration",
     "",
     Access::Read,
     {'$', '2', 0, 0, Needs::Nothing, read_configuration}},
    {"read-sample",
     "$AA4",
     "!S(First)(Second)00",
     "read the synchronised sample; S is 1 on the first read of a sample, then 0",
     "",
     Access::Read,
     {'$', '4', 0, 0, Needs::Nothing, read_sample}},
    {"read-reset-status",
     "$AA5",
     "!AAS",
     "read and clear the reset status",
     "",
     Access::Read,
     {'$', '5', 0, 0, Needs::Nothing, read_reset_status}},
    {"read-channels",
     "$AA6",
     "!(First)(Second)00",
     "read inputs and outputs",
     "",
     Access::Read,
     {'$', '6', 0, 0, Needs::Nothing, read_channels}},
    {"read-version",
     "$AAF",
     "!AA(Version)",
     "read the firmware version",
     "",
     Access::Read,
     {'$', 'F', 0, 0, Needs::Nothing, read_version}},
    {"read-name",
     "$AAM",
     "!AA(Name)",
     "read the module's name",
     "",
     Access::Read,
     {'$', 'M', 0, 0, Needs::Nothing, read_name}},
    {"clear-latches",
     "$AAC",
     "!AA",
     "clear both latches of all channels",
     "",
     Access::Write,
     {'$', 'C', 0, 0, Needs::Inputs, clear_latches}},
    {"clear-counter",
     "$AACN",
     "!AA",
     "clear a counter",
     "N: channel, from 0",
     Access::Write,
     {'$', 'C', 1, 1, Needs::Inputs, clear_counter}},
    {"read-latches",
     "$AALS",
     "!(First)(Second)00",
     "read the latches",
     "S: 1 latch high, 0 latch low",
     Access::Read,
     {'$', 'L', 1, 1, Needs::Inputs, read_latches}},
    {"read-protocol",
     "$AAP",
     "!AA10 or !AA11",
     "read the stored protocol: 10 ASCII, 11 Modbus RTU",
     "",
     Access::Read,
     {'$', 'P', 0, 0, Needs::Modbus, read_protocol}},
    {"set-protocol",
     "$AAPN",
     "!AA",
     "set the protocol, in force from the next reset on",
     "N: 0 ASCII, 1 Modbus RTU (requires a stored address of 01-F7)",
     Access::Store,
     {'$', 'P', 1, 1, Needs::Modbus, set_protocol, Init::Required}},
    {"read-channels-short",
     "@AA",
     ">(First)(Second)",
     "read inputs and outputs",
     "",
     Access::Read,
     {'@', kNoKey, 0, 0, Needs::Nothing, read_channels_short}},
    {"set-outputs",
     "@AA(Data)",
     ">",
     "set all outputs",
     "Data: a hex number, bit 0 is output 0; 1 digit for up to 4 outputs, 2 or 1 digits for up to 8, 4 or 2 "
     "digits for more",
     Access::Write,
     {'@', kNoKey, 1, 4, Needs::Outputs, set_outputs}},
    {"set-name",
     "~AAO(Name)",
     "!AA",
     "set the module's name",
     "Name: 1-6 characters 0x20-0x7E, 1-7 on the EX9068D-M and EX9068AD-M",
     Access::Store,
     {'~', 'O', 1, kMaxNameLength, Needs::Nothing, set_name}},
    {"host-ok",
     "~**",
     "",
     "restart the host watchdogs of all modules",
     "",
     Access::Write,
     {'~', kBroadcastKey, 0, 0, Needs::Nothing, host_ok}},
    {"read-status",
     "~AA0",
     "!AASS",
     "read the host watchdog's status",
     "",
     Access::Read,
     {'~', '0', 0, 0, Needs::Nothing, read_status}},
    {"clear-status",
     "~AA1",
     "!AA",
     "clear the timeout status",
     "",
     Access::Store,
     {'~', '1', 0, 0, Needs::Nothing, clear_status}},
    {"read-watchdog",
     "~AA2",
     "!AAEVV",
     "read whether the host watchdog is enabled, and its timeout",
     "",
     Access::Read,
     {'~', '2', 0, 0, Needs::Nothing, read_watchdog}},
    {"set-watchdog",
     "~AA3EVV",
     "!AA",
     "set the host watchdog",
     "E: 0 off, 1 on; VV: timeout 01-FF in units of 0.1 s",
     Access::Store,
     {'~', '3', 3, 3, Needs::Nothing, set_watchdog}},
    {"read-preset-value",
     "~AA4V",
     "!AA(First)(Second)",
     "read the power-on or safe value",
     "V: P power-on value, S safe value",
     Access::Read,
     {'~', '4', 1, 1, Needs::Outputs, read_preset_value}},
    {"store-preset-value",
     "~AA5V",
     "!AA",
     "store the present outputs as the power-on or safe value",
     "V: P power-on value, S safe value",
     Access::Store,
     {'~', '5', 1, 1, Needs::Outputs, store_preset_value}},
    {"read-response-delay",
     "~AARD",
     "!AAVV",
     "read the response delay",
     "",
     Access::Read,
     {'~', 'R', 1, 1, Needs::Nothing, read_response_delay}},
    {"set-response-delay",
     "~AARDVV",
     "!AA",
     "set the response delay, in force from the next request on",
     "VV: 00-1E, in ms",
     Access::Store,
     {'~', 'R', 3, 3, Needs::Nothing, set_response_delay}},
    {"read-extension",
     "~AAXRRRR",
     "!AAVVVV or !AAVVVVVVVV",
     "read an extension register",
     "RRRR: its address 0240-030F. For a 32-bit value, use the address of the high word; the reply contains "
     "both words",
     Access::Read,
     {'~', 'X', 4, 4, Needs::Nothing, read_extension}},
    {"write-extension",
     "~AAXRRRRVVVV",
     "!AA",
     "write an extension register",
     "RRRR: its address 0240-030F; VVVV: the value",
     Access::Store,
     {'~', 'X', 8, 8, Needs::Nothing, write_extension}},
};

}  // namespace ex9000::dcon
