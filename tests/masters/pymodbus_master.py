#!/usr/bin/python3
"""Plays conversation.txt with pymodbus over a serial line, as RTU frames over TCP, or over Modbus TCP."""

import argparse
import logging
import pathlib
import select
import struct
import sys
import time

import pymodbus
from pymodbus import diag_message
from pymodbus.bit_read_message import ReadCoilsRequest, ReadDiscreteInputsRequest
from pymodbus.bit_write_message import WriteMultipleCoilsRequest, WriteSingleCoilRequest
from pymodbus.client import ModbusSerialClient, ModbusTcpClient
from pymodbus.mei_message import ReadDeviceInformationRequest
from pymodbus.other_message import ReadExceptionStatusRequest, ReportSlaveIdRequest
from pymodbus.pdu import ExceptionResponse, ModbusRequest, ModbusResponse
from pymodbus.register_read_message import (
    ReadHoldingRegistersRequest,
    ReadInputRegistersRequest,
    ReadWriteMultipleRegistersRequest,
)
from pymodbus.register_write_message import (
    MaskWriteRegisterRequest,
    WriteMultipleRegistersRequest,
    WriteSingleRegisterRequest,
)
from pymodbus.transaction import ModbusRtuFramer, ModbusSocketFramer
from pymodbus.utilities import pack_bitstring, unpack_bitstring

RATES = [1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200]
TIMEOUT = 10  # seconds; long enough for a busy machine


def words(data):
    return struct.unpack(f">{len(data) // 2}H", data)


def packed(*values):
    return struct.pack(f">{len(values)}H", *values)


def turnaround(arguments):
    """Returns how long a master waits after a broadcast, which has no reply, in seconds: slightly more than the
    duration of the longest broadcast on the line, plus 5 s.

    The line runs in real time, so the simulator must read the broadcast during this wait, even on a busy machine. With
    Modbus TCP, the gateway separates the requests. The wait then only has to be long enough to detect a wrong reply.
    """
    return 0.25 if arguments.modbus_tcp else 5 + 150 / arguments.baud


class IdentificationRequest(ReadDeviceInformationRequest):
    """A request of function 2B with the length of its reply. Without that length, the library knows the end of a reply
    only if the reply is an exception or has the header of Modbus TCP. After another reply, the library waits until a
    pause occurs (on a serial line) or until its timeout expires (with RTU frames over TCP)."""

    def __init__(self, data, reply_size):
        super().__init__(data[1], data[2])
        self.sub_function_code = data[0]
        self.reply_size = reply_size

    def get_response_pdu_size(self):
        return self.reply_size


class Function46Request(ModbusRequest):
    """Function 46, as a custom request of pymodbus."""

    function_code = 0x46

    def __init__(self, data):
        super().__init__()
        self.data = data

    def encode(self):
        return self.data


class Function46Response(ModbusResponse):
    function_code = 0x46
    _rtu_frame_size = 9

    def decode(self, data):
        self.data = data


DIAGNOSTICS = {
    request.sub_function_code: request
    for request in vars(diag_message).values()
    if hasattr(request, "sub_function_code") and issubclass(request, ModbusRequest)
}


def diagnostics(data):
    sub_function, *values = words(data)
    request = DIAGNOSTICS[sub_function]()
    if values != [request.message]:
        request.message = values
    return request


def write_coils(data):
    address, count = words(data[:4])
    return WriteMultipleCoilsRequest(address, unpack_bitstring(data[5:])[:count])


def read_write_registers(data):
    read_address, read_count, write_address, _ = words(data[:8])
    return ReadWriteMultipleRegistersRequest(
        read_address=read_address,
        read_count=read_count,
        write_address=write_address,
        write_registers=words(data[9:]),
    )


# Functions that create the library's request from the bytes after the function code of a frame.
REQUESTS = {
    0x01: lambda data: ReadCoilsRequest(*words(data)),
    0x02: lambda data: ReadDiscreteInputsRequest(*words(data)),
    0x03: lambda data: ReadHoldingRegistersRequest(*words(data)),
    0x04: lambda data: ReadInputRegistersRequest(*words(data)),
    0x05: lambda data: WriteSingleCoilRequest(words(data)[0], words(data)[1] == 0xFF00),
    0x06: lambda data: WriteSingleRegisterRequest(*words(data)),
    0x07: lambda data: ReadExceptionStatusRequest(),
    0x08: diagnostics,
    0x0F: write_coils,
    0x10: lambda data: WriteMultipleRegistersRequest(words(data[:2])[0], list(words(data[5:]))),
    0x11: lambda data: ReportSlaveIdRequest(),
    0x16: lambda data: MaskWriteRegisterRequest(*words(data)),
    0x17: read_write_registers,
    0x46: Function46Request,
}


def counted(data):
    return bytes([len(data)]) + data


def identification(response):
    objects = b"".join(bytes([number]) + counted(text) for number, text in response.information.items())
    head = [0x0E, response.read_code, response.conformity, response.more_follows, response.next_object_id]
    return bytes(head + [response.number_of_objects]) + objects


# Functions that reconstruct the bytes after the function code of a reply from the result of the library.
ANSWERS = {
    0x01: lambda response: counted(pack_bitstring(response.bits)),
    0x02: lambda response: counted(pack_bitstring(response.bits)),
    0x03: lambda response: counted(packed(*response.registers)),
    0x04: lambda response: counted(packed(*response.registers)),
    0x05: lambda response: packed(response.address, 0xFF00 if response.value else 0),
    0x06: lambda response: packed(response.address, response.value),
    0x08: lambda response: packed(response.sub_function_code, *response.message),
    0x0F: lambda response: packed(response.address, response.count),
    0x10: lambda response: packed(response.address, response.count),
    # The library also uses the last byte of the reply as `status`, but this byte is part of the module's name.
    0x11: lambda response: counted(response.identifier),
    0x2B: identification,
    0x46: lambda response: response.data,
}


def request_of(frame, expected):
    function, data = frame[1], frame[2:]
    if function == 0x2B:
        request = IdentificationRequest(data, reply_size=len(expected) - 1)
    else:
        request = REQUESTS[function](data)
    request.unit_id = frame[0]
    return request


def ask(client, request):
    """Returns the reply that the library delivers, as the text of a frame. Returns another text if the library delivers
    no reply."""
    response = client.execute(request)
    if request.unit_id == 0:
        return "silence"  # the library does not wait for a reply; converse() checks that no reply arrives
    if not isinstance(response, ModbusResponse):
        return f"nothing ({response})"
    head = bytes([response.unit_id, response.function_code])
    if isinstance(response, ExceptionResponse):
        return text_of(head + bytes([response.exception_code]))
    return text_of(head + ANSWERS[response.function_code](response))


def bytes_of(step):
    """Returns the frame after `=>` or `<=`. Returns no bytes for `silence`."""
    return b"" if step == "silence" else bytes.fromhex(step[3:])


def text_of(frame):
    return frame.hex(" ").upper()


def steps(arguments):
    """Returns the lines of the conversation without comments. Omits the lines that begin with "gateway", except with
    Modbus TCP. With Modbus TCP, removes this word from these lines."""
    text = pathlib.Path(__file__).with_name("conversation.txt").read_text(encoding="utf-8")
    text = text.replace("{BAUD}", f"{3 + RATES.index(arguments.baud):02X}")
    lines = (line.split(";")[0].strip() for line in text.splitlines())
    played = (line for line in lines if arguments.modbus_tcp or not line.startswith("gateway "))
    return [line.removeprefix("gateway ") for line in played if line]


def converse(client, arguments):
    """Plays the conversation, and returns the numbers of checks that passed and that failed."""
    passed = failed = 0
    asked = ""
    for step in steps(arguments):
        if step.startswith("=> "):
            asked = step
        elif step.startswith("wait "):
            # The line runs in real time, so the same time passes for the modules.
            time.sleep(int(step[5:-2]) / 1000)
        else:
            expected = step.removeprefix("<= ")
            got = ask(client, request_of(bytes_of(asked), bytes_of(step)))
            if expected == "silence":
                # A master waits after a broadcast (Modbus over Serial Line V1.02, 2.4.1). On a busy machine, this check
                # can miss a late reply, but it cannot fail if there is no reply.
                time.sleep(turnaround(arguments))
                if select.select([client.socket], [], [], 0)[0]:
                    got = "a reply"
            if got == expected:
                passed += 1
            else:
                failed += 1
                print(f"{asked}: expected {expected}, got {got}")
    return passed, failed


def connected(arguments):
    options = {"timeout": TIMEOUT, "broadcast_enable": True}
    if arguments.tty:
        client = ModbusSerialClient(arguments.tty, framer=ModbusRtuFramer, baudrate=arguments.baud, **options)
    else:
        host, port = arguments.modbus_tcp or arguments.tcp
        framer = ModbusSocketFramer if arguments.modbus_tcp else ModbusRtuFramer
        client = ModbusTcpClient(host, port=port, framer=framer, **options)
    client.register(Function46Response)
    return client


class Parser(argparse.ArgumentParser):
    def error(self, message):
        self.exit(2, f"{self.prog}: {message}\n")


def host_and_port(text):
    host, port = text.rsplit(":", 1)
    return host, int(port)


def main():
    parser = Parser(description=__doc__)
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--tty", metavar="PATH")
    where.add_argument("--tcp", metavar="HOST:PORT", type=host_and_port)
    where.add_argument("--modbus-tcp", metavar="HOST:PORT", type=host_and_port)
    parser.add_argument("--baud", metavar="RATE", type=int, choices=RATES, default=9600)
    arguments = parser.parse_args()
    logging.disable(logging.ERROR)
    client = connected(arguments)
    if not client.connect():
        parser.error(f"cannot open {arguments.tty or arguments.tcp or arguments.modbus_tcp}")
    passed, failed = converse(client, arguments)
    client.close()
    version = ".".join(pymodbus.__version__.split(".")[:3])  # Debian's version 3.0.0 reports 3.0.0.rc1
    print(f"pymodbus {version}: {passed} checks passed" + (f", {failed} failed" if failed else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
