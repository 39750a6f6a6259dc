// Plays conversation.txt with modbus-serial over a serial line, as RTU frames over TCP, or over Modbus TCP.
"use strict";
const events = require("events");
const net = require("net");
const ModbusRTU = require("modbus-serial");
const crc16 = require("modbus-serial/utils/crc16");
const { SerialPort } = require("serialport");
const { TIMEOUT, turnaround, hex, word, bits, words, written, main } = require("./conversation");

// The library supports only these functions.
const REQUESTS = {
  0x01: (client, frame) => client.readCoils(word(frame, 2), word(frame, 4)),
  0x02: (client, frame) => client.readDiscreteInputs(word(frame, 2), word(frame, 4)),
  0x03: (client, frame) => client.readHoldingRegisters(word(frame, 2), word(frame, 4)),
  0x04: (client, frame) => client.readInputRegisters(word(frame, 2), word(frame, 4)),
  0x05: (client, frame) => client.writeCoil(word(frame, 2), word(frame, 4) === 0xff00),
  0x06: (client, frame) => client.writeRegister(word(frame, 2), word(frame, 4)),
  0x0f: (client, frame) => client.writeCoils(word(frame, 2), bits(frame)),
  0x10: (client, frame) => client.writeRegisters(word(frame, 2), words(frame)),
  0x11: (client) => client.reportServerID(0, 0), // the library requires two arguments and ignores them
  0x16: (client, frame) => client.maskWriteRegister(word(frame, 2), word(frame, 4), word(frame, 6)),
  0x2b: (client, frame) => client.readDeviceIdentification(frame[3], frame[4]),
};

const read = (frame, { buffer }) => [frame[0], frame[1], buffer.length, ...buffer];

/**
 * Returns the frame of the reply to function 2B. The library delivers the objects of the reply, but only one field of
 * its header: the conformity level. The modules never set "more follows".
 */
function identification(frame, { data, conformityLevel }) {
  const objects = Object.entries(data).map(([id, text]) => [Number(id), text.length, ...Buffer.from(text)]);
  return [...frame.subarray(0, 4), conformityLevel, 0, 0, objects.length, ...objects.flat()];
}

// Functions that reconstruct the frame of a reply from the result of the library.
const ANSWERS = {
  0x01: read,
  0x02: read,
  0x03: read,
  0x04: read,
  0x05: (frame, { address, state }) => written(frame, address, state ? 0xff00 : 0),
  0x06: (frame, { address, value }) => written(frame, address, value),
  0x0f: (frame, { address, length }) => written(frame, address, length),
  0x10: (frame, { address, length }) => written(frame, address, length),
  // The library treats the first byte as the whole id and the second byte as "running". `responses` contains the frame
  // that the library has received.
  0x11: (frame, { responses }) => Buffer.concat(responses).subarray(0, -2),
  0x2b: identification,
};

async function ask(client, where, frame) {
  client.setID(frame[0]);
  client.setTimeout(frame[0] === 0 ? turnaround(where) : TIMEOUT);
  try {
    return hex(ANSWERS[frame[1]](frame, await REQUESTS[frame[1]](client, frame)));
  } catch (error) {
    if (error.modbusCode) {
      return hex([frame[0], 0x80 | frame[1], error.modbusCode]);
    }
    return error.errno === "ETIMEDOUT" ? "silence" : `${error.errno}: ${error.message}`;
  }
}

/**
 * Returns whether the library can send the request. The library sends no MEI type other than 0E. Over Modbus TCP, it
 * drops a request of function 11, because it considers the request too short.
 */
function sends({ modbusTcp }, frame) {
  const dropped = (frame[1] === 0x2b && frame[2] !== 0x0e) || (modbusTcp && frame[1] === 0x11);
  return frame[1] in REQUESTS && !dropped;
}

/**
 * Returns whether the library's own port delivers the reply when the reply is complete. Without Modbus TCP, the port
 * must calculate the length of the reply. It can do this only for some functions, and not for reads of quantity 0. On a
 * serial line, the port can deliver the reply to function 11 before the reply is complete. The header of Modbus TCP
 * contains the length.
 */
function reachesOwnPort({ tty, modbusTcp }, frame) {
  if (modbusTcp) {
    return true;
  }
  const reads = frame[1] <= 0x04;
  return reads ? word(frame, 4) > 0 : [0x05, 0x06, 0x0f, 0x10].includes(frame[1]) || (tty && frame[1] === 0x2b);
}

/**
 * Connects through a port of the library. connectTelnet is for RTU frames over TCP. The library's TcpRTUBuffered is
 * not suitable for them, because it uses the header of Modbus TCP.
 */
async function connectOwnPort(client, { tty, host, port, modbusTcp, baud }) {
  if (tty) {
    await client.connectRTUBuffered(tty, { baudRate: baud });
  } else {
    await (modbusTcp ? client.connectTCP(host, { port }) : client.connectTelnet(host, { port }));
  }
}

/**
 * A custom port for the replies that the library's own port does not deliver or delivers too early. A reply is complete
 * when its CRC is correct.
 */
class FramePort extends events.EventEmitter {
  constructor(line) {
    super();
    this.line = line;
    this.isOpen = true;
    let heard = Buffer.alloc(0);
    line.on("data", (bytes) => {
      heard = Buffer.concat([heard, bytes]);
      const body = heard.length - 2;
      if (body > 2 && crc16(heard.subarray(0, body)) === heard.readUInt16LE(body)) {
        this.emit("data", heard);
        heard = Buffer.alloc(0);
      }
    });
  }
  open(done) {
    done();
  }
  write(bytes) {
    this.line.write(bytes);
  }
  close(done) {
    this.line.once("close", () => done());
    this.line.destroy();
  }
}

async function openLine({ tty, host, port, baud }) {
  const line = tty ? new SerialPort({ path: tty, baudRate: baud }) : net.connect(port, host);
  await events.once(line, tty ? "open" : "connect");
  return line;
}

async function play(client, where, steps, checks) {
  client.isDebugEnabled = true; // provides `responses`
  await checks.play(steps, (frame) => ask(client, where, frame));
  await client.close();
}

main("modbus-serial", async (where, steps, checks) => {
  const able = steps.filter(({ wait, frame }) => wait || sends(where, frame));
  const own = new ModbusRTU();
  await connectOwnPort(own, where);
  await play(own, where, able.filter(({ wait, frame }) => wait || reachesOwnPort(where, frame)), checks);

  if (where.modbusTcp) {
    return;
  }
  const rest = new ModbusRTU(new FramePort(await openLine(where)));
  await new Promise((resolve) => rest.open(resolve));
  await play(rest, where, able.filter(({ wait, frame }) => !wait && !reachesOwnPort(where, frame)), checks);
});
