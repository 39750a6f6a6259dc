// The UART and its RS-485 driver, half duplex. While the driver is off, the receive interrupt calls
// `Device::on_receive` for each byte, also with an error. While it is on, it does not: these bytes are the
// echo. When a reply has been sent and the driver is off, an interrupt of the same preemption priority calls
// `Device::on_sent`. Nothing blocks.
//
//     LineTiming timing(std::uint32_t baud, LineFormat format) const
//         Depends on when the UART reports a byte.
//     void open(std::uint32_t baud, LineFormat format)
//         Once after reset, from the main loop: receives from now on, at 1200 to 115200 baud. Until then the
//         driver is off and nothing is received. A byte whose only error is its parity gets
//         ByteStatus::ParityError. The receiver checks only the first stop bit.
//     void send(Bytes bytes)
//         From the main loop, only while not `sending()`. The driver is on before the first start bit and off
//         within a character time after the last stop bit has left the shift register. The data register is
//         empty earlier: its flag must not turn the driver off. `bytes`: not empty, valid while `sending`.
//     void send_in_interrupt(Bytes bytes)
//         As `send`, from the interrupt of the silence timer. The main loop must not call `send` meanwhile.
//     bool sending() const    The driver is on. For interrupts and the main loop.
//     bool low() const
//         A start bit is on the line, from another sender. false if the board cannot tell. For interrupts.
//
// On a board, also:
//     void start()            Turns the driver off. Once, before `open`.
//     void on_interrupt(Deliver deliver)
//         From the UART's interrupt: calls `deliver(byte, status)` for a received byte, or continues to send.
//     bool on_end_timer()
//         From the interrupt of the end timer, a one-shot timer of the line. Turns the driver off if the last
//         stop bit has left the shift register; else restarts the timer and returns false. A UART with an
//         interrupt for this needs neither: its handler turns the driver off and calls `Device::on_sent`.
#pragma once
