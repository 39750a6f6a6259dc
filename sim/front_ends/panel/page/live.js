// The WebSocket to the simulator. It reconnects automatically and reports lost connections.

const firstWait = 100;
const longestWait = 1000;
/// The time without a message after which the connection counts as lost, in ms. If nothing changes, the simulator sends
/// a message about once a second.
const patience = 3500;
/// The code with which the server closes the connection if too many pages are open.
const tooMany = 1013;

export class Live {
  /// `take(message)` gets each message. When the page has shown the changes in a message, the page must call `answer`
  /// with each reply in the message. `lost(why)` is called with "gone" or "tooMany" when a connection is lost or cannot
  /// be established, and with "" when the first message of a connection arrives.
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

  /// Restarts the timeout. The timeout is necessary because the socket stays open if the simulator does not respond or
  /// if the connection is broken.
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

  /// Sends a command of the control socket; resolves to {ok, text}. `undo` is another command, or undefined. If
  /// `command` succeeds and the page disconnects before it has sent `undo`, the simulator carries out `undo`.
  tell(command, undo) { return this.send({do: command, undo}); }

  /// Sends a request of the page and resolves to the reply. For a request {line, address, ask}, which the simulator
  /// sends on a line, the reply is {ok, text, meaning, delay}. `delay` is in us. `meaning` and `delay` may be
  /// undefined.
  send(request) {
    if (this.socket?.readyState !== WebSocket.OPEN) {
      return Promise.resolve({ok: false, text: "error: there is no connection to the simulator"});
    }
    const id = ++this.asked;
    return new Promise((resolve) => {
      this.waiting.set(id, resolve);
      this.socket.send(JSON.stringify({id, ...request}));
    });
  }
}
