// The WebSocket to the simulator. It comes back by itself, and says so while it cannot.

const firstWait = 100;
const longestWait = 1000;
/// The simulator says something every second.
const patience = 3500;

export class Live {
  /// `take(message)` gets what comes; `lost(isLost)` hears when nobody is there any more, and is again.
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
        this.lost(false);
      }
      if (message.reply) {
        this.waiting.get(message.reply.id)?.(message.reply);
        this.waiting.delete(message.reply.id);
      }
      this.take(message);
    };
    socket.onclose = () => this.gone(socket);
  }

  /// A simulator that is stopped, or a connection that hangs, closes nothing.
  listen(socket) {
    clearTimeout(this.silence);
    this.silence = setTimeout(() => {
      socket.close();
      this.gone(socket);
    }, patience);
  }

  gone(socket) {
    if (socket !== this.socket) {
      return;
    }
    this.socket = null;
    clearTimeout(this.silence);
    for (const answer of this.waiting.values()) {
      answer({ok: false, text: "error: the simulator has gone"});
    }
    this.waiting.clear();
    this.lost(true);
    setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(2 * this.wait, longestWait);
  }

  /// A command of the control socket; resolves to {ok, text}.
  tell(command) {
    if (this.socket?.readyState !== WebSocket.OPEN) {
      return Promise.resolve({ok: false, text: "error: there is no simulator"});
    }
    const id = ++this.asked;
    return new Promise((resolve) => {
      this.waiting.set(id, resolve);
      this.socket.send(JSON.stringify({id, do: command}));
    });
  }
}
