// Commands for outputs, power-on value and safe value: manuals 2.3, 2.11, 2.20, 2.21.
#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/writing.hpp"
#include "firmware/hex.hpp"

namespace ex9000::dcon {

namespace {

constexpr std::uint16_t kLowGroup = 0x00FF;
constexpr unsigned kHighGroupShift = 8;

Refusal drive(Exchange& exchange, BitWrite outputs) {
  exchange.outcome.drive(outputs);
  exchange.reply.put('>');
  return Refusal::None;
}

/// The outputs and levels of `#AABBDD` with BB = 00, 0A or 0B. `selector`: second character of BB; `data`:
/// DD. The mask is 0 for another BB, or if the model lacks the group or an output whose bit in `data` is 1.
BitWrite group(const Model& model, std::uint8_t selector, int data) {
  const bool high = selector == 'B';
  const unsigned channels = model.output_mask() & (high ? ~unsigned{kLowGroup} : unsigned{kLowGroup});
  const auto value = static_cast<unsigned>(data) << (high ? kHighGroupShift : 0U);
  if ((selector != '0' && selector != 'A' && !high) || channels == 0 || (value & ~channels) != 0) {
    return {};
  }
  return {static_cast<std::uint16_t>(channels), static_cast<std::uint16_t>(value)};
}

/// The output and level of `#AABBDD` with BB = 1c, Ac or Bc, c from 0 to 7. `selector`: first character of
/// BB; `channel`: value of the second, -1 if it is no upper-case hex digit; `data`: DD. The mask is 0 for
/// another BB, if the model lacks the output, or if `data` is neither 0 nor 1.
BitWrite single(const Model& model, std::uint8_t selector, int channel, int data) {
  const bool high = selector == 'B';
  if ((selector != '1' && selector != 'A' && !high) || channel < 0 || channel > 7 || data > 1) {
    return {};
  }
  const unsigned bit = 1U << (static_cast<unsigned>(channel) + (high ? kHighGroupShift : 0U));
  if ((bit & model.output_mask()) == 0) {
    return {};
  }
  return {static_cast<std::uint16_t>(bit), static_cast<std::uint16_t>(data == 1 ? bit : 0U)};
}

/// Hex digits that `@AA(Data)` accepts: the full form, and the shorter one of examples in the manuals
/// (wire.md E4). Equal if there is no shorter form.
struct Digits {
  std::size_t full;
  std::size_t shortened;
};

constexpr Digits digits(const Model& model) {
  if (model.outputs <= 4) {
    return {1, 1};
  }
  return model.outputs <= 8 ? Digits{2, 1} : Digits{4, 2};
}

}  // namespace

Refusal set_output_group(Exchange& exchange) {
  const int data = hex_byte(exchange.args[2], exchange.args[3]);
  if (data < 0) {
    return Refusal::OutOfRange;
  }
  const BitWrite wanted = exchange.args[0] == '0'
                              ? group(exchange.model(), exchange.args[1], data)
                              : single(exchange.model(), exchange.args[0], hex_value(exchange.args[1]), data);
  return wanted.mask == 0 ? Refusal::OutOfRange : drive(exchange, wanted);
}

Refusal set_outputs(Exchange& exchange) {
  const Digits accepted = digits(exchange.model());
  if (exchange.args.size != accepted.full && exchange.args.size != accepted.shortened) {
    return Refusal::OutOfRange;
  }
  unsigned value = 0;
  for (const std::uint8_t character : exchange.args) {
    const int digit = hex_value(character);
    if (digit < 0) {
      return Refusal::OutOfRange;
    }
    value = (value << 4U) | static_cast<unsigned>(digit);
  }
  const std::uint16_t channels = exchange.model().output_mask();
  if ((value & ~unsigned{channels}) != 0) {
    return Refusal::OutOfRange;
  }
  return drive(exchange, {channels, static_cast<std::uint16_t>(value)});
}

Refusal read_preset_value(Exchange& exchange) {
  if (exchange.args[0] != 'P' && exchange.args[0] != 'S') {
    return Refusal::OutOfRange;
  }
  put_valid(exchange);
  put_data(
      exchange,
      exchange.args[0] == 'P' ? exchange.state.settings.power_on_value : exchange.state.settings.safe_value,
      0);
  return Refusal::None;
}

Refusal store_preset_value(Exchange& exchange) {
  // An output that a timer will switch off is stored as off.
  const State& state = exchange.state;
  const auto value = static_cast<std::uint16_t>(state.outputs & ~state.output_timers.running());
  if (exchange.args[0] == 'P') {
    exchange.outcome.change().power_on_value = value;
  } else if (exchange.args[0] == 'S') {
    exchange.outcome.change().safe_value = value;
  } else {
    return Refusal::OutOfRange;
  }
  put_valid(exchange);
  return Refusal::None;
}

}  // namespace ex9000::dcon
