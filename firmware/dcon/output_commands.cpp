// Setting outputs, power-on and safe values: manuals 2.3, 2.11, 2.20, 2.21.
#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/writing.hpp"
#include "firmware/hex.hpp"

namespace ex9000::dcon {

namespace {

constexpr std::uint16_t kLowGroup = 0x00FF;
constexpr unsigned kHighGroupShift = 8;

/// Form and range are right; now the timeout status decides.
Refusal drive(const State& state, Drive drive, Outcome& outcome, Reply& reply) {
  if (state.outputs_blocked()) {
    return Refusal::OutputsBlocked;
  }
  outcome.drive = drive;
  reply.put('>');
  return Refusal::None;
}

/// BB = 00, 0A or 0B: the bits of a group.
Drive group(const Model& model, std::uint8_t selector, int data) {
  const bool high = selector == 'B';
  const unsigned channels = model.output_mask() & (high ? ~unsigned{kLowGroup} : unsigned{kLowGroup});
  const auto value = static_cast<unsigned>(data) << (high ? kHighGroupShift : 0U);
  if ((selector != '0' && selector != 'A' && !high) || channels == 0 || (value & ~channels) != 0) {
    return {};
  }
  return {static_cast<std::uint16_t>(channels), static_cast<std::uint16_t>(value)};
}

/// BB = 1c, Ac or Bc: one channel.
Drive single(const Model& model, std::uint8_t selector, int channel, int data) {
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

/// One digit stands for 4 outputs; how many a full set takes on this model, and what the examples shorten it
/// to (E4).
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

Refusal set_output_group(const State& state, Bytes args, Outcome& outcome, Reply& reply) {
  const int data = hex_byte(args[2], args[3]);
  if (data < 0) {
    return Refusal::OutOfRange;
  }
  const Drive wanted = args[0] == '0' ? group(state.model(), args[1], data)
                                      : single(state.model(), args[0], hex_value(args[1]), data);
  return wanted.mask == 0 ? Refusal::OutOfRange : drive(state, wanted, outcome, reply);
}

Refusal set_outputs(const State& state, Bytes args, Outcome& outcome, Reply& reply) {
  const Digits accepted = digits(state.model());
  if (args.size != accepted.full && args.size != accepted.shortened) {
    return Refusal::OutOfRange;
  }
  unsigned value = 0;
  for (const std::uint8_t character : args) {
    const int digit = hex_value(character);
    if (digit < 0) {
      return Refusal::OutOfRange;
    }
    value = (value << 4U) | static_cast<unsigned>(digit);
  }
  const std::uint16_t channels = state.model().output_mask();
  if ((value & ~unsigned{channels}) != 0) {
    return Refusal::OutOfRange;
  }
  return drive(state, {channels, static_cast<std::uint16_t>(value)}, outcome, reply);
}

Refusal read_preset_value(const State& state, Bytes args, Outcome& /*outcome*/, Reply& reply) {
  if (args[0] != 'P' && args[0] != 'S') {
    return Refusal::OutOfRange;
  }
  put_valid(state, reply);
  put_data(state.model(), args[0] == 'P' ? state.settings.power_on_value : state.settings.safe_value, 0,
           reply);
  return Refusal::None;
}

Refusal store_preset_value(const State& state, Bytes args, Outcome& outcome, Reply& reply) {
  if (args[0] == 'P') {
    outcome.change.power_on_value(state.outputs);
  } else if (args[0] == 'S') {
    outcome.change.safe_value(state.outputs);
  } else {
    return Refusal::OutOfRange;
  }
  put_valid(state, reply);
  return Refusal::None;
}

}  // namespace ex9000::dcon
