"""Divides the emulator's execution log into interrupts and turns of the main loop.

QEMU logs a line before it executes an instruction. Two events can prevent the execution: QEMU restarts an instruction
that accesses a peripheral ("cpu_io_recompile"), or an interrupt comes first ("Stopped"). The next line then reports
that event, and the line of the instruction does not count.
"""

MAIN = 0
TICK = 15
ALARM = 51  # alarm interrupt of this tool: see emulator.py

# Exception numbers. EDGES contains those of all ports whose inputs this tool changes.
EDGES = range(16, 21)
LINE, I2C, SILENCE, LINE_END, WAKE = 21, 24, 35, 37, 39


class Span:
    """An interrupt from its first instruction to its return, or a turn of the main loop from wake-up to sleep without
    the interrupts in between."""

    def __init__(self, exception):
        self.exception = exception
        self.addresses = []  # of all instructions; eight hexadecimal digits each, as logged
        self.received = []  # bytes read from the UART
        self.sent = 0  # number of bytes written to the UART
        self.interrupts = []  # exceptions that occurred during the turn, except ALARM


def follow(log, sleeps, listener):
    """Reads the log to its end. `sleeps` are the addresses of WFI instructions. Calls these methods of `listener`:

    - entered(span, main): an interrupt other than ALARM has started
    - left(span, main): an interrupt other than ALARM has returned
    - slept(main): a turn has ended; follow calls this function only when the main loop has woken up again
    - seen(): the log has been read up to the call of Emulator.write_sync_line
    """
    main = Span(MAIN)
    stack = [main]
    here = main.addresses
    sleeps = {as_logged(address) for address in sleeps}
    instruction, begun_anew, stopped, interrupt, uart = b"TcSnp"
    for line in log:
        lead = line[0]
        if lead == instruction:
            if here and here[-1] in sleeps:
                listener.slept(main)
                main = stack[0] = Span(MAIN)
                here = main.addresses
            at = line.index(b"/") + 1
            here.append(line[at : at + 8])
        elif lead in (begun_anew, stopped):
            if here:
                here.pop()
        elif lead == interrupt:
            if line.startswith(b"nvic_acknowledge_irq"):
                span = Span(int(line.split(b"IRQ: ")[1].split()[0]))
                if span.exception != ALARM:
                    main.interrupts.append(span.exception)
                    listener.entered(span, main)
                stack[1:] = [span]  # interrupts do not nest; a reset leaves none active
            elif len(stack) > 1:
                span = stack.pop()
                if span.exception != ALARM:
                    listener.left(span, main)
            here = stack[-1].addresses
        elif lead == uart:
            if b" addr 0x00000000 " in line:
                if line.startswith(b"pl011_read "):
                    stack[-1].received.append(int(line.rsplit(b"0x", 1)[1], 16) & 0xFF)
                else:
                    stack[-1].sent += 1
            elif b" addr 0x00000fe0 " in line:  # Emulator.mark: instruction logging starts here
                main = stack[0] = Span(MAIN)
                here = stack[-1].addresses
            elif b" addr 0x00000fe4 " in line:  # Emulator.write_sync_line
                listener.seen()


def as_logged(address):
    return f"{address:08x}".encode()
