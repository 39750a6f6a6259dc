// Plays conversation.txt with a Modbus library. The masters in JavaScript share this file.
"use strict";
const fs = require("fs");
const path = require("path");
const timers = require("timers/promises");

const RATES = [1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200];
const FIRST_RATE_CODE = 3;

const TIMEOUT = 10000; // long enough for a busy machine; in milliseconds, like all times in this file
// The time that a master waits after a broadcast, which has no reply: slightly more than the duration of the longest
// broadcast on the line, plus 5 s. The line runs in real time, so the simulator must read the broadcast during this
// wait, even on a busy machine. With Modbus TCP, the gateway separates the requests. The wait then only has to be long
// enough to detect a wrong reply.
const turnaround = ({ modbusTcp, baud }) => (modbusTcp ? 250 : 5000 + 150000 / baud);

const hex = (bytes) => Buffer.from(bytes).toString("hex").toUpperCase().replace(/..(?=.)/g, "$& ");
const word = (frame, at) => frame.readUInt16BE(at);

/** Returns the values in a request with function 0F. */
function bits(frame) {
  return Array.from({ length: word(frame, 4) }, (_, i) => (frame[7 + (i >> 3)] >> (i & 7)) & 1);
}

/** Returns the values in a request with function 10. */
function words(frame) {
  return Array.from({ length: word(frame, 4) }, (_, i) => word(frame, 7 + 2 * i));
}

/** Returns the frame of the reply to a write. */
function written(frame, address, value) {
  const answer = Buffer.from(frame.subarray(0, 6));
  answer.writeUInt16BE(address, 2);
  answer.writeUInt16BE(value, 4);
  return answer;
}

/**
 * Returns the lines of the conversation without comments. Omits the lines that begin with "gateway", except with Modbus
 * TCP. With Modbus TCP, removes this word from these lines.
 */
function lines({ modbusTcp, baud }) {
  const text = fs.readFileSync(path.join(__dirname, "conversation.txt"), "utf8");
  return text
    .replaceAll("{BAUD}", hex([FIRST_RATE_CODE + RATES.indexOf(baud)]))
    .split("\n")
    .map((line) => line.split(";")[0].trim())
    .filter((line) => line && (modbusTcp || !line.startsWith("gateway ")))
    .map((line) => line.replace(/^gateway /, ""));
}

/** Returns the steps of the conversation: each request with its expected result, and each wait as a separate step. */
function steps(where) {
  const result = [];
  for (const line of lines(where)) {
    if (line.startsWith("=> ")) {
      result.push({ asked: line, frame: Buffer.from(line.slice(3).replaceAll(" ", ""), "hex") });
    } else if (line.startsWith("wait ")) {
      result.push({ wait: parseInt(line.slice(5), 10) });
    } else {
      result[result.length - 1].expected = line.replace("<= ", "");
    }
  }
  return result;
}

class Checks {
  passed = 0;
  failed = 0;

  /**
   * Plays all steps. `ask` returns a promise of the result that the library delivers: the text of a frame, "silence",
   * or an error. The result of a step without `expected` is not checked.
   */
  async play(conversation, ask) {
    for (const { asked, frame, expected, wait } of conversation) {
      if (wait) {
        // The line runs in real time, so the same time passes for the modules.
        await timers.setTimeout(wait);
        continue;
      }
      const got = await ask(frame);
      if (got === expected) {
        ++this.passed;
      } else if (expected) {
        ++this.failed;
        console.log(`${asked}: expected ${expected}, got ${got}`);
      }
    }
  }
}

function giveUp(what) {
  console.error(`${path.basename(process.argv[1])}: ${what}`);
  process.exit(2);
}

/** Returns the values of the command-line options. */
function options() {
  const given = {};
  for (let i = 2; i < process.argv.length; i += 2) {
    const [option, value] = process.argv.slice(i);
    if (!["--tty", "--tcp", "--modbus-tcp", "--baud"].includes(option) || value === undefined) {
      giveUp(`${option}: expected --tty PATH, --tcp HOST:PORT, --modbus-tcp HOST:PORT or --baud RATE`);
    }
    given[option.slice(2)] = value;
  }
  return given;
}

/** Returns { tty, baud } or { host, port, modbusTcp, baud }. */
function portOptions() {
  const { tty, tcp, "modbus-tcp": modbusTcp, baud = 9600 } = options();
  if (!RATES.includes(Number(baud))) {
    giveUp(`--baud ${baud}: expected one of ${RATES.join(", ")}`);
  }
  if ([tty, tcp, modbusTcp].filter((port) => port !== undefined).length !== 1) {
    giveUp("expected exactly one of --tty PATH, --tcp HOST:PORT and --modbus-tcp HOST:PORT");
  }
  if (tty !== undefined) {
    return { tty, baud: Number(baud) };
  }
  const address = tcp ?? modbusTcp;
  const [, host, port] = address.match(/^(.+):(\d+)$/) ?? giveUp(`${address}: expected HOST:PORT`);
  return { host, port: Number(port), modbusTcp: modbusTcp !== undefined, baud: Number(baud) };
}

/** Runs `converse(where, steps, checks)`, prints the result and sets the exit code. */
async function main(library, converse) {
  const where = portOptions();
  const checks = new Checks();
  await converse(where, steps(where), checks).catch((error) => giveUp(error.message));
  const { version } = require(`${library}/package.json`);
  const failed = checks.failed ? `, ${checks.failed} failed` : "";
  console.log(`${library} ${version}: ${checks.passed} checks passed${failed}`);
  process.exitCode = checks.failed ? 1 : 0;
}

module.exports = { TIMEOUT, turnaround, hex, word, bits, words, written, main };
