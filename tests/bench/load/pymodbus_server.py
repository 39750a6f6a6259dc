#!/usr/bin/python3
"""Runs the Modbus server of pymodbus with RTU frames. Units 1 to UNITS have 16 coils each.

    pymodbus_server.py tcp UNITS      over TCP; prints the port number when the server is ready
    pymodbus_server.py DEVICE UNITS   on the serial port DEVICE; prints DEVICE when the server is ready

The server runs until it is terminated.
"""

import asyncio
import logging
import sys

from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext
from pymodbus.server.async_io import ModbusSerialServer, ModbusTcpServer
from pymodbus.transaction import ModbusRtuFramer


def a_unit():
    return ModbusSlaveContext(co=ModbusSequentialDataBlock(0, [False] * 16), zero_mode=True)


async def serve(device, units):
    context = ModbusServerContext(slaves={unit: a_unit() for unit in range(1, units + 1)}, single=False)
    if device != "tcp":
        server = ModbusSerialServer(context, framer=ModbusRtuFramer, port=device, baudrate=115200)
        await server.start()
        print(device, flush=True)
        await server.serve_forever()
    else:
        server = ModbusTcpServer(context, framer=ModbusRtuFramer, address=("127.0.0.1", 0))
        serving = asyncio.ensure_future(server.serve_forever())
        await server.serving
        print(server.server.sockets[0].getsockname()[1], flush=True)
        await serving


logging.disable()  # otherwise pymodbus prints an error when a TCP client disconnects
asyncio.run(serve(sys.argv[1], int(sys.argv[2])))
