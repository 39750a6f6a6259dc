#include "sim/utility/device/channels.hpp"

#include <algorithm>
#include <limits>

#include "sim/text/values.hpp"
#include "sim/utility/modbus/register_map.hpp"

namespace ex9000::utility {

namespace {

constexpr unsigned kBitsOfAGroup = 8;

constexpr unsigned kOutputCoils = coils_of("outputs");
constexpr unsigned kInputCoils = coils_of("input-coils");
constexpr unsigned kLatchHighCoils = coils_of("latch-high");
constexpr unsigned kLatchLowCoils = coils_of("latch-low");
constexpr unsigned kTimeoutCoil = coils_of("timeout-status");
constexpr unsigned kCounters = registers_of("counters");

/// `First` and `Second` (wire.md section 1): on a model with inputs and outputs these are outputs and inputs.
/// Else the channels of the one kind: with more than 8, the high ones first.
unsigned channels_in(const std::string& digits, const Model& model, bool inputs) {
  constexpr std::size_t kLeast = 4;
  if (digits.size() < kLeast) {
    throw Failed("replies '" + digits + "', not four hex digits");
  }
  const std::string first = digits.substr(0, 2);
  const std::string second = digits.substr(2, 2);
  if (model.has_inputs() && model.has_outputs()) {
    return hex_number(inputs ? second : first);
  }
  return hex_number(std::max(model.inputs, model.outputs) > kBitsOfAGroup ? first + second : first);
}

unsigned bits_at(Device& device, unsigned address, unsigned count) {
  const Data data = device.read(read_bits(address, count)).data;
  return data[0] | (data.size() > 1 ? unsigned{data[1]} << kBitsOfAGroup : 0U);
}

}  // namespace

unsigned outputs_of(Device& device, const Model& model) {
  return device.speaks_modbus() ? bits_at(device, kOutputCoils, model.outputs)
                                : channels_in(device.ask("@AA", ">"), model, false);
}

unsigned inputs_of(Device& device, const Model& model) {
  return device.speaks_modbus() ? bits_at(device, kInputCoils, model.inputs)
                                : channels_in(device.ask("@AA", ">"), model, true);
}

unsigned latches_of(Device& device, const Model& model, bool high) {
  return device.speaks_modbus() ? bits_at(device, high ? kLatchHighCoils : kLatchLowCoils, model.inputs)
                                : channels_in(device.ask(high ? "$AAL1" : "$AAL0", "!"), model, true);
}

std::vector<std::uint32_t> counters_of(Device& device, const Model& model) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::vector<std::uint32_t> counters;
  const Answer answer = device.speaks_modbus() ? device.read(read_words(kCounters, model.inputs)) : Answer();
  for (unsigned channel = 0; channel < model.inputs; ++channel) {
    if (device.speaks_modbus()) {
      counters.push_back(answer.word(channel));
      continue;
    }
    const std::string digits = device.ask(std::string("#AA") + kDigits[channel]);
    const auto count = sim::whole_number(digits, std::numeric_limits<std::uint32_t>::max());
    if (!count) {
      throw Failed("replies '" + digits + "' where a counter is expected");
    }
    counters.push_back(static_cast<std::uint32_t>(*count));
  }
  return counters;
}

bool has_timed_out(Device& device) {
  if (device.speaks_modbus()) {
    return bits_at(device, kTimeoutCoil, 1) != 0;
  }
  const std::string status = device.ask("~AA0");
  return status == "04" || status == "84";  // wire.md section 1
}

}  // namespace ex9000::utility
