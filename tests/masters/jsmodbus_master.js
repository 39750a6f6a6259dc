// Plays conversation.txt with jsmodbus over a serial line, as RTU frames over TCP, or over Modbus TCP.
"use strict";
const events = require("events");
const net = require("net");
const jsmodbus = require("jsmodbus");
const { SerialPort } = require("serialport");
const { TIMEOUT, turnaround, hex, word, bits, words, written, main } = require("./conversation");

// The library supports only these functions.
const REQUESTS = {
  0x01: (client, frame) => client.readCoils(word(frame, 2), word(frame, 4)),
  0x02: (client, frame) => client.readDiscreteInputs(word(frame, 2), word(frame, 4)),
  0x03: (client, frame) => client.readHoldingRegisters(word(frame, 2), word(frame, 4)),
  0x04: (client, frame) => client.readInputRegisters(word(frame, 2), word(frame, 4)),
  0x05: (client, frame) => client.writeSingleCoil(word(frame, 2), word(frame, 4) === 0xff00),
  0x06: (client, frame) => client.writeSingleRegister(word(frame, 2), word(frame, 4)),
  0x0f: (client, frame) => client.writeMultipleCoils(word(frame, 2), bits(frame)),
  0x10: (client, frame) => client.writeMultipleRegisters(word(frame, 2), words(frame)),
};

const read = (frame, body) => [frame[0], body.fc, body.valuesAsBuffer.length, ...body.valuesAsBuffer];

// Functions that reconstruct the frame of a reply from the result of the library.
const ANSWERS = {
  0x01: read,
  0x02: read,
  0x03: read,
  0x04: read,
  0x05: (frame, body) => written(frame, body.address, body.value ? 0xff00 : 0),
  0x06: (frame, body) => written(frame, body.address, body.value),
  0x0f: (frame, body) => written(frame, body.start, body.quantity),
  0x10: (frame, body) => written(frame, body.start, body.quantity),
};

/** Returns whether the request reads more than 2000 coils or inputs. The library rejects such a request. */
const refused = (frame) => frame[1] <= 0x02 && word(frame, 4) > 2000;

/**
 * Returns whether the request writes "on" with function 05. The library treats the correct reply as "off".
 * Without Modbus TCP, the library then reports a CRC error, because it expects the CRC of "off".
 */
const misread = (frame) => frame[1] === 0x05 && word(frame, 4) === 0xff00;

const granted = ({ wait, frame, expected }) => !wait && expected === hex(frame);

/**
 * Returns the part of the conversation that the library supports. Omits the checks of the replies that the library
 * misreads. Later requests read back most of the written values.
 */
function supportedSteps(steps) {
  return steps
    .filter(({ wait, frame }) => wait || (frame[1] in REQUESTS && !refused(frame)))
    .map((step) => (granted(step) && misread(step.frame) ? { ...step, expected: undefined } : step));
}

async function ask(client, frame) {
  try {
    const { response } = await REQUESTS[frame[1]](client, frame);
    return hex(ANSWERS[frame[1]](frame, response.body));
  } catch (error) {
    if (error.err === "ModbusException") {
      return hex([frame[0], 0x80 | frame[1], error.response.body.code]);
    }
    return error.err === "Timeout" ? "silence" : `${error.err}: ${error.message}`;
  }
}

async function open({ tty, host, port, baud }) {
  if (tty) {
    const serial = new SerialPort({ path: tty, baudRate: baud, autoOpen: false });
    await new Promise((resolve, reject) => serial.open((error) => (error ? reject(error) : resolve())));
    return serial;
  }
  const socket = net.connect(port, host);
  await events.once(socket, "connect");
  socket.isOpen = true; // the library reads this property, which only serial ports have
  return socket;
}

/** Returns a connected client of the library for each address, in a Map. */
async function openClients(where, addresses) {
  const timeout = (address) => (address === 0 ? turnaround(where) : TIMEOUT);
  const clientsOf = (Client, line) =>
    new Map(addresses.map((address) => [address, new Client(line, address, timeout(address))]));
  if (!where.modbusTcp) {
    return clientsOf(jsmodbus.client.RTU, await open(where));
  }
  const socket = net.connect(where.port, where.host);
  const clients = clientsOf(jsmodbus.client.TCP, socket); // before "connect", because they wait for this event
  await events.once(socket, "connect");
  return clients;
}

main("jsmodbus", async (where, steps, checks) => {
  const supported = supportedSteps(steps);
  const addresses = new Set(supported.filter(({ wait }) => !wait).map(({ frame }) => frame[0]));
  const clients = await openClients(where, [...addresses]);
  await checks.play(supported, (frame) => ask(clients.get(frame[0]), frame));
  clients.get(1).socket.destroy();
});
