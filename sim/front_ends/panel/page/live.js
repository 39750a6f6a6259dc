// The WebSocket to the program. It reconnects automatically and reports lost connections.

const firstWait = 100;
const longestWait = 1000;
/// In ms: without a message for so long, the connection counts as lost. If nothing changes, one comes each second.
const patience = 3500;
/// The server closes the connection with this code if too many pages are open.
const tooMany = 1013;

export class Live {
  /// `take(message)` gets each message; when the page has shown it, it must call `answer` with each reply in it.
  /// `lost(why)`: "gone" or "tooMany" when a connection is lost or cannot be established, "" at its first message.
  constructor(take, lost) {
    this.take = take;
    this.lost = lost;
    this.wait = firstWait;
    this.asked = 0;
    this.waiting = new Map();
    this.open();
  }

  open() {
    const socket = new WebSocket(`ws://${location.host}/live`);
    this.socket = socket;
    this.listen(socket);
    socket.onmessage = (event) => {
      this.listen(socket);
      this.wait = firstWait;
      const message = JSON.parse(event.data);
      if (message.hello) {
        this.lost("");
      }
      this.take(message);
    };
    socket.onclose = (event) => this.gone(socket, event.code === tooMany ? "tooMany" : "gone");
  }

  /// Restarts the timeout: the socket stays open if the program does not respond or the connection is broken.
  listen(socket) {
    clearTimeout(this.silence);
    this.silence = setTimeout(() => {
      socket.close();
      this.gone(socket, "gone");
    }, patience);
  }

  answer(reply) {
    this.waiting.get(reply.id)?.(reply);
    this.waiting.delete(reply.id);
  }

  gone(socket, why) {
    if (socket !== this.socket) {
      return;
    }
    this.socket = null;
    clearTimeout(this.silence);
    for (const answer of this.waiting.values()) {
      answer({ok: false, text: "error: the connection to the program is lost"});
    }
    this.waiting.clear();
    this.lost(why);
    setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(2 * this.wait, longestWait);
  }

  /// A command of the control socket; resolves to {ok, text}. The simulator carries out `undo`, another command or
  /// undefined, if `command` succeeds and the page disconnects before it has sent `undo`.
  tell(command, undo) { return this.send({do: command, undo}); }

  /// Resolves to the reply. That to a request for a line, {line, address, ask}, is {ok, text, meaning, delay}, with
  /// `delay` in us; the last two may be undefined.
  send(request) {
    if (this.socket?.readyState !== WebSocket.OPEN) {
      return Promise.resolve({ok: false, text: "error: there is no connection to the program"});
    }
    const id = ++this.asked;
    return new Promise((resolve) => {
      this.waiting.set(id, resolve);
      this.socket.send(JSON.stringify({id, ...request}));
    });
  }
}
