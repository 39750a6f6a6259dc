// The WebSocket to the simulator. It reconnects automatically and reports lost connections.

const firstWait = 100;
const longestWait = 1000;
/// The time without a message after which the connection counts as lost, in ms. The simulator sends a message at least
/// every second.
const patience = 3500;
/// The code with which the server closes the connection if too many pages are open.
const tooMany = 1013;

export class Live {
  /// `take(message)` gets each message. It must call `answer` with each reply after it has shown the changes.
  /// `lost(why)` is called with a reason when the connection is lost, and with "" when a connection is established.
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

  /// Restarts the timeout that detects a stopped simulator or a broken connection, because neither closes the socket.
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
      answer({ok: false, text: "error: the connection to the simulator is lost"});
    }
    this.waiting.clear();
    this.lost(why);
    setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(2 * this.wait, longestWait);
  }

  /// Sends a command of the control socket; resolves to {ok, text}. The simulator carries out the command `undo` if the
  /// page disconnects before it has sent `undo`.
  tell(command, undo) { return this.send({do: command, undo}); }

  /// Sends a request {line, address, ask} on a line; resolves to {ok, text, meaning, delay}.
  ask(request) { return this.send(request); }

  send(message) {
    if (this.socket?.readyState !== WebSocket.OPEN) {
      return Promise.resolve({ok: false, text: "error: there is no connection to the simulator"});
    }
    const id = ++this.asked;
    return new Promise((resolve) => {
      this.waiting.set(id, resolve);
      this.socket.send(JSON.stringify({id, ...message}));
    });
  }
}
