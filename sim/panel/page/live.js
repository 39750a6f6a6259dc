// The WebSocket to the simulator. It comes back by itself, and says so while it cannot.

const firstWait = 100;
const longestWait = 1000;
/// The simulator says something every second.
const patience = 3500;
/// The code that it closes with where too many pages are open.
const tooMany = 1013;

export class Live {
  /// `take(message)` gets what comes, and calls `answer` with its reply once it is shown; `lost(why)` hears when
  /// nobody is there any more, and with "" that somebody is again.
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

  /// A simulator that is stopped, or a connection that hangs, closes nothing.
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
      answer({ok: false, text: "error: the simulator has gone"});
    }
    this.waiting.clear();
    this.lost(why);
    setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(2 * this.wait, longestWait);
  }

  /// A command of the control socket; resolves to {ok, text}. `undo` is another, which the simulator carries out
  /// when this page goes without having told it.
  tell(command, undo) {
    if (this.socket?.readyState !== WebSocket.OPEN) {
      return Promise.resolve({ok: false, text: "error: there is no simulator"});
    }
    const id = ++this.asked;
    return new Promise((resolve) => {
      this.waiting.set(id, resolve);
      this.socket.send(JSON.stringify({id, do: command, undo}));
    });
  }
}
