// The outputs: open-collector transistors, relays or PhotoMOS relays; de-energised from reset to `drive`.
//     void drive(std::uint16_t channels)
//         Bit n is channel n, 1 = energised (the transistor or PhotoMOS conducts, the coil carries current);
//         the board defines the polarity. Unless an interrupt occurs, all channels change within a few tens
//         of clock cycles; the others have no glitch. From the main loop, at each change and at least at
//         every tick; does not block.
//     void start()
//         On a board: makes the pins outputs, de-energised and without a glitch. Once, before `drive`.
#pragma once
