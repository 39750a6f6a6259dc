#!/usr/bin/python3
"""The server of pymodbus: coils in units 1 to UNITS, RTU frames.

    pymodbus_server.py tcp UNITS      over TCP; prints its port
    pymodbus_server.py DEVICE UNITS   on a serial port; prints its path

It runs until it is terminated.
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


logging.disable()  # termination is not an error
asyncio.run(serve(sys.argv[1], int(sys.argv[2])))
