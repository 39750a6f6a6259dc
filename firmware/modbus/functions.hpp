// The Modbus functions, one table row each - wire.md section 7.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/model/model.hpp"
#include "firmware/request/exchange.hpp"

namespace ex9000::modbus {

/// Returns the refusal or None. If None and the request is not ignored, the handler has appended the data to
/// the reply, after address and function code. It has also recorded in the outcome what the module must do.
/// The frame has at least 2 bytes: address, function code and data, no CRC.
using Handler = Refusal (*)(Exchange& exchange);

// read_functions.cpp
Refusal read_bits(Exchange& exchange);
Refusal read_words(Exchange& exchange);
// write_functions.cpp
Refusal write_single_coil(Exchange& exchange);
Refusal write_single_register(Exchange& exchange);
Refusal write_multiple_coils(Exchange& exchange);
Refusal write_multiple_registers(Exchange& exchange);
// diagnostics.cpp
Refusal diagnose(Exchange& exchange);
// identification.cpp
Refusal report_server_id(Exchange& exchange);
Refusal read_device_identification(Exchange& exchange);
Refusal vendor_function(Exchange& exchange);

enum class AtBroadcast : std::uint8_t {
  Ignored,
  CarriedOut,  ///< executed or refused without a reply; a write to a row with `kConfiguration` is ignored
};

struct FunctionRow {
  std::uint8_t code = 0;
  Needs needs = Needs::Nothing;
  AtBroadcast at_broadcast = AtBroadcast::Ignored;  ///< effect of a request to address 0
  Handler handler = nullptr;
};

struct Function {
  std::string_view name;
  std::string_view source;
  FunctionRow row;
};

inline constexpr Function kFunctions[] = {
    {"Read Coils", "manuals; V1.1b3 6.1", {0x01, Needs::Nothing, AtBroadcast::Ignored, read_bits}},
    {"Read Discrete Inputs",
     "EX9052D manual; V1.1b3 6.2",
     {0x02, Needs::Inputs, AtBroadcast::Ignored, read_bits}},
    {"Read Holding Registers",
     "manuals; V1.1b3 6.3",
     {0x03, Needs::Nothing, AtBroadcast::Ignored, read_words}},
    {"Read Input Registers", "manuals; V1.1b3 6.4", {0x04, Needs::Nothing, AtBroadcast::Ignored, read_words}},
    {"Write Single Coil",
     "manuals; V1.1b3 6.5",
     {0x05, Needs::Nothing, AtBroadcast::CarriedOut, write_single_coil}},
    {"Write Single Register",
     "manuals; V1.1b3 6.6",
     {0x06, Needs::Nothing, AtBroadcast::CarriedOut, write_single_register}},
    {"Diagnostics", "V1.1b3 6.8", {0x08, Needs::Nothing, AtBroadcast::Ignored, diagnose}},
    {"Write Multiple Coils",
     "manuals; V1.1b3 6.11",
     {0x0F, Needs::Nothing, AtBroadcast::CarriedOut, write_multiple_coils}},
    {"Write Multiple Registers",
     "V1.1b3 6.12",
     {0x10, Needs::Nothing, AtBroadcast::CarriedOut, write_multiple_registers}},
    {"Report Server ID", "V1.1b3 6.13", {0x11, Needs::Nothing, AtBroadcast::Ignored, report_server_id}},
    {"Read Device Identification",
     "V1.1b3 6.21",
     {0x2B, Needs::Nothing, AtBroadcast::Ignored, read_device_identification}},
    {"Module code and address", "manuals", {0x46, Needs::Nothing, AtBroadcast::Ignored, vendor_function}},
};

}  // namespace ex9000::modbus
