// The UART and its RS-485 driver, half duplex.
//
// While the driver is off, the receive interrupt calls `Device::on_receive` for each byte, including bytes
// with errors. While the driver is on, the receive interrupt does not call this function, because the
// received bytes are the echo. When a reply has been sent and the driver is off, an interrupt of the same
// preemption priority calls `Device::on_sent`.
//
//     LineTiming timing(std::uint32_t baud, LineFormat format) const
//         Returns the times of the line, which depend on when the UART reports a byte.
//     void open(std::uint32_t baud, LineFormat format)
//         Starts to receive at `baud` bits per second (1200 to 115200). Before this call, the driver is off
//         and nothing is received. A byte whose only error is wrong parity is reported as
//         ByteStatus::ParityError. The receiver checks only the first stop bit. For the main loop, once after
//         reset; does not block.
//     void send(Bytes bytes)
//         Turns the driver on, sends `bytes` and turns the driver off. The driver is on before the first
//         start bit. It is turned off within one character time after the last stop bit has left the shift
//         register. The data register becomes empty earlier, so its flag must not turn the driver off. For
//         the main loop, only while not `sending()`; does not block. `bytes` must not be empty, and must stay
//         valid while `sending()`.
//     bool sending() const
//         Returns whether the driver is on. For interrupts and the main loop.
//
// On a board, also:
//
//     void start()
//         Turns the driver off. Once, before `open`.
//     void on_interrupt(Deliver deliver)
//         Calls `deliver(byte, status)` for a received byte, or continues to send. For the interrupt of the
//         UART.
//     bool on_end_timer()
//         Turns the driver off if the last stop bit has left the shift register, and returns whether it has.
//         Else restarts the end timer, a one-shot timer that belongs to the line. For the interrupt of this
//         timer. A UART with an interrupt at the end of a transmission needs neither this function nor the
//         timer: the handler of that interrupt turns the driver off and calls `Device::on_sent`.
#pragma once
