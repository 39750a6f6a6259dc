#!/usr/bin/python3
"""The server of pymodbus: unit 1, coils, RTU frames.

    pymodbus_server.py          over TCP; prints its port
    pymodbus_server.py DEVICE   on a serial port; prints its path

It serves until it is terminated.
"""

import asyncio
import logging
import sys

from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext
from pymodbus.server.async_io import ModbusSerialServer, ModbusTcpServer
from pymodbus.transaction import ModbusRtuFramer


async def serve(device):
    unit = ModbusSlaveContext(co=ModbusSequentialDataBlock(0, [False] * 16), zero_mode=True)
    context = ModbusServerContext(slaves={1: unit}, single=False)
    if device:
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
asyncio.run(serve(sys.argv[1] if len(sys.argv) > 1 else None))
