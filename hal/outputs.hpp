// The output channels: open-collector transistors, relays or PhotoMOS relays. All are de-energised from reset
// until the first `drive`.
//
//     void drive(std::uint16_t channels)
//         Drives all channels: bit n is channel n, 1 = energised (the transistor or PhotoMOS relay conducts,
//         or the coil of the relay carries current). The board defines the polarity. If no interrupt occurs
//         during the call, all changes occur within a few tens of clock cycles of the processor. The channels
//         that do not change have no glitch. The main loop calls this at each change and at least at every
//         tick. This does not block.
//
// On a board, also:
//
//     void start()
//         Makes the pins outputs, with all channels de-energised and without a glitch. Once, before `drive`.
#pragma once
